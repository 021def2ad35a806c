"""Small scenes whose light is known in closed form, and the map of their one receiver."""

import numpy as np
import trimesh
from heliform.engines.core.scene import (
    Body,
    Lamp,
    Luminaire,
    Material,
    Mesh,
    Plane,
    Receiver,
    Scene,
    Surface,
    plane_receiver,
)
from heliform.engines.core.unwrap import unwrap
from heliform.engines.light import IrradianceMap, PhotonTracing, trace

GLASS = Material(kind="dielectric", ior=1.5)


def at(x=0.0, y=0.0, z=0.0, axis=(0.0, 0.0, -1.0)):
    """A pose at (x, y, z) whose −Z looks along ``axis``."""
    back = -np.asarray(axis, float) / np.linalg.norm(axis)
    side = np.cross([0.0, 1.0, 0.0] if abs(back[1]) < 0.9 else [1.0, 0.0, 0.0], back)
    side /= np.linalg.norm(side)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([side, np.cross(back, side), back])
    pose[:3, 3] = x, y, z
    return pose


def floor(width, resolution, pose=None, length=None) -> Receiver:
    plane = Plane(width=width, length=length or width, resolution=resolution)
    return plane_receiver("Floor", plane, np.eye(4) if pose is None else pose)


def texel_centres(receiver: Receiver):
    """World places (rows, columns, 3) of the texels' centres."""
    s = (np.arange(receiver.columns) + 0.5) / receiver.columns
    t = (np.arange(receiver.rows) + 0.5) / receiver.rows
    return receiver.origin + s[None, :, None] * receiver.u + t[:, None, None] * receiver.v


def lambertian_point(candela, height) -> Luminaire:
    lamp = Lamp(source="disk", flux=np.pi * candela, opening="round", width=0.0)
    return Luminaire("Point", lamp, at(z=height))


def beam(lux, width, pose) -> Luminaire:
    """A round parallel beam of ``lux`` across itself."""
    lamp = Lamp(source="beam", flux=lux * np.pi * width**2 / 4, opening="round", width=width)
    return Luminaire("Beam", lamp, pose)


def sheet(lux, length, width, pose) -> Luminaire:
    """A rectangular parallel beam, ``length`` along its X and ``width`` along its Y."""
    flux = lux * length * width
    lamp = Lamp(source="beam", flux=flux, opening="rectangular", width=width, length=length)
    return Luminaire("Sheet", lamp, pose)


def box(x, y, z, centre=(0.0, 0.0, 0.0)) -> Mesh:
    made = trimesh.creation.box((x, y, z))
    return Mesh(np.asarray(made.vertices) + centre, np.asarray(made.faces, np.int32))


def sphere(radius, subdivisions=6) -> Mesh:
    made = trimesh.creation.icosphere(subdivisions, 1.0)
    points, faces = np.asarray(made.vertices), np.asarray(made.faces, np.int32)
    return Mesh(points * radius, faces, points[faces].astype(np.float32))


def surface(mesh: Mesh, resolution: int, **more) -> Surface:
    """A mesh that gathers, in a map of its own."""
    mesh = mesh.triangles()
    texture = unwrap(mesh, resolution)
    return Surface(more.pop("name", "Surface"), mesh, texture, resolution, resolution, **more)


def inward(mesh: Mesh) -> Mesh:
    """The same mesh seen from inside."""
    normals = None if mesh.normals is None else np.ascontiguousarray(-mesh.normals[:, ::-1])
    return Mesh(mesh.vertices, np.ascontiguousarray(mesh.faces[:, ::-1]), normals)


def room(side, resolution, **more) -> tuple[Receiver, ...]:
    """The six walls of a cube about the origin, each gathering on its inner side."""
    plane = Plane(width=side, length=side, resolution=resolution, **more)
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    return tuple(
        plane_receiver(f"Wall {k}", plane, at(*(axis * side / 2), axis=axis))
        for k, axis in enumerate(axes)
    )


def point(lumens, x=0.0, y=0.0, z=0.0) -> Luminaire:
    """An isotropic point."""
    return Luminaire("Point", Lamp(source="point", flux=lumens), at(x, y, z))


def glass(mesh: Mesh) -> Body:
    return Body("Glass", mesh, GLASS)


def scene(*bodies: Body, lamp: Luminaire, receiver: Receiver) -> Scene:
    return Scene(bodies, (lamp,), (receiver,))


def traced(scene: Scene, tracing: PhotonTracing, **options) -> IrradianceMap:
    """The map of the scene's first receiver."""
    return trace(scene, tracing, **options).maps[0]
