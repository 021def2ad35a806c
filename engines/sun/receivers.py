"""A scene's receivers: their sensors, whether those look the right way, and what they have found.

A mesh gathers light on the side that its faces look to, which need not be the outer.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.scene import Receiver, Scene, Surface, Vector
from ..core.solid import inspect
from .maps import SunMap
from .sensors import Sensors, of_receiver

_DOWN = -0.5  # the mean of a receiver's normals, below which it is said to look down
_REMEDY = "recalculate its normals (in Edit Mode, Mesh › Normals › Recalculate Outside)."


def sensors_in(scene: Scene) -> tuple[Sensors, ...]:
    """The sensors of each of a scene's receivers. Raises SceneError where there are none."""
    if not scene.receivers:
        raise SceneError("Nothing is measured: add a receiver, a plane or a mesh, to the scene.")
    return tuple(sensors_on(receiver) for receiver in scene.receivers)


def sensors_on(receiver: Receiver | Surface) -> Sensors:
    """The sensors of a receiver, with notes on a mesh that looks two ways or inward.

    Raises SceneError where it has no area, or no place for each part of it in its map.
    """
    sensors = of_receiver(receiver)
    if not len(sensors):
        raise SceneError(f"Receiver “{receiver.name}” has no area to measure on; give it faces.")
    if isinstance(receiver, Receiver):
        return sensors
    said = wound(receiver)
    return replace(sensors, notes=(*sensors.notes, *said), doubtful=bool(said))


def map_of(receiver: Receiver | Surface, sensors: Sensors, values: Mapping[str, Vector]) -> SunMap:
    """A receiver's maps of the ``values``, each (N,), of its ``sensors``."""
    maps = {name: _spread(sensors, some) for name, some in values.items()}
    areas = _spread(sensors, sensors.areas, 0.0)
    return SunMap(receiver.name, maps, areas if receiver.sides == "front" else areas[0])


def _spread(sensors: Sensors, values: Vector, fill: float = np.nan) -> NDArray[np.float32]:
    return cast(NDArray[np.float32], sensors.spread(values.astype(np.float32), fill))


def looking_down(scene: Scene, parts: Sequence[Sensors]) -> list[str]:
    """A sentence on each receiver whose only side looks down, as with reversed normals."""
    return [
        f"“{receiver.name}” looks down, away from sun and sky; if it should not, turn its normals."
        for receiver, sensors in zip(scene.receivers, parts, strict=True)
        if receiver.sides == "front" and sensors.normals[:, 2].mean() < _DOWN
    ]


def wound(surface: Surface) -> tuple[str, ...]:
    """A sentence where its faces look different ways, or inward though they enclose something.

    A mesh that gathers on both sides may look inward.
    """
    name, report = surface.name, inspect(surface.mesh)
    if report.twisted_edges:
        number = report.twisted_edges
        edges = "edge has" if number == 1 else "edges have"
        return (
            f"“{name}”: {number:,} {edges} faces that look opposite ways, so part of it is "
            f"measured on its wrong side; {_REMEDY}",
        )
    if report.inside_out and surface.sides == "front":
        share = f" in {report.inside_out:,} of its {report.parts:,} parts"
        return (
            f"“{name}” is closed and looks inward{share if report.parts > 1 else ''}, so it is "
            f"measured on its inner side; {_REMEDY}",
        )
    return ()
