"""What an analysis is given: plain meshes with materials, luminaires and receivers.

Metres, Z up. Nothing here knows Blender, Mitsuba or a file format.
"""

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .parameters import param

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """How a surface treats light."""

    kind: Literal["dielectric", "mirror", "diffuse", "plastic", "absorber"] = param(
        "dielectric", help="Clear smooth glass, mirror, matte, matte under a gloss, or black"
    )
    ior: float = param(1.5, "", 1.0, 4.0, "Index of refraction of the glass against air")
    reflectance: float = param(
        0.8, "", 0.0, 1.0, "Share of light a mirror or matte surface returns"
    )
    specularity: float = param(
        0.0135, "", 0.0, 1.0, "Share of light that a plastic returns as a mirror does"
    )
    roughness: float = param(
        0.0, "", 0.0, 1.0, "GGX width α of a ground glass or satin mirror; 0 is smooth"
    )
    absorption: float = param(
        0.0, "1/m", 0.0, 1e4, "Light in the glass falls to 1/e over 1 ÷ this length"
    )
    transmittance: float = param(
        1.0, "", 0.0, 1.0, "Share that a pane passes at normal incidence; 1 goes by absorption"
    )
    glass: Literal["own", "soda-lime", "crown", "flint", "water"] = param(
        "own", help="Where colours are traced: index by the Abbe number below, or as published"
    )
    abbe: float = param(0.0, "", 0.0, 200.0, "Abbe number of own glass; 0 does not disperse")
    priority: int = param(
        0, "", -100, 100, "Where two bodies overlap, the one of higher priority is there"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Lamp:
    """A luminaire's photometry and luminous opening.

    It shines along its own −Z; the photometric plane C0 is its +X, C90 its +Y.
    """

    source: Literal["ies", "disk", "point", "beam"] = param(
        "ies", help="Photometric file, Lambertian opening, isotropic point, or parallel beam"
    )
    file: str = param("", help="IES LM-63 file; empty takes the PAR20-like sample")
    flux: float = param(0.0, "lm", 0.0, 1e9, "Luminous flux; 0 keeps what the IES file says")
    multiplier: float = param(1.0, "", 0.0, 1e6, "Dimming or maintenance factor on the light")
    opening: Literal["file", "round", "rectangular"] = param(
        "file", help="Shape of the luminous opening; “file” takes what the IES file says"
    )
    width: float = param(0.05, "m", 0.0, 100.0, "Diameter of the opening, or its size along Y")
    length: float = param(0.05, "m", 0.0, 100.0, "Size of a rectangular opening along X")


@dataclass(frozen=True, slots=True, kw_only=True)
class Plane:
    """A rectangular receiver about its own origin; it gathers on its +Z side."""

    width: float = param(0.8, "m", 1e-3, 1000.0, "Size along X")
    length: float = param(0.8, "m", 1e-3, 1000.0, "Size along Y")
    resolution: int = param(256, "", 1, 4096, "Texels along the longer side")
    sides: Literal["front", "both"] = param(
        "front", help="Gather on the side that the normals point to, or on both"
    )
    reflectance: float = param(
        0.0, "", 0.0, 1.0, "Share of light that it returns by Lambert's law; 0 is black"
    )


@dataclass(frozen=True, slots=True)
class Mesh:
    """A polygon mesh of triangles or of quadrilaterals.

    ``vertices`` (V, 3) float64 in m; ``faces`` (F, 3) or (F, 4) int32, counter-clockwise seen from
    outside; ``normals`` (F, 3 or 4, 3) float32 unit vectors per face corner, or None for flat
    faces. Corners rather than vertices carry normals, so that a crease between two beads stays one.
    """

    vertices: Vector
    faces: NDArray[np.int32]
    normals: NDArray[np.float32] | None = None

    def triangles(self) -> "Mesh":
        """The same surface in triangles; a quadrilateral splits along its first diagonal."""
        if self.faces.shape[1] == 3:
            return self
        split = np.array([[0, 1, 2], [0, 2, 3]])
        faces = self.faces[:, split].reshape(-1, 3)
        normals = None if self.normals is None else self.normals[:, split].reshape(-1, 3, 3)
        return Mesh(self.vertices, faces, normals)

    def moved(self, matrix: NDArray[np.floating[Any]]) -> "Mesh":
        """The mesh under a 4×4 affine ``matrix``; a mirroring one turns the faces about."""
        linear, shift = matrix[:3, :3], matrix[:3, 3]
        if np.array_equal(linear, np.eye(3)):
            return Mesh(self.vertices + shift, self.faces, self.normals)
        vertices = self.vertices @ linear.T + shift
        normals = self.normals
        if normals is not None:
            turned = normals @ np.linalg.inv(linear).astype(np.float32)
            normals = turned / np.sqrt(np.einsum("...i,...i", turned, turned))[..., None]
        faces = self.faces
        if np.linalg.det(linear) < 0:
            faces = faces[:, ::-1]
            normals = None if normals is None else normals[:, ::-1]
        return Mesh(
            vertices,
            np.ascontiguousarray(faces),
            None if normals is None else np.ascontiguousarray(normals, dtype=np.float32),
        )


@dataclass(frozen=True, slots=True)
class Body:
    """A named mesh with its material."""

    name: str
    mesh: Mesh
    material: Material


@dataclass(frozen=True, slots=True)
class Luminaire:
    """A named lamp at a place. ``pose`` (4, 4) takes its own axes to the world's."""

    name: str
    lamp: Lamp
    pose: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))


@dataclass(frozen=True, slots=True)
class Receiver:
    """A named opaque rectangle that gathers light on the side that ``u`` × ``v`` points to.

    ``origin`` (3,) is the corner at texture coordinate (0, 0), ``u`` and ``v`` (3,) its
    perpendicular edges in m; ``columns`` along u and ``rows`` along v are its texels.
    """

    name: str
    origin: Vector
    u: Vector
    v: Vector
    columns: int
    rows: int
    sides: Literal["front", "both"] = "front"
    reflectance: float = 0.0

    @property
    def normal(self) -> Vector:
        """The unit normal of the side that gathers."""
        cross = np.cross(self.u, self.v)
        return cross / np.linalg.norm(cross)

    @property
    def texel_area(self) -> float:
        """Area of one texel in m²."""
        return float(np.linalg.norm(np.cross(self.u, self.v)) / (self.columns * self.rows))


@dataclass(frozen=True, slots=True)
class Surface:
    """A named mesh that gathers light in the texels of its UV map.

    ``mesh`` is of triangles; ``texture`` (F, 3, 2) float64 are its corners' texture coordinates in
    0..1, no place of which belongs to two faces; ``columns`` along u and ``rows`` along v are the
    texels of the map.
    """

    name: str
    mesh: Mesh
    texture: NDArray[np.float64]
    columns: int
    rows: int
    sides: Literal["front", "both"] = "front"
    reflectance: float = 0.0


def plane_receiver(name: str, plane: Plane, pose: NDArray[np.float64]) -> Receiver:
    """The receiver that ``plane`` is at a 4×4 ``pose``; texels are as square as they can be."""
    u, v = pose[:3, 0] * plane.width, pose[:3, 1] * plane.length
    sizes = np.array([np.linalg.norm(u), np.linalg.norm(v)])
    columns, rows = np.maximum(np.round(plane.resolution * sizes / sizes.max()), 1).astype(int)
    texels = int(columns), int(rows)
    corner = pose[:3, 3] - (u + v) / 2
    return Receiver(name, corner, u, v, *texels, plane.sides, plane.reflectance)


@dataclass(frozen=True, slots=True)
class Scene:
    """Everything that light meets, in metres."""

    bodies: tuple[Body, ...] = ()
    luminaires: tuple[Luminaire, ...] = ()
    receivers: tuple[Receiver | Surface, ...] = ()

    def without(self, name: str) -> "Scene":
        """The scene less the body of that name."""
        return replace(self, bodies=tuple(b for b in self.bodies if b.name != name))
