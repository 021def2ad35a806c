"""What a lamp looks like in a viewport, and which receiver a mesh is."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..core.errors import SceneError
from ..core.meshes import Textured
from ..core.scene import Lamp, Luminaire, Mesh, Plane, Receiver, Surface, Vector
from .luminaires import Source, source
from .photometry import beam_angle

Edges = NDArray[np.int32]

AROUND = 64
_REACH = 0.1
_CROSS = 0.01
_CLOSE = 1e-4  # of a receiver's size: how far it may be from a rectangle


# The lamp


def lamp_outline(luminaire: Luminaire) -> tuple[Vector, Edges]:
    """A lamp as lines about its own axes: points (N, 3) in m, edges (E, 2) int32 between them.

    The luminous opening at its true size (a cross for a point), an arrow along the axis, and the
    beam out to 0.1 m or 1.5 times the opening: where the intensity is half of its maximum, a tube
    for parallel light, a sphere where the light goes everywhere. The flux does not matter.

    Raises SceneError for a parallel beam without an opening, FileError for a photometric file that
    cannot be read.
    """
    lamp = luminaire.lamp
    if lamp.source != "ies":
        luminaire = replace(luminaire, lamp=replace(lamp, flux=1.0))
    settled = source(luminaire)
    reach = max(_REACH, 1.5 * settled.width, 1.5 * settled.length)
    return _joined([*_opening(settled), *_arrow(reach), *_beam(settled, reach)])


Line = tuple[Vector, bool]
"""Points (N, 3) in a row, and whether the last is joined to the first."""


def _joined(lines: list[Line]) -> tuple[Vector, Edges]:
    edges, start = [], 0
    for points, closed in lines:
        here = np.arange(start, start + len(points))
        pairs = np.column_stack([here, np.roll(here, -1)])
        edges.append(pairs if closed else pairs[:-1])
        start += len(points)
    return np.concatenate([points for points, _ in lines]), np.concatenate(edges).astype(np.int32)


def _turn(count: int = AROUND) -> Vector:
    return np.arange(count, dtype=np.float64) * (2 * np.pi / count)


def _opening(settled: Source) -> list[Line]:
    if settled.shape == "point":
        axes = np.eye(3) * (_CROSS / 2)
        return [(np.stack([-axis, axis]), False) for axis in axes]
    return [(_rim(settled, _turn()), True)]


def _rim(settled: Source, angle: Vector) -> Vector:
    """Points (N, 3) of the opening's edge at ``angle`` (N,) from +X."""
    x, y = np.cos(angle), np.sin(angle)
    if settled.shape == "point":
        x, y = np.zeros_like(x), np.zeros_like(y)
    elif settled.shape == "rectangular":
        # The angle runs with the circle's, so that the four corners come at odd multiples of 45°.
        widest = np.maximum(np.abs(x), np.abs(y))
        x, y = x / widest, y / widest
    return np.column_stack([x * settled.length / 2, y * settled.width / 2, np.zeros_like(x)])


def _arrow(reach: float) -> list[Line]:
    barb = 0.06 * reach
    tip = np.array([0.0, 0.0, -reach])
    barbs = [np.array([side, 0.0, 1.5 * barb]) for side in (-barb, barb)]
    return [
        (np.stack([np.zeros(3), tip]), False),
        (np.stack([tip + barbs[0], tip, tip + barbs[1]]), False),
    ]


def _beam(settled: Source, reach: float) -> list[Line]:
    turn, sides = _turn(), _turn(4)
    if settled.distribution is None:
        down = np.array([0.0, 0.0, -reach])
        far, near = _rim(settled, turn) + down, _rim(settled, sides)
        return [(far, True), *((np.stack([p, p + down]), False) for p in near)]
    half = np.array([beam_angle(settled.distribution, a) / 2 for a in np.degrees(turn)])
    if half.max() > 90:
        return _sphere(reach)
    half = np.radians(half)
    leaning = np.column_stack([np.sin(half) * np.cos(turn), np.sin(half) * np.sin(turn)])
    far = _rim(settled, turn) + reach * np.column_stack([leaning, -np.cos(half)])
    quarters = np.arange(4) * (AROUND // 4)
    spokes = np.stack([_rim(settled, sides), far[quarters]], axis=1)
    return [(far, True), *((spoke, False) for spoke in spokes)]


def _sphere(radius: float) -> list[Line]:
    angle = _turn()
    circle = radius * np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])
    return [(circle[:, order], True) for order in ([0, 1, 2], [2, 0, 1], [1, 2, 0])]


def placed_lamp(name: str, lamp: Lamp, matrix: NDArray[np.float64]) -> Luminaire:
    """A lamp at a 4×4 affine ``matrix`` whose scale, where it has one, is that of its opening.

    Raises SceneError when a round opening would become an ellipse or the matrix is flat, FileError
    for a photometric file that cannot be read where its opening is to be scaled.
    """
    pose = np.asarray(matrix, dtype=np.float64).copy()
    scale = np.linalg.norm(pose[:3, :3], axis=0)
    if scale.min() == 0:
        raise SceneError(f"Lamp “{name}” has a scale of 0; set it to 1.")
    pose[:3, :3] /= scale
    if lamp.source == "point" or np.allclose(scale[:2], 1.0, atol=1e-5):
        return Luminaire(name, lamp, pose)
    if lamp.source == "ies" and lamp.opening == "file":
        own = source(Luminaire(name, lamp))
        if own.shape == "point":
            return Luminaire(name, lamp, pose)
        lamp = replace(lamp, opening=own.shape, width=own.width, length=own.length)
    if lamp.opening != "rectangular" and not np.isclose(scale[0], scale[1], rtol=1e-4):
        raise SceneError(
            f"Lamp “{name}” is round and scaled {scale[0]:.4g} along X but {scale[1]:.4g} along Y; "
            "give it the same scale along both, or a rectangular opening."
        )
    lamp = replace(lamp, width=lamp.width * scale[1], length=lamp.length * scale[0])
    return Luminaire(name, lamp, pose)


# The receiver


def plane_mesh(plane: Plane) -> tuple[Mesh, NDArray[np.float32]]:
    """A plane as one quadrilateral about its own origin, and its texture coordinates (4, 2)."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
    size = np.array([plane.width, plane.length, 0.0])
    corners = np.column_stack([square - 0.5, np.zeros(4)]).astype(np.float64) * size
    return Mesh(corners, np.arange(4, dtype=np.int32)[None]), square


class NoRectangle(SceneError):
    """A surface that no `Receiver` can be."""


def receiver_of(name: str, found: Textured, plane: Plane) -> Receiver | Surface:
    """The receiver that a mesh in the world is, of the resolution, sides and reflectance given.

    A flat rectangle that its texture coordinates span is one, everything else is a surface. Raises
    SceneError, naming it, where a rectangle is mirrored against its texture coordinates.
    """
    found = found.triangles()
    mesh, texture = Mesh(found.mesh.vertices, found.mesh.faces), found.texture
    assert texture is not None
    kept = {"sides": plane.sides, "reflectance": plane.reflectance}
    corners = mesh.vertices[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    if _is_flat(normals):
        try:
            flat = corners.reshape(-1, 3), texture.reshape(-1, 2), normals.sum(axis=0)
            return replace(rectangle_receiver(name, *flat, plane.resolution), **kept)
        except NoRectangle:
            pass
    return Surface(name, mesh, texture, plane.resolution, plane.resolution, **kept)


def _is_flat(normals: Vector) -> bool:
    """Whether all faces look one way, roughly: enough to be worth a closer look."""
    mean = normals.sum(axis=0)
    along = normals @ mean
    lengths = np.sqrt((normals * normals).sum(axis=1) * (mean @ mean))
    return bool((along >= 0.99 * lengths).all())


def rectangle_receiver(
    name: str, corners: Vector, texture: Vector, normal: Vector, resolution: int
) -> Receiver:
    """The receiver that a flat rectangular surface is.

    ``corners`` (N, 3) are its face corners in m, ``texture`` (N, 2) their texture coordinates,
    which must span 0..1 over the rectangle; ``normal`` (3,) is the side its faces look to, of any
    length. ``resolution`` texels go along the longer side.

    Raises NoRectangle, naming the receiver, when the surface is no rectangle or is not spanned by
    its texture coordinates, SceneError when it is mirrored against them.
    """
    frame = np.column_stack([np.ones(len(corners)), texture])
    solved, _, rank, _ = np.linalg.lstsq(frame, corners, rcond=None)
    origin, u, v = solved
    sizes = np.linalg.norm([u, v], axis=1)
    slack = _CLOSE * max(sizes.max(), np.finfo(float).tiny)
    spread = np.concatenate([texture.min(axis=0), texture.max(axis=0)])
    if rank < 3 or not np.allclose(spread, [0, 0, 1, 1], atol=_CLOSE):
        raise NoRectangle(
            f"Receiver “{name}” needs a UV map that spans the whole picture once; "
            "reset it with UV › Reset in Edit Mode."
        )
    flat = np.abs(frame @ solved - corners).max() <= slack
    if not flat or sizes.min() <= slack or abs(u @ v) > _CLOSE * sizes.prod():
        raise NoRectangle(
            f"Receiver “{name}” is not one flat rectangle; use a plane, or Add Receiver."
        )
    if np.cross(u, v) @ normal < 0:
        raise SceneError(
            f"Receiver “{name}” is mirrored, and its picture would be too; "
            "make its scale positive, or mirror its UV map."
        )
    columns, rows = np.maximum(np.round(resolution * sizes / sizes.max()), 1).astype(int)
    return Receiver(name, origin, u, v, int(columns), int(rows))
