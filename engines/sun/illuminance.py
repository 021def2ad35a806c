"""Illuminance hour by hour: coefficients times the sky's luminances, and the sun by itself.

The sky's light and all that is reflected come through the coefficients, the sun's reflected light
with them: there the sun is spread over the four nearest patches, which moves its spot on the first
surface by up to a patch's width, 12° over the subdivision. What the sun gives straight is traced
to where it stands [as Bourgeois et al. 2008, and the two-phase method with direct sun].
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..core.scene import Vector
from .bounces import Dome
from .cie_sky import OVERCAST, cie_sky
from .coefficients import Coefficients, open_patches
from .hourly import hourly_skies
from .metrics import Light
from .occlusion import Occluders
from .patches import patch_at, patches_of
from .sensors import Sensors
from .site import Site, to_model
from .sky import Suns
from .sky_matrix import ground_radiance, matrix_blocks, on_patches
from .suns import merged_suns
from .visibility import visible
from .weather import Weather

_FINE = 4  # the subdivision by which an open sky is summed, to 0.03 %
_ROWS = 1024


@dataclass(frozen=True, slots=True)
class Course:
    """T intervals of daylight on a dome of P patches, the ground the last.

    ``sky`` (P, T) float32 in cd/m² without the sun; ``spread`` (P, T), sparse: the sun's light on
    patches. ``suns``: where it comes from in the world; ``direct`` (T,) in lx normal to it.
    ``hours`` (T,) and ``times`` (T,), UTC: how long each interval is, and its middle.
    """

    dome: Dome
    sky: NDArray[np.float32]
    spread: csr_array
    suns: Suns
    direct: Vector
    hours: Vector
    times: NDArray[np.datetime64]
    notes: tuple[str, ...]

    @property
    def up(self) -> NDArray[np.bool_]:
        """In which intervals (T,) the sun is above the horizon in the middle."""
        assert self.suns.weights is not None
        return np.diff(self.suns.weights.tocsc().indptr) > 0

    def some(self, which: NDArray[np.bool_] | NDArray[np.int64]) -> "Course":
        """The intervals that ``which`` selects."""
        assert self.suns.weights is not None
        return replace(
            self,
            sky=self.sky[:, which],
            spread=self.spread[:, which],
            suns=replace(self.suns, weights=self.suns.weights[:, which]),
            direct=self.direct[which],
            hours=self.hours[which],
            times=self.times[which],
        )

    def luminances(self, weights: Vector) -> Vector:
        """Σ over the intervals by ``weights`` (T, K), as `coefficients.Sought` has it (2, P, K)."""
        plain = self.sky @ weights
        return np.stack([plain, plain + self.spread @ weights])

    def light(self, found: Coefficients, direct: Light) -> Light:
        """Illuminance (N, T) of N sensors in lx, with what the sun gives them straight (N, T)."""
        light = found.both @ self.sky
        light += (self.spread.T @ found.scattered.T).T
        light += direct
        return light

    def open_mean(self, normals: Vector, hours: Vector) -> Vector:
        """Mean illuminance (N,) in lx over ``hours`` (T,) on planes that face ``normals`` (N, 3).

        There is no body; below the horizon there is the ground.
        """
        weights = hours / hours.sum()
        sky = self.sky @ weights
        fine = patches_of(_FINE)
        bright = sky[patch_at(fine.directions, self.dome.subdivision)]
        below = fine.directions * [1, 1, -1]
        directions = np.concatenate([fine.directions, below, self.suns.directions])
        assert self.suns.weights is not None
        light = np.concatenate(
            [
                bright * fine.solid_angles,
                sky[-1] * fine.solid_angles,
                self.suns.weights @ (self.direct * weights),
            ]
        )
        towards = to_model(directions, self.dome.site).T
        if len(normals) and (normals == normals[0]).all():
            return np.repeat(np.maximum(normals[:1] @ towards, 0.0) @ light, len(normals))
        found = np.empty(len(normals))
        for start in range(0, len(normals), _ROWS):
            rows = slice(start, start + _ROWS)
            found[rows] = np.maximum(normals[rows] @ towards, 0.0) @ light
        return found

    def sunlight(self, occluders: Occluders, sensors: Sensors) -> Light:
        """What the sun gives N sensors straight (N, T) in lx."""
        out = np.zeros((len(sensors), len(self.hours)), np.float32)
        if not len(self.suns.directions):
            return out
        directions = to_model(self.suns.directions, self.dome.site)
        arriving = visible(occluders, sensors, directions).values()
        arriving *= np.maximum(sensors.normals @ directions.T, 0.0).astype(np.float32)
        assert self.suns.weights is not None
        shining = self.suns.weights.tocoo()
        out[:, shining.col] = arriving[:, shining.row]
        out *= self.direct.astype(np.float32)
        return out


def course_of(
    weather: Weather,
    site: Site,
    dome: Dome,
    mask: NDArray[np.bool_],
    *,
    accuracy: float,
    ground_reflectance: float,
) -> Course:
    """The daylight of the weather's intervals that ``mask`` (T,) chooses, dark ones too.

    Suns are merged to ``accuracy`` in deg. Raises ParameterError as `hourly_skies`, `patches_of`
    and `merged_suns` do.
    """
    hourly = hourly_skies(weather, site, "light", mask)
    patches = patches_of(dome.subdivision)
    count, intervals = dome.count - 1, len(hourly)
    sky = np.zeros((dome.count, intervals), np.float32)
    exact = open_patches(dome)[:-1]
    for which, block in matrix_blocks(hourly, patches, "none"):
        falling = block @ exact
        level = np.divide(
            hourly.diffuse[which], falling, out=np.zeros_like(falling), where=falling > 0
        )
        sky[:count, which] = (block * level[:, None]).T
    sky[count] = ground_radiance(hourly, ground_reflectance)
    rows, columns, values = [], [], []
    sunny = replace(hourly, diffuse=np.zeros(intervals))
    for which, block in matrix_blocks(sunny, patches, "patches"):
        time, patch = np.nonzero(block)
        rows.append(patch)
        columns.append(which[time])
        values.append(block[time, patch])
    empty = np.zeros(0, np.int64)
    spread = csr_array(
        (
            np.concatenate([np.zeros(0), *values]).astype(np.float32),
            (np.concatenate([empty, *rows]), np.concatenate([empty, *columns])),
        ),
        shape=(dome.count, intervals),
    )
    suns = merged_suns(hourly.sun, hourly.direct * hourly.hours, accuracy)
    notes = (*weather.notes, *hourly.notes)
    return Course(dome, sky, spread, suns, hourly.direct, hourly.hours, weather.times[mask], notes)


def overcast(dome: Dome, ground_reflectance: float) -> Vector:
    """The luminances (P,) of the CIE's traditional overcast sky that gives 1 lx outdoors."""
    sky = on_patches(cie_sky(OVERCAST), 1.0, patches_of(dome.subdivision))[:, 0]
    sky /= open_patches(dome)[:-1] @ sky
    return np.append(sky, ground_reflectance / np.pi)
