"""What bodies and receivers reflect of a period's light, by paths traced backwards."""

from dataclasses import dataclass

import numpy as np

from ..core.progress import SILENT, Progress, part
from ..core.scene import Body, Material, Scene, Vector
from .bounces import Dome, Surroundings
from .coefficients import Sought, blocks, daylight_coefficients
from .gathering import weights_of
from .occlusion import mesh_of
from .sensors import Sensors
from .sky_matrix import matrix_blocks
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

    The sun stands in the four patches of the sky around it, as there are. Paths are followed until
    the 95 % half-width over the mean is at most ``error``, or `Sought.paths` rounds are.
    Raises RuntimeMissing, Cancelled.
    """
    dome = Dome(int(np.sqrt(len(sources.patches.directions) / 144)), sources.site)
    around = Surroundings(surfaces_in(scene))
    hourly = sources.hourly
    sky = np.zeros(dome.count)
    for which, block in matrix_blocks(hourly, sources.patches, "patches"):
        sky[:-1] += hourly.hours[which] @ block
    sky[-1] = hourly.hours @ sources.ground_radiance
    sky /= 1000
    sought = Sought(np.stack([0 * sky, sky])[..., None], error)
    found, spread = np.empty((2, len(sensors)))
    mean, areas = np.zeros(dome.count), weights_of(sensors)
    for number, rows in enumerate(blocks(len(sensors))):
        within = part(progress, rows.start / len(sensors), rows.stop / len(sensors))
        some = daylight_coefficients(
            *(around, sensors.some(rows), dome, bounces, sought),
            seed=seed + number,
            progress=within,
        )
        found[rows], spread[rows] = some.value[:, 0], some.half_width[:, 0]
        mean += areas[rows] @ some.scattered
    course = sources.ground_radiance * mean[-1]
    for which, block in matrix_blocks(hourly, sources.patches, "patches"):
        course[which] += block @ mean[:-1]
    return Reflected(found, spread, course, around.told())


def surfaces_in(scene: Scene) -> tuple[Body, ...]:
    """A scene's bodies, and its receivers as matte ones of their own reflectance."""
    return (
        *scene.bodies,
        *(
            Body(r.name, mesh_of(r), Material(kind="diffuse", reflectance=r.reflectance))
            for r in scene.receivers
        ),
    )
