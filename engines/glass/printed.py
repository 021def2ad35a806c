"""The printed wall as a mesh: a loft, half a thickness to both sides, and the bead's relief."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..core.errors import ParameterError
from ..core.scene import Mesh, Vector
from .bead import Bead
from .loft import WHERE, Loft, Wall, wall_loft
from .overlap import is_clear
from .skin import Skin
from .wall import Section, half_layers, levels, wall_section

__all__ = ["Wall", "wall_mesh", "wall_skin"]

_STEEPNESS = 0.08  # a face's height over its width: the bead bends far more than the base curve
_FEWEST_AROUND = 24
_COARSEST = 2  # steps to a half layer that a bead has before a tight bend takes points from it
_TURN = 0.1  # rad that a plan may turn from point to point in its tightest bend
_AROUND = 512  # places around at which a blended wall is tested for overlaps
_BENDS = 129  # heights at which its bends are, and of these every eighth its sides
_SIDES = 8
_MEAN = 17  # heights that its mean length is taken of


def wall_mesh(wall: Wall, curves: Sequence[Vector] = ()) -> Mesh:
    """The closed mesh of a printed wall, in quadrilaterals, standing on z = 0.

    Both sides carry the bead's relief, its crests half a thickness from the loft along the
    section's normal; flat rims close it. Corner normals are those of the exact surface
    P(u, z) + δ(z) N(u, z), creased at layer boundaries and rims. ``curves`` as in `wall_loft`. The
    number of faces is the record's to within half a column of faces.

    Raises ParameterError as `wall_loft` does, and when the bead does not fit its layer or the
    wall, the height holds no whole layer, the wall folds over between its base curves, or the
    faces are too few for the layers.
    """
    loft = _checked_loft(wall, curves)
    around, parts, rings = _grid(wall, loft)
    section = wall_section(wall.thickness, loft.height, wall.bead, parts, rings)
    return _swept(loft, section, around, wall.thickness)


def wall_skin(wall: Wall, curves: Sequence[Vector] = ()) -> tuple[Mesh, Skin]:
    """The wall without relief, through the crests, vertex by vertex on the grid of `wall_mesh`.

    And its skin, for a relief to be put on. Raises as `wall_mesh`, but not for the bead's sag: of
    the bead this wall has the layers only.
    """
    flat = replace(wall.bead, style="flat")
    loft = _checked_loft(replace(wall, bead=flat), curves)
    around, parts, rings = _grid(wall, loft)
    section = wall_section(wall.thickness, loft.height, flat, parts, rings)
    turn = np.arange(around) / around
    side = 1 + 2 * section.offset / wall.thickness
    skin = Skin(
        normal=loft.at(turn, section.height[:, None]).normal.reshape(-1, 2),
        side=np.repeat(side, around),
        turn=np.tile(turn, len(side)),
        girth=float(loft.length(_heights(loft)).mean()),
    )
    return _swept(loft, section, around, wall.thickness), skin


def _checked_loft(wall: Wall, curves: Sequence[Vector]) -> Loft:
    """The wall's loft, once the bead fits it and both faces miss themselves."""
    loft = wall_loft(wall, curves)
    _check_bead(wall.bead, wall.thickness, loft.height)
    if len(loft.outlines) > 1:
        _check_sections(loft, wall.thickness / 2)
    return loft


def _check_sections(loft: Loft, radius: float) -> None:
    """Outlines are clear themselves; what is blended between them need not be."""
    heights = np.linspace(0.0, loft.height, _BENDS)
    place = loft.at(np.arange(_AROUND) / _AROUND, heights[:, None])
    clear = np.abs(place.curvature).max(axis=1) * radius < 1
    for level in range(0, _BENDS, _SIDES):
        clear[level] &= is_clear(place.points[level, :, :2], radius)
    if not clear.all():
        z = heights[np.argmin(clear)]
        raise ParameterError(
            f"[{WHERE}] The wall runs into itself at z {_mm(z)}; take a thinner wall or base "
            "curves more alike."
        )


def _check_bead(bead: Bead, thickness: float, height: float) -> None:
    if bead.depth > bead.height / 2:
        raise ParameterError(
            f"[{WHERE}] The bead bulges {_mm(bead.depth)}, more than half its height of "
            f"{_mm(bead.height)}; lower bead.sag to {_mm(bead.height / 2)} or less."
        )
    if bead.depth >= thickness / 2:
        raise ParameterError(
            f"[{WHERE}] Beads that bulge {_mm(bead.depth)} on both sides leave nothing of a wall "
            f"of {_mm(thickness)}; lower bead.sag or take a wall above {_mm(2 * bead.depth)}."
        )
    if height < bead.height:
        raise ParameterError(
            f"[{WHERE}] A height of {_mm(height)} holds no whole layer of {_mm(bead.height)}; "
            "raise the height or lower bead.height."
        )


def _heights(loft: Loft) -> Vector:
    return np.zeros(1) if loft.prismatic else np.linspace(0.0, loft.height, _MEAN)


def _tightest(loft: Loft) -> float:
    """The largest curvature of a horizontal section in 1/m."""
    turn = np.arange(_AROUND) / _AROUND
    return float(np.abs(loft.at(turn, _heights(loft)[:, None]).curvature).max())


def _grid(wall: Wall, loft: Loft) -> tuple[int, int, int]:
    """Points around, steps to a half layer and rings to a rim that come to the face count."""
    length = float(loft.length(_heights(loft)).mean())
    ideal = np.sqrt(_STEEPNESS * wall.faces * length / (2 * loft.height))
    rings = max(1, round((wall.thickness - 2 * wall.bead.depth) * ideal / length))
    finest = max(1, round(wall.bead.height / 2 * ideal / (_STEEPNESS * length)))
    fewest = max(_FEWEST_AROUND, int(np.ceil(length * _tightest(loft) / _TURN)))
    for parts in range(finest, 0, -1):
        rows = len(levels(loft.height, wall.bead, parts)) - 1
        around = round(wall.faces / (2 * (rows + rings)))
        if around >= (fewest if parts > _COARSEST else _FEWEST_AROUND):
            return around, parts, rings
    halves = half_layers(loft.height, wall.bead)
    raise ParameterError(
        f"[{WHERE}] {wall.faces} faces are too few for {(halves + 1) // 2} layers; take at "
        f"least {2 * _FEWEST_AROUND * (halves + rings)}, or higher layers."
    )


def _swept(loft: Loft, section: Section, around: int, thickness: float) -> Mesh:
    """The closed surface that ``section`` (K points) leaves along the loft at N turns.

    K·N vertices, section point by section point, and as many quadrilaterals. Where the loft rises
    by g along its normal for each metre of height, the section is sheared: its normal (a, b),
    outward and up, becomes (a, b − g a). A turn of the normal with height leaves that as it is.
    """
    k, n = len(section.offset), around
    z, level = np.unique(section.height, return_inverse=True)
    place = loft.at(np.arange(n) / n, z[:1, None] if loft.prismatic else z[:, None])
    out = place.normal
    lean = np.einsum("...i,...i", place.rise[..., :2], out).astype(np.float32)
    centre = place.points[..., :2]
    if not loft.prismatic:
        centre, out, lean = centre[level], out[level], lean[level]
    vertices = np.empty((k, n, 3))
    vertices[..., :2] = centre + (section.offset + thickness / 2)[:, None, None] * out
    vertices[..., 2] = section.height[:, None]

    here = np.arange(n, dtype=np.int32)
    row = np.arange(k, dtype=np.int32)[:, None] * np.int32(n)
    ahead, above = np.roll(here, -1), np.roll(row, -1)
    faces = np.empty((k, n, 4), dtype=np.int32)
    normals = np.empty((k, n, 4, 3), dtype=np.float32)
    corners = (
        (row, here, section.start),
        (row, ahead, section.start),
        (above, ahead, section.end),
        (above, here, section.end),
    )
    out = out.astype(np.float32)
    upper = out, lean
    if not loft.prismatic:
        upper = np.roll(out, -1, axis=0), np.roll(lean, -1, axis=0)
    for corner, (ring, turn, tilt) in enumerate(corners):
        faces[:, :, corner] = ring + turn
        across, g = (v[:, turn] for v in (upper if ring is above else (out, lean)))
        a, b = tilt.astype(np.float32).T[:, :, None]
        if loft.prismatic:
            normals[:, :, corner, :2] = a[..., None] * across
            normals[:, :, corner, 2] = b
        else:
            up = b - g * a
            size = 1 / np.hypot(a, up)
            normals[:, :, corner, :2] = (a * size)[..., None] * across
            normals[:, :, corner, 2] = up * size
    return Mesh(vertices.reshape(-1, 3), faces.reshape(-1, 4), normals.reshape(-1, 4, 3))


def _mm(metres: float) -> str:
    return f"{metres * 1e3:.4g} mm"
