"""Daylight coefficients: what each patch of the sky, at a luminance of 1, gives to each sensor.

[Tregenza & Waters 1983, Lighting Research & Technology 15(2):65–71]. Beside them are those of the
suns, each at its own place, for what of them is reflected [after Bourgeois et al. 2008]. They do
not depend on weather or time: any hour is a weighted sum. They are found by chance, so each is a
mean over rounds of paths that know nothing of each other, whose scatter tells the error.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from ..core.progress import SILENT, Progress
from ..core.scene import Vector
from .bounces import Start, follow
from .dome import Dome
from .rays import clearance
from .sensors import Sensors
from .shadow_rays import Aims
from .surroundings import Surroundings

STRATA = (32, 16)
"""Cells a side of the grid over the hemisphere, for FEW sensors and for more: each sends as many
paths squared in a round."""
FEW = 1024
FEWEST = 8
"""Rounds: with fewer the error itself would be too uncertain."""
BLOCK = 4096
"""Sensors at a time, of which each sends 256 paths in a round: a million."""
_NUMBERS = 1 << 22  # coefficients at a time: 32 MB, some eight times over


@dataclass(frozen=True, slots=True)
class Coefficients:
    """What N sensors get of P patches, the ground the last, in lx for 1 cd/m², and of S suns.

    ``straight`` (N, P) float32 comes through nothing but clear panes, ``scattered`` (N, P) last off
    a matte surface or through a screen, ``mirrored`` (N, P) last off a mirror. ``suns`` (N, S)
    float32, in lx for 1 lx normal to the sun, is of what is scattered alone; there S is 0 where
    none was aimed at. ``value`` (N, K) is what K skies give, and ``error`` (N, K) its standard
    error; ``given_up`` (N,) is as in `bounces.Found`. There were ``rounds`` of strata² paths a
    sensor.
    """

    straight: NDArray[np.float32]
    scattered: NDArray[np.float32]
    mirrored: NDArray[np.float32]
    suns: NDArray[np.float32]
    value: Vector
    error: Vector
    given_up: Vector
    rounds: int
    strata: int

    @property
    def paths(self) -> int:
        """Followed from each sensor."""
        return self.rounds * self.strata**2

    def some(self, rows: slice) -> "Coefficients":
        """Those of some of the sensors."""
        return replace(
            self,
            straight=self.straight[rows],
            scattered=self.scattered[rows],
            mirrored=self.mirrored[rows],
            suns=self.suns[rows],
            value=self.value[rows],
            error=self.error[rows],
            given_up=self.given_up[rows],
        )

    @property
    def patches(self) -> NDArray[np.float32]:
        """All that comes from each patch (N, P)."""
        return self.straight + self.scattered + self.mirrored

    @property
    def half_width(self) -> Vector:
        """Of the 95 % interval about ``value`` (N, K), by Student's t."""
        return float(stdtrit(self.rounds - 1, 0.975)) * self.error


@dataclass(frozen=True, slots=True)
class Sought:
    """How well coefficients must be known.

    ``skies`` (3, P, K): the luminances of the patches, for what comes straight, is scattered last
    and mirrored last. ``suns`` (S, K): what the suns of ``aims`` give in these skies normal to
    them, in lx. There are rounds until the 95 % half-width of the first sky's light, ÷ its mean
    over the sensors, is at most ``error`` (root mean square over the sensors), or until a sensor
    has sent ``paths``, as where there is no light; FEWEST in any case.
    """

    skies: Vector
    error: float
    paths: int = 1 << 17
    aims: Aims | None = None
    suns: Vector | None = None

    def most(self) -> Vector:
        """The most light (K,) that a single path can find, as where it escapes to the brightest."""
        most = np.pi * self.skies.max(axis=(0, 1))
        if self.aims is not None and self.suns is not None:
            chances = self.aims.chances[:, None]
            seen = np.divide(self.suns, chances, out=np.zeros_like(self.suns), where=chances > 0)
            most = np.maximum(most, seen.max(axis=0))
        return most

    def light(self, patches: Vector, suns: Vector) -> Vector:
        """What the skies give (N, K) by coefficients (N, 3, P) and (N, S)."""
        count = self.skies.shape[2]
        light = patches.reshape(len(patches), -1) @ self.skies.reshape(-1, count)
        if self.aims is not None and self.suns is not None:
            light += suns @ self.suns
        return light


def daylight_coefficients(
    around: Surroundings,
    sensors: Sensors,
    dome: Dome,
    bounces: int,
    sought: Sought,
    *,
    veil: float = 0.0,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Coefficients:
    """The coefficients of as many sensors as memory holds: of some of `blocks`.

    Each path is followed for ``bounces`` reflections; ``veil`` is as `bounces.follow` says. The
    same ``seed`` gives the same coefficients. Raises RuntimeMissing where nothing can be traced,
    Cancelled.
    """
    count = len(sensors)
    few = count <= FEW and sought.paths >= FEWEST * STRATA[0] ** 2
    start = _start(around, sensors, STRATA[0] if few else STRATA[1])
    patches = np.zeros((count, 3, dome.count))
    suns = np.zeros((count, len(sought.aims.directions) if sought.aims else 0))
    first = np.zeros((count, sought.skies.shape[2]))
    square, given_up = np.zeros_like(first), np.zeros(count)
    rounds, needed = 0, FEWEST
    while rounds < needed:
        progress(rounds / needed, f"Following daylight, round {rounds + 1} of {needed}")
        key = int(np.random.SeedSequence((seed, rounds)).generate_state(1)[0])
        found = follow(around, start, dome, bounces, veil, key, sought.aims)
        patches += found.patches
        suns += found.suns
        given_up += found.given_up
        light = sought.light(found.patches, found.suns)
        first += light
        square += light**2
        rounds += 1
        if rounds == needed:
            needed = _needed(first, square, rounds, sought, start.strata)
    mean = first / rounds
    variance = np.maximum(square / rounds - mean**2, 0.0) / (rounds - 1)
    error = _error(mean, variance, sought.most() / (rounds * start.strata**2), rounds)
    patches /= rounds
    straight, scattered, mirrored = (patches[:, kind].astype(np.float32) for kind in range(3))
    return Coefficients(
        straight,
        scattered,
        mirrored,
        (suns / rounds).astype(np.float32),
        mean,
        error,
        given_up / rounds,
        rounds,
        start.strata,
    )


def blocks(count: int, sources: int) -> Iterator[slice]:
    """Runs of up to BLOCK sensors, fewer with many ``sources``: patches and suns."""
    step = max(1, min(BLOCK, _NUMBERS // sources))
    return (slice(first, min(first + step, count)) for first in range(0, count, step))


def open_patches(dome: Dome) -> Vector:
    """What each patch gives to a horizontal plane in the open (P,), exactly; the ground nothing."""
    rows = np.array(dome.rows)
    edge = np.minimum(np.arange(len(rows) + 1) / (len(rows) - 0.5), 1.0) * np.pi / 2
    share = np.pi * np.diff(np.sin(edge) ** 2) / rows
    return np.append(np.repeat(share, rows), 0.0)


def _start(around: Surroundings, sensors: Sensors, strata: int) -> Start:
    points = sensors.points - around.soup.centre
    origins = points + clearance(points, (around.soup,), sensors.offset) * sensors.normals
    return Start(origins.astype(np.float32), sensors.normals.astype(np.float32), strata)


def _error(mean: Vector, variance: Vector, each: Vector, rounds: int) -> Vector:
    """The standard error (N, K) of means with this ``variance``, of paths that find up to ``each``.

    What few paths find scatters more than they show: four more are reckoned with [Agresti & Coull
    1998], as many having found it as its relative error tells. Where none has, less than 3 would
    in as many again, at 95 % [Hanley & Lippman-Hand 1983].
    """
    share = np.divide(variance, mean**2, out=np.zeros_like(mean), where=mean > 0)
    none = 3 * each / float(stdtrit(rounds - 1, 0.975))
    return np.where(mean > 0, np.sqrt(variance * (1 + 4 * share)), none)


def _needed(first: Vector, square: Vector, rounds: int, sought: Sought, strata: int) -> int:
    """How many rounds there must be in all, as far as these ones tell."""
    mean = first[:, 0] / rounds
    variance = np.maximum(square[:, 0] / rounds - mean**2, 0.0) / (rounds - 1)
    most = max(sought.paths // strata**2, rounds)
    if not len(mean) or not sought.skies[..., 0].any():
        return rounds
    if not mean.any():
        return most
    reached = 1.96 * np.sqrt(variance.mean()) / mean.mean()
    more = (reached / sought.error) ** 2
    return int(np.clip(np.ceil(rounds * min(more, 1e6)), rounds, most))
