"""What bodies and receivers reflect of a period's light, by paths traced backwards."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from ..core.progress import SILENT, Progress, part
from ..core.scene import Scene, Vector
from .coefficients import Sought, blocks, daylight_coefficients
from .dome import Dome
from .gathering import weights_of
from .illuminance import spread_suns
from .occlusion import bodies_of
from .scattered_suns import scattered_suns
from .sensors import Sensors
from .shadow_rays import aims_at
from .site import to_model
from .sky import Suns
from .sky_matrix import matrix_blocks
from .surroundings import Surroundings, is_shiny
from .weights import Sources


@dataclass(frozen=True, slots=True)
class Reflected:
    """What N sensors have by reflection.

    ``irradiation`` (N,) in kWh/m² of the period, ``half_width`` (N,) that of its 95 % interval;
    ``course`` (T,) in W/m²: the mean over the sensors by area, hour by hour. ``notes``: what of the
    materials is left out.
    """

    irradiation: Vector
    half_width: Vector
    course: Vector
    notes: tuple[str, ...]

    @property
    def error(self) -> float:
        """The root mean square half-width over the mean; 0 where nothing is reflected."""
        mean = float(self.irradiation.mean())
        return float(np.sqrt((self.half_width**2).mean())) / mean if mean > 0 else 0.0


def reflect(
    scene: Scene,
    sensors: Sensors,
    sources: Sources,
    bounces: int,
    error: float,
    *,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Reflected:
    """The light that is reflected up to ``bounces`` times before it comes to the sensors.

    What is scattered last is of the suns as `scattered_suns` has them, what is mirrored last of
    suns that are spread over the sky's patches. Paths are followed until the 95 % half-width over
    the mean is at most ``error``, or `Sought.paths` rounds are. Raises RuntimeMissing, Cancelled.
    """
    bodies = bodies_of(scene)
    around = Surroundings(bodies)
    shiny = any(is_shiny(body.material) for body in bodies)
    lights = _lights_of(sources, error, shiny)
    found, spread = np.empty((2, len(sensors)))
    mean = np.zeros((3, lights.dome.count))
    suns, areas = np.zeros(len(lights.suns.directions)), weights_of(sensors)
    for number, rows in enumerate(blocks(len(sensors), lights.dome.count + len(suns))):
        within = part(progress, rows.start / len(sensors), rows.stop / len(sensors))
        some = daylight_coefficients(
            *(around, sensors.some(rows), lights.dome, bounces, lights.sought),
            seed=seed + number,
            progress=within,
        )
        found[rows], spread[rows] = some.value[:, 0], some.half_width[:, 0]
        mean[1] += areas[rows] @ some.scattered
        mean[2] += areas[rows] @ some.mirrored
        if some.suns.size:
            suns += areas[rows] @ some.suns
    return Reflected(found, spread, _course(sources, lights, mean, suns), around.told())


@dataclass(frozen=True, slots=True)
class _Lights:
    """What is reflected: of the dome, of S suns, and of those that are ``spread`` (P, T) on it."""

    dome: Dome
    suns: Suns
    spread: csr_array
    sought: Sought


def _lights_of(sources: Sources, error: float, shiny: bool) -> _Lights:
    """A period's light, in kWh/(m² sr) and kWh/m², and how well it is sought.

    The suns are spread only where something ``shiny`` may show them.
    """
    hourly = sources.hourly
    dome = Dome(int(np.sqrt(len(sources.patches.directions) / 144)), sources.site)
    sky = np.zeros(dome.count)
    for which, block in matrix_blocks(hourly, sources.patches, "none"):
        sky[:-1] += hourly.hours[which] @ block
    sky[-1] = hourly.hours @ sources.ground_radiance
    spread = csr_array((dome.count, len(hourly)))
    if shiny:
        spread = spread_suns(hourly, sources.patches)
    skies = np.stack([0 * sky, sky, sky + spread @ hourly.hours])[..., None] / 1000
    energy = hourly.direct * hourly.hours / 1000
    suns = scattered_suns(sources.suns, hourly.sun, energy)
    assert suns.weights is not None
    light = suns.weights @ energy
    aims = aims_at(to_model(suns.directions, sources.site), light, light > 0)
    return _Lights(dome, suns, spread, Sought(skies, error, aims=aims, suns=light[:, None]))


def _course(sources: Sources, lights: _Lights, patches: Vector, suns: Vector) -> Vector:
    """Irradiance (T,) in W/m² by coefficients of ``patches`` (3, P) and ``suns`` (S,)."""
    assert lights.suns.weights is not None
    both = patches.sum(axis=0)
    course = sources.ground_radiance * both[-1] + lights.spread.T @ patches[2]
    course += sources.hourly.direct * (lights.suns.weights.T @ suns)
    for which, block in matrix_blocks(sources.hourly, sources.patches, "none"):
        course[which] += block @ both[:-1]
    return course
