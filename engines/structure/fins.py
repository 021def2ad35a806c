"""Members as solids, with a place for each in an image of values along them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Mesh, Vector
from .frame import Frame
from .joints import Joint, cut_lengths, mitre_planes, node_normals, square_planes
from .member_texture import TextureLayout, layout_of
from .outlines import CAPS, outlines
from .sections import Sections


@dataclass(frozen=True, slots=True)
class FinMesh:
    """A closed solid a member, in quadrilaterals.

    ``member`` (F,) int32: whose each face is; ``texture`` (F, 4, 2) float64: its corners in the
    image of ``layout``. ``vertex_member`` (V,) and ``vertex_station`` (V,): the member and the
    cross-section, 0 at its start, of each vertex of ``mesh``; ``stations`` cross-sections a member.
    """

    mesh: Mesh
    member: NDArray[np.int32]
    texture: Vector
    vertex_member: NDArray[np.int32]
    vertex_station: NDArray[np.int32]
    stations: int
    layout: TextureLayout


def member_solids(
    frame: Frame,
    sections: Sections,
    joint: Joint = "mitred",
    stations: int = 2,
    layout: TextureLayout | None = None,
    normals: Vector | None = None,
) -> FinMesh:
    """The members of ``frame`` as solids of ``sections``, one a member.

    ``stations``, at least 2, cross-sections along each; ``layout`` of the image that colours them,
    by default of as many stations; ``normals`` (N, 3) of the surface at the nodes, by default
    `node_normals`. Faces and their order depend only on the sections' shapes and on ``stations``:
    what moves or changes its dimensions has new `fin_vertices` and the same faces.
    """
    layout = layout or layout_of(len(frame.members), stations)
    faces, members, textures, owners, levels = [], [], [], [], []
    start = 0
    for index, corners in outlines(sections):
        index, count = index.astype(np.int32), corners.shape[1]
        block, station = _faces(count, stations)
        first = start + np.arange(len(index), dtype=np.int32) * (stations * count)
        faces.append((first[:, None, None] + block).reshape(-1, 4))
        members.append(np.repeat(index, len(block)))
        along = station / (stations - 1)
        textures.append(layout.coordinates(index[:, None, None], along).reshape(-1, 4, 2))
        owners.append(np.repeat(index, stations * count))
        level = np.repeat(np.arange(stations, dtype=np.int32), count)
        levels.append(np.tile(level, len(index)))
        start += len(owners[-1])
    return FinMesh(
        Mesh(
            fin_vertices(frame, sections, joint, stations, normals),
            np.concatenate(faces),
        ),
        np.concatenate(members),
        np.concatenate(textures),
        np.concatenate(owners),
        np.concatenate(levels),
        stations,
        layout,
    )


def fin_vertices(
    frame: Frame,
    sections: Sections,
    joint: Joint = "mitred",
    stations: int = 2,
    normals: Vector | None = None,
) -> Vector:
    """The vertices (V, 3) in m of `member_solids` alone, in the same order."""
    axes, ends, lengths = frame.axes(), frame.ends(), frame.lengths()
    up = node_normals(frame) if normals is None else normals
    is_mitred = joint == "mitred"
    planes = mitre_planes(frame, sections.width, up) if is_mitred else square_planes(frame)
    up = up[frame.members]
    fractions = np.linspace(0.0, 1.0, stations)[:, None]
    found = []
    for index, corners in outlines(sections):
        along, length = axes[index, 0], lengths[index]
        arms = corners @ axes[index, 1:]
        start = cut_lengths(planes[index, 0], along, up[index, 0], arms, length)
        end = cut_lengths(planes[index, 1], -along, up[index, 1], arms, length)
        place = start[:, None] + fractions * (length[:, None] - end - start)[:, None]
        base = ends[index, 0, None] + arms
        points = base[:, None] + place[..., None] * along[:, None, None]
        found.append(points.reshape(-1, 3))
    return np.concatenate(found)


def deformed(
    fins: FinMesh, frame: Frame, deflections: Vector, rotations: Vector, scale: float = 1.0
) -> Vector:
    """The vertices (V, 3) in m of ``fins`` where the members are bent.

    ``deflections`` (M, S, 3) in m, world axes, at the stations of ``fins``; ``rotations`` (M, 2, 3)
    in rad, world axes, of the members' ends; both times ``scale``. Cross-sections turn without a
    change of shape: at the ends by the rotations, so that solids which meet stay together, between
    them by the slope of the axis, with the twist that grows evenly from end to end.
    """
    ends = frame.ends()
    fractions = np.linspace(0.0, 1.0, fins.stations)
    axis = ends[:, :1] + fractions[:, None] * (ends[:, 1:] - ends[:, :1])
    turns = _turns(frame, deflections, rotations, fractions) * scale
    member, station = fins.vertex_member, fins.vertex_station
    arms = fins.mesh.vertices - axis[member, station]
    moved = (axis + scale * deflections)[member, station]
    return moved + np.einsum("vij,vj->vi", _rotation(turns)[member, station], arms)


def _faces(corners: int, stations: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """The faces (n, 4) of one solid and the station (n, 4) of each of their corners."""
    here = np.arange(corners)
    after = np.roll(here, -1)
    ring = np.arange(stations - 1)[:, None] * corners
    sides = np.stack([ring + here, ring + after, ring + corners + after, ring + corners + here], -1)
    cap = CAPS[corners]
    last = (stations - 1) * corners
    faces = np.concatenate([sides.reshape(-1, 4), cap[:, ::-1], cap + last]).astype(np.int32)
    return faces, faces // corners


def _turns(frame: Frame, deflections: Vector, rotations: Vector, fractions: Vector) -> Vector:
    """Rotation vectors (M, S, 3) of the cross-sections."""
    turns = rotations[:, :1] + fractions[:, None] * (rotations[:, 1:] - rotations[:, :1])
    if len(fractions) > 2:
        along = frame.axes()[:, 0]
        slopes = np.gradient(deflections, fractions, axis=1) / frame.lengths()[:, None, None]
        bent = np.cross(along[:, None], slopes)
        twist = np.einsum("msi,mi->ms", turns, along)[..., None] * along[:, None]
        turns[:, 1:-1] = (bent + twist)[:, 1:-1]
    return turns


def _rotation(turns: Vector) -> Vector:
    """Rotation matrices (..., 3, 3) of rotation vectors, after Rodrigues."""
    angle = np.linalg.norm(turns, axis=-1)
    axis = turns / np.where(angle > 0, angle, 1.0)[..., None]
    x, y, z = np.moveaxis(axis, -1, 0)
    zero = np.zeros_like(x)
    spin = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=-1).reshape(*x.shape, 3, 3)
    sine, versine = np.sin(angle)[..., None, None], (1 - np.cos(angle))[..., None, None]
    return np.eye(3) + sine * spin + versine * (spin @ spin)
