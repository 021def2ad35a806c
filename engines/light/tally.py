"""What has landed where and what became of the flux, summed batch by batch."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

FATES = {"landed": 1, "absorbed": 2, "escaped": 3, "cut_off": 4}
"""What can become of a photon."""
ROUTES = {"direct": 0, "caustic": 1, "indirect": 2}
"""The way it took: met no body, only glass and mirrors, or was scattered by a matte surface."""


class Landing(NamedTuple):
    """What became of a batch's photons (N,): ``fate`` as in FATES, ``route`` as in ROUTES.

    ``u``, ``v`` in 0..1 on the receiver where ``fate`` is LANDED; ``weight`` lm at the end, of
    which roulette gave ``gained``.
    """

    fate: NDArray[np.uint32]
    route: NDArray[np.uint32]
    u: NDArray[np.float32]
    v: NDArray[np.float32]
    weight: NDArray[np.float32]
    gained: NDArray[np.float32]


@dataclass(slots=True)
class Tally:
    """Sums in float64 over all photons so far; their memory does not grow with the photons.

    Every photon counts with the whole flux that it stands for: `per_photon` makes lm of a sum.
    ``routes`` (3, T) are Σw a texel by ROUTES, ``square`` (T,) is Σw² of the photons counted, those
    of direct light only where ``everything`` is traced. ``flux`` is Σw by FATES, with what roulette
    gave taken off ``cut_off``, ``traced`` is Σw at the start, ``unaimed`` Σw of direct light that
    landed without being counted.
    """

    rows: int
    columns: int
    everything: bool
    routes: NDArray[np.float64] = field(init=False)
    square: NDArray[np.float64] = field(init=False)
    flux: dict[str, float] = field(init=False)
    traced: float = 0.0
    unaimed: float = 0.0
    emitted: int = 0
    landed: int = 0

    def __post_init__(self) -> None:
        texels = self.rows * self.columns
        self.routes, self.square = np.zeros((3, texels)), np.zeros(texels)
        self.flux = dict.fromkeys(FATES, 0.0)

    @property
    def total(self) -> NDArray[np.float64]:
        """Σw a texel (T,) of the photons counted."""
        return self.routes.sum(axis=0) if self.everything else self.routes[1:].sum(axis=0)

    @property
    def typical(self) -> float:
        """The flux that a photon stands for on average."""
        return self.traced / max(self.emitted, 1)

    def per_photon(self, value: float) -> float:
        """A sum as lm."""
        return value / max(self.emitted, 1)

    def add(self, landing: Landing, share: float) -> None:
        """Count a batch of the luminaire that sends this ``share`` of all photons."""
        weight = landing.weight.astype(np.float64) / share
        gained = float(landing.gained.sum(dtype=np.float64)) / share
        for name, fate in FATES.items():
            self.flux[name] += float(weight[landing.fate == fate].sum())
        self.flux["cut_off"] -= gained
        self.traced += float(weight.sum()) - gained
        self.emitted += len(weight)

        on = landing.fate == FATES["landed"]
        if not self.everything:
            straight = on & (landing.route == ROUTES["direct"])
            self.unaimed += float(weight[straight].sum())
            on &= ~straight
        texel, weight, route = self._texel(landing, on), weight[on], landing.route[on]
        for index, total in enumerate(self.routes):
            chosen = route == index
            if chosen.any():
                total += np.bincount(texel[chosen], weight[chosen], total.size)
        self.square += np.bincount(texel, weight * weight, self.square.size)
        self.landed += len(texel)

    def _texel(self, landing: Landing, on: NDArray[np.bool_]) -> NDArray[np.int64]:
        column = np.minimum((landing.u[on] * self.columns).astype(np.int64), self.columns - 1)
        row = np.minimum((landing.v[on] * self.rows).astype(np.int64), self.rows - 1)
        return row * self.columns + column

    def account(self, emitted: float, computed: float) -> dict[str, float]:
        """Where the luminaires' ``emitted`` flux in lm went.

        With everything traced every photon is followed and the parts are counted one by one. Else
        ``computed`` lm of direct light land, and what was neither traced nor lands so escapes.
        """
        flux = {name: self.per_photon(value) for name, value in self.flux.items()}
        if not self.everything:
            beside = computed - self.per_photon(self.unaimed)
            flux["landed"] += beside
            flux["escaped"] += emitted - self.per_photon(self.traced) - beside
        return {"emitted": emitted, **flux}
