"""What has landed where and what became of the flux, summed batch by batch."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from ..core.files import BROKEN

FATES = {"landed": 1, "absorbed": 2, "escaped": 3, "cut_off": 4}
"""What can become of a photon."""
ROUTES = {"direct": 0, "caustic": 1, "indirect": 2}
"""The way it took: met no body, only glass and mirrors, or was scattered by a matte surface."""


class Landing(NamedTuple):
    """What became of a batch's photons (N,): ``fate`` as in FATES, ``route`` as in ROUTES.

    ``texel`` is where it landed if ``fate`` is LANDED; ``weight`` lm at the end, of which roulette
    gave ``gained``; ``band`` its place among the wavelengths in 0..1, or None where there is one.
    """

    fate: NDArray[np.uint32]
    route: NDArray[np.uint32]
    texel: NDArray[np.uint32]
    weight: NDArray[np.float32]
    gained: NDArray[np.float32]
    band: NDArray[np.float32] | None = None


@dataclass(slots=True)
class Tally:
    """Sums in float64 over all photons so far; their memory does not grow with the photons.

    Every photon counts with the whole flux that it stands for, in colour with the lumens of its
    wavelength: `per_photon` makes lm of a sum. ``routes`` (3, T) are Σw a texel by ROUTES,
    ``square`` (T,) is Σw² of the photons counted, those of direct light only where ``everything``
    is traced. ``colour`` (2, T) are Σw of X and Z, where Σw is Y, if ``bands`` (K, 4) say what a
    photon's wavelength weighs (`spectrum.Bands.table`). ``flux`` is Σw by FATES, with what roulette
    gave taken off ``cut_off``, ``traced`` is Σw at the start, ``unaimed`` Σw of direct light that
    landed without being counted. ``batches`` is how many were added: the next one's random numbers
    follow from it.
    """

    texels: int
    everything: bool
    bands: NDArray[np.float32] | None = None
    routes: NDArray[np.float64] = field(init=False)
    square: NDArray[np.float64] = field(init=False)
    colour: NDArray[np.float64] = field(init=False)
    flux: dict[str, float] = field(init=False)
    traced: float = 0.0
    unaimed: float = 0.0
    emitted: int = 0
    landed: int = 0
    batches: int = 0

    def __post_init__(self) -> None:
        self.routes, self.square = np.zeros((3, self.texels)), np.zeros(self.texels)
        self.colour = np.zeros((0 if self.bands is None else 2, self.texels))
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
        gained = landing.gained.astype(np.float64) / share
        others = np.zeros((0, len(weight)))
        if landing.band is not None:
            of_x, of_y, of_z = self._weights(landing.band)
            others = weight * [of_x, of_z]
            weight, gained = weight * of_y, gained * of_y
        for name, fate in FATES.items():
            self.flux[name] += float(weight[landing.fate == fate].sum())
        self.flux["cut_off"] -= float(gained.sum())
        self.traced += float(weight.sum() - gained.sum())
        self.emitted += len(weight)

        on = landing.fate == FATES["landed"]
        if not self.everything:
            straight = on & (landing.route == ROUTES["direct"])
            self.unaimed += float(weight[straight].sum())
            on &= ~straight
        texel, weight, route = landing.texel[on], weight[on], landing.route[on]
        for total, other in zip(self.colour, others, strict=True):
            total += np.bincount(texel, other[on], self.texels)
        for index, total in enumerate(self.routes):
            chosen = route == index
            if chosen.any():
                total += np.bincount(texel[chosen], weight[chosen], self.texels)
        self.square += np.bincount(texel, weight * weight, self.texels)
        self.landed += len(texel)

    def _weights(self, band: NDArray[np.float32]) -> NDArray[np.float64]:
        """X, Y and Z (3, N) of photons at these places among the wavelengths."""
        assert self.bands is not None
        rows = np.arange(len(self.bands))
        place = band * len(self.bands) - 0.5
        return np.stack([np.interp(place, rows, column) for column in self.bands.T[1:]])

    def account(self, emitted: float, computed: float) -> dict[str, float]:
        """Where the luminaires' ``emitted`` flux in lm went.

        With everything traced every photon is followed and the parts are counted one by one. Else
        ``computed`` lm of direct light stay where they land, and what was neither traced nor stays
        so escapes.
        """
        flux = {name: self.per_photon(value) for name, value in self.flux.items()}
        if not self.everything:
            beside = computed - self.per_photon(self.unaimed)
            flux["landed"] += beside
            flux["escaped"] += emitted - self.per_photon(self.traced) - beside
        return {"emitted": emitted, **{name: float(value) for name, value in flux.items()}}

    def save(self, path: Path, key: str) -> None:
        """Write the sums, with a ``key`` for what they are sums of."""
        about = {name: getattr(self, name) for name in _SCALARS} | {"flux": self.flux, "key": key}
        with path.open("wb") as file:
            np.savez_compressed(
                file,
                about=np.array(json.dumps(about)),
                routes=self.routes,
                square=self.square,
                colour=self.colour,
            )

    def load(self, path: Path, key: str) -> bool:
        """Take over saved sums; False, and nothing taken, where they are sums of something else.

        Raises FileError for a file that is missing or damaged.
        """
        try:
            with np.load(path) as saved:
                about = json.loads(str(saved["about"]))
                arrays = {name: saved[name] for name in ("routes", "square", "colour")}
            found = about["key"]
        except BROKEN:
            raise FileError(f"“{path}” holds no sums of photons; trace anew.") from None
        if found != key or any(getattr(self, n).shape != a.shape for n, a in arrays.items()):
            return False
        for name in _SCALARS:
            setattr(self, name, about[name])
        self.flux = about["flux"]
        for name, array in arrays.items():
            setattr(self, name, array)
        return True


_SCALARS = ("traced", "unaimed", "emitted", "landed", "batches")
