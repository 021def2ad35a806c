"""Where a structure's control points and levels can be taken hold of in the view."""

import numpy as np

from ..core.scene import Vector
from .facade import facade_surface
from .level_set import Nine, values_of
from .roof import control_points as roof_points
from .shell import control_points as shell_points
from .structure import Structure
from .surface import COUNT, Net, basis, evaluate_at, net_of, shifts_of

_FURTHEST = 50.0  # m that a control point may be moved, as `Shift` has it
_REACH = 0.08  # of the structure's longest side: how far off the surface a level of 1 stands


def control_places(record: Structure) -> Vector:
    """Where the control points are, (4, 4, 3) in m, as they are moved.

    Those of a façade stand where each counts most. Of no size for a mesh, which has none.
    """
    places, axes = _unmoved(record)
    return places + np.einsum("uvi,uvij->uvj", shifts_of(record.net)[: len(places)], axes)


def net_for(record: Structure, places: Vector) -> Net:
    """The shifts that bring the control points to ``places`` (4, 4, 3) in m, as far as they go."""
    unmoved, axes = _unmoved(record)
    shifts = np.einsum("uvj,uvij->uvi", places - unmoved, axes)
    return net_of(np.clip(shifts, -_FURTHEST, _FURTHEST))


def level_places(record: Structure, levels: Nine) -> Vector:
    """Where handles of nine ``levels`` stand, (3, 3, 3) in m: as far off the surface."""
    places, off = _level_axes(record)
    return places + values_of(levels)[: len(places), :, None] * off


def levels_for(record: Structure, places: Vector) -> Nine:
    """The levels that handles at ``places`` (3, 3, 3) in m stand for."""
    feet, off = _level_axes(record)
    size = np.einsum("uvi,uvi->uv", off, off)
    values = np.einsum("uvi,uvi->uv", places - feet, off) / size
    rows = np.clip(values, -1.0, 1.0)
    return Nine(**{f"c{u}{v}": float(rows[u, v]) for u in range(3) for v in range(3)})


def _unmoved(record: Structure) -> tuple[Vector, Vector]:
    """Where control points are before they are moved, and the axes (4, 4, 3, 3) of their shifts."""
    if record.form == "mesh":
        return np.zeros((0, COUNT, 3)), np.zeros((0, COUNT, 3, 3))
    if record.form != "facade":
        points = roof_points(record.roof) if record.form == "roof" else shell_points(record.shell)
        return points, np.broadcast_to(np.eye(3), (COUNT, COUNT, 3, 3))
    fine = np.arange(64) / 64
    around = fine[basis(fine, closed=True).argmax(axis=0)]
    uv = _pairs(around, np.linspace(0.0, 1.0, COUNT))
    unmoved = facade_surface(record.facade, Net(), uv)[0]
    # The shifts of all points add up to one, so moving all alike shows where a shift goes.
    alike = (net_of(np.broadcast_to(one, (COUNT, COUNT, 3))) for one in np.eye(3))
    axes = [facade_surface(record.facade, net, uv)[0] - unmoved for net in alike]
    square = (COUNT, COUNT, 3)
    return unmoved.reshape(square), np.stack([a.reshape(square) for a in axes], axis=2)


def _level_axes(record: Structure) -> tuple[Vector, Vector]:
    """The feet (3, 3, 3) of the levels' handles, and where a level of 1 stands off them."""
    if record.form == "mesh":
        return np.zeros((0, 3, 3)), np.zeros((0, 3, 3))
    v = np.array([0.0, 0.5, 1.0])
    if record.form == "facade":
        places, normals = facade_surface(
            record.facade, record.net, _pairs(np.array([1, 3, 5]) / 6, v)
        )
        longest = record.facade.width
    else:
        points = _unmoved(record)[0]
        places, normals = evaluate_at(points + shifts_of(record.net), _pairs(v, v))
        longest = np.ptp(points, axis=(0, 1)).max()
    return places.reshape(3, 3, 3), _REACH * longest * normals.reshape(3, 3, 3)


def _pairs(u: Vector, v: Vector) -> Vector:
    """Every u with every v (U·V, 2), v fastest."""
    return np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
