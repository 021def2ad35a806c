"""Illuminance hour by hour: coefficients times the sky's luminances and the suns' light.

What the sun gives straight is traced to where it stands; what surfaces scatter of it has its own
coefficients, of suns where it stands or near, as `scattered_suns` says [after Bourgeois et al.
2008, and the two-phase method with direct sun]. Only in a mirror it is spread over the four nearest
patches of the sky, which moves it by up to a patch's width, 12° over the subdivision.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..core.scene import Vector
from .cie_sky import OVERCAST, cie_sky
from .coefficients import Coefficients, open_patches
from .dome import Dome
from .hourly import HourlySkies, hourly_skies
from .metrics import Light
from .occlusion import Occluders
from .patches import patch_at, patches_of
from .scattered_suns import scattered_suns
from .sensors import Sensors
from .shadow_rays import Aims, aims_at
from .site import Site, to_model
from .sky import Patches, Suns
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
    patches, for mirrors. ``suns``: where it comes from in the world, ``scattered``: S of them for
    what is scattered; ``direct`` (T,) in lx normal to it. ``hours`` (T,) and ``times`` (T,), UTC:
    how long each interval is, and its middle.
    """

    dome: Dome
    sky: NDArray[np.float32]
    spread: csr_array
    suns: Suns
    scattered: Suns
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
        return replace(
            self,
            sky=self.sky[:, which],
            spread=self.spread[:, which],
            suns=_some(self.suns, which),
            scattered=_some(self.scattered, which),
            direct=self.direct[which],
            hours=self.hours[which],
            times=self.times[which],
        )

    def luminances(self, weights: Vector) -> Vector:
        """Σ over the intervals by ``weights`` (T, K), as `coefficients.Sought` has it (3, P, K)."""
        plain = self.sky @ weights
        return np.stack([plain, plain, plain + self.spread @ weights])

    def normal(self, weights: Vector) -> Vector:
        """Σ of the light of each of the ``scattered`` suns (S, K), as `Sought` has it, likewise."""
        return self._shares @ (self.direct[:, None] * weights)

    def aims(self, light: Vector, which: NDArray[np.bool_]) -> Aims | None:
        """Aims by their ``light`` (S,) at ``scattered`` suns of the intervals ``which`` (T,)."""
        asked = self.normal(which.astype(np.float64)[:, None])[:, 0] > 0
        return aims_at(to_model(self.scattered.directions, self.dome.site), light, asked)

    def light(self, found: Coefficients, direct: Light) -> Light:
        """Illuminance (N, T) of N sensors in lx, with what the sun gives them straight (N, T)."""
        light = found.patches @ self.sky
        if found.mirrored.any():
            light += (self.spread.T @ found.mirrored.T).T
        if found.suns.any():
            falling = (self._shares * self.direct).astype(np.float32)
            light += (falling.T @ found.suns.T).T
        light += direct
        return light

    @property
    def _shares(self) -> csr_array:
        assert self.scattered.weights is not None
        return self.scattered.weights

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
    energy = hourly.direct * hourly.hours
    suns = merged_suns(hourly.sun, energy, accuracy)
    return Course(
        dome,
        sky,
        spread_suns(hourly, patches),
        suns,
        scattered_suns(suns, hourly.sun, energy),
        hourly.direct,
        hourly.hours,
        weather.times[mask],
        (*weather.notes, *hourly.notes),
    )


def spread_suns(hourly: HourlySkies, patches: Patches) -> csr_array:
    """The suns' light (P, T) on the patches, as `matrix_blocks` spreads it; the ground the last."""
    sunny = replace(hourly, diffuse=np.zeros(len(hourly)))
    shape = len(patches.directions) + 1, len(hourly)
    rows, columns, values = [np.zeros(0, np.int64)], [np.zeros(0, np.int64)], [np.zeros(0)]
    for which, block in matrix_blocks(sunny, patches, "patches"):
        time, patch = np.nonzero(block)
        rows.append(patch)
        columns.append(which[time])
        values.append(block[time, patch])
    light = np.concatenate(values).astype(np.float32)
    return csr_array((light, (np.concatenate(rows), np.concatenate(columns))), shape=shape)


def overcast(dome: Dome, ground_reflectance: float) -> Vector:
    """The luminances (P,) of the CIE's traditional overcast sky that gives 1 lx outdoors."""
    sky = on_patches(cie_sky(OVERCAST), 1.0, patches_of(dome.subdivision))[:, 0]
    sky /= open_patches(dome)[:-1] @ sky
    return np.append(sky, ground_reflectance / np.pi)


def _some(suns: Suns, which: NDArray[np.bool_] | NDArray[np.int64]) -> Suns:
    assert suns.weights is not None
    return replace(suns, weights=suns.weights[:, which])
