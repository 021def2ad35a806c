"""The glass object: a printed wall swept around a lobed base curve."""

from dataclasses import dataclass

import numpy as np

from ..core.errors import ParameterError
from ..core.parameters import from_table, nested, param, to_table
from ..core.scene import Mesh
from .base import Curve, base_curve
from .bead import Bead
from .wall import Section, half_layers, levels, wall_section

_WHERE = "glass.object"
_STEEPNESS = 0.35  # a face's height over its width: the bead bends far more than the base curve
_FEWEST_AROUND = 24


@dataclass(frozen=True, slots=True, kw_only=True)
class GlassObject:
    """A printed vessel without a floor: a beaded wall around a round or lobed base curve."""

    width: float = param(0.217, "m", 0.02, 2.0, "Size along X, over the outermost beads")
    depth: float = param(0.217, "m", 0.02, 2.0, "Size along Y, over the outermost beads")
    height: float = param(0.209, "m", 0.005, 2.0, "Height; the topmost layer is ground off there")
    lobes: int = param(0, "", 0, 12, "Bulges around the plan; 0 is a plain tube")
    lobe: float = param(0.08, "", 0.0, 0.3, "How far a bulge stands out, over the mean radius")
    wall: float = param(8.0e-3, "m", 1e-3, 0.05, "Wall thickness, from bead apex to bead apex")
    faces: int = param(260_000, "", 1000, 2_000_000, "How many faces the mesh should have")
    bead: Bead = nested(Bead, "Relief of one printed layer")  # noqa: RUF009


TABLE_1 = {
    "tube": GlassObject(width=0.217, depth=0.217, height=0.209, faces=263_783),
    "three_bulges": GlassObject(
        width=0.262, depth=0.283, height=0.201, lobes=3, lobe=0.1, faces=244_668
    ),
    "four_bulges": GlassObject(
        width=0.231, depth=0.245, height=0.201, lobes=4, lobe=0.08, faces=237_827
    ),
}
"""The three printed objects of the thesis's Table 1, with its sizes and face counts.

Assumed, since the table does not say: bulges are lobes in plan, and the wall is 8 mm thick.
"""


def glass_object(record: GlassObject) -> Mesh:
    """The closed mesh of a printed vessel, in quadrilaterals.

    The wall stands on z = 0 around the Z axis. Both sides carry the beads' relief; flat rims close
    it above and below. Corner normals are those of the exact surface C(θ) + N(θ) δ(z), creased at
    layer boundaries and rims. The number of faces is the record's to within half a column of
    faces, 2 % at worst for 24 points around.

    Raises ParameterError when a value is out of bounds, the bead does not fit its layer or the
    wall, the height holds no whole layer, the wall is too thick for the plan, or the faces are
    too few for the layers.
    """
    record = from_table(GlassObject, to_table(record), _WHERE)
    _check_bead(record)
    plan = base_curve(record.width, record.depth, record.lobes, record.lobe, _FEWEST_AROUND)
    _check_plan(record, plan)
    around, parts, rings = _grid(record, plan.length)
    curve = base_curve(record.width, record.depth, record.lobes, record.lobe, around)
    return sweep(curve, wall_section(record.wall, record.height, record.bead, parts, rings))


def sweep(curve: Curve, section: Section) -> Mesh:
    """The closed surface that ``section`` (K points) leaves around ``curve`` (N points).

    K·N vertices, section point by section point, and as many quadrilaterals.
    """
    k, n = len(section.offset), len(curve.points)
    vertices = np.empty((k, n, 3))
    vertices[..., :2] = curve.points + section.offset[:, None, None] * curve.normals
    vertices[..., 2] = section.height[:, None]

    ring = np.arange(n, dtype=np.int32)
    row = np.arange(k, dtype=np.int32)[:, None] * np.int32(n)
    here, ahead = ring, np.roll(ring, -1)
    above = np.roll(row, -1)
    faces = np.empty((k, n, 4), dtype=np.int32)
    normals = np.empty((k, n, 4, 3), dtype=np.float32)
    corners = (
        (row, here, section.start),
        (row, ahead, section.start),
        (above, ahead, section.end),
        (above, here, section.end),
    )
    across = curve.normals.astype(np.float32)
    for corner, (level, place, lean) in enumerate(corners):
        lean = lean.astype(np.float32)
        faces[:, :, corner] = level + place
        normals[:, :, corner, :2] = lean[:, None, :1] * across[place]
        normals[:, :, corner, 2] = lean[:, 1:]
    return Mesh(vertices.reshape(-1, 3), faces.reshape(-1, 4), normals.reshape(-1, 4, 3))


def _check_bead(record: GlassObject) -> None:
    bead = record.bead
    if bead.depth > bead.height / 2:
        raise ParameterError(
            f"[{_WHERE}] The bead bulges {_mm(bead.depth)}, more than half its height of "
            f"{_mm(bead.height)}; lower bead.sag to {_mm(bead.height / 2)} or less."
        )
    if bead.depth >= record.wall / 2:
        raise ParameterError(
            f"[{_WHERE}] Beads that bulge {_mm(bead.depth)} on both sides leave nothing of a wall "
            f"of {_mm(record.wall)}; lower bead.sag or take a wall above {_mm(2 * bead.depth)}."
        )
    if record.height < bead.height:
        raise ParameterError(
            f"[{_WHERE}] A height of {_mm(record.height)} holds no whole layer of "
            f"{_mm(bead.height)}; raise the height or lower bead.height."
        )


def _check_plan(record: GlassObject, plan: Curve) -> None:
    # Of this family of curves, a wall that is thinner than the tightest bend meets itself nowhere.
    if plan.bend <= record.wall:
        raise ParameterError(
            f"[{_WHERE}] The tightest bend has a radius of {_mm(plan.bend)}, too little for a wall "
            f"of {_mm(record.wall)}: its inside would fold over; take a thinner wall, fewer or "
            "smaller lobes, or a larger object."
        )


def _grid(record: GlassObject, length: float) -> tuple[int, int, int]:
    """Points around, steps to a half layer and rings to a rim that come to the face count."""
    fewest = max(_FEWEST_AROUND, 8 * record.lobes)
    ideal = np.sqrt(_STEEPNESS * record.faces * length / (2 * record.height))
    rings = max(1, round((record.wall - 2 * record.bead.depth) * ideal / length))
    finest = max(1, round(record.bead.height / 2 * ideal / (_STEEPNESS * length)))
    for parts in range(finest, 0, -1):
        rows = len(levels(record.height, record.bead, parts)) - 1
        around = round(record.faces / (2 * (rows + rings)))
        if around >= fewest:
            return around, parts, rings
    halves = half_layers(record.height, record.bead)
    raise ParameterError(
        f"[{_WHERE}] {record.faces} faces are too few for {(halves + 1) // 2} layers; take at "
        f"least {2 * fewest * (halves + rings)}, or higher layers."
    )


def _mm(metres: float) -> str:
    return f"{metres * 1e3:.4g} mm"
