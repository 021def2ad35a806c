"""Instances: what collections, vertices, faces, particles and Geometry Nodes show many times.

An instance is what the object that is shown is to Heliform, and where that is nothing, what its
instancer is. Only bodies may be instances.
"""

from dataclasses import dataclass, field

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.copies import copied, joined
from ...engines.core.scene import Mesh
from .meshes import from_blender, from_block

_UPON = ("VERTS", "FACES")
"""Instancing of children, which themselves are then only patterns."""


@dataclass(slots=True)
class Copies:
    """What one instancer shows of one body: ``owner`` is whose material it has.

    Each of ``parts`` is a mesh in its own axes and the 4×4 matrices that place it, Blender units.
    """

    instancer: bpy.types.Object
    owner: bpy.types.Object
    parts: dict[int, tuple[Mesh, list[NDArray[np.float64]]]] = field(default_factory=dict)

    @property
    def is_own(self) -> bool:
        """Whether they are the instancer's, rather than another body's."""
        return self.owner == self.instancer

    def mesh(self, scale: float) -> Mesh | None:
        """All of them in metres, None without a face; ``scale`` is the metres in a Blender unit."""
        found = [copied(mesh, scale * np.array(places)) for mesh, places in self.parts.values()]
        found = [mesh for mesh in found if len(mesh.faces)]
        return joined(found) if found else None


@dataclass(slots=True)
class Shown:
    """What instancers show: ``copies`` of bodies, and ``own``, which of them show themselves.

    ``replaced`` are the objects that are no meshes: their own faces are among the copies.
    """

    copies: list[Copies]
    own: set[bpy.types.Object]
    replaced: set[bpy.types.Object]


def any_instancer(depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether anything in the view layer shows instances."""
    return any(is_instancer(obj, depsgraph) for obj in depsgraph.view_layer.objects)


def is_instancer(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Whether an object shows a collection, children or particles, or instances of its nodes."""
    if not may_instance(obj):
        return False
    if obj.is_instancer or obj.particle_systems:
        return True
    geometry = obj.evaluated_get(depsgraph).evaluated_geometry()
    return geometry.instances_pointcloud() is not None


def may_instance(obj: bpy.types.Object) -> bool:
    """Whether an object has what shows instances, as far as is quick to tell."""
    if obj.is_instancer or obj.particle_systems:
        return True
    return any(modifier.type == "NODES" for modifier in obj.modifiers)


def is_pattern(obj: bpy.types.Object) -> bool:
    """Whether an object is only there to be shown on its parent's vertices or faces."""
    return obj.parent is not None and obj.parent.instance_type in _UPON


def read_instances(depsgraph: bpy.types.Depsgraph) -> Shown:
    """What all instancers that are on and visible show of bodies."""
    shown = Shown([], set(), set())
    found: dict[tuple[int, int], Copies] = {}
    meshes: dict[int, Mesh] = {}
    for row in depsgraph.object_instances:
        if not row.is_instance:
            shown.own.add(row.object.original)
            continue
        if row.object.type != "MESH":
            continue
        original, instancer = row.object.original, row.parent.original
        owner = _owner(original, instancer)
        if owner is None or owner.heliform.role != "BODY":
            continue
        key = owner.session_uid, instancer.session_uid
        if key not in found:
            found[key] = Copies(instancer, owner)
        if original == instancer and original.type != "MESH":
            shown.replaced.add(original)
        parts, pointer = found[key].parts, row.object.data.as_pointer()
        if pointer not in meshes:
            meshes[pointer] = _mesh(row.object, depsgraph)
        if pointer not in parts:
            parts[pointer] = meshes[pointer], []
        parts[pointer][1].append(np.array(row.matrix_world, dtype=np.float64))
    shown.copies = sorted(found.values(), key=lambda c: (c.owner.name, c.instancer.name))
    return shown


def left_out(depsgraph: bpy.types.Depsgraph) -> list[str]:
    """A sentence for each lamp and receiver that is shown as an instance, which does nothing."""
    return [
        f"{owner.heliform.role.capitalize()} “{owner.name}” is shown as an instance by "
        f"“{instancer.name}” and left out there, for only bodies may be instances; use "
        f"Object › Apply › Make Instances Real."
        for owner, instancer in _others(depsgraph)
    ]


def _others(
    depsgraph: bpy.types.Depsgraph,
) -> list[tuple[bpy.types.Object, bpy.types.Object]]:
    """Lamps and receivers that are shown as instances, each with what shows it."""
    if not any_instancer(depsgraph):
        return []
    found = {
        (row.object.original, row.parent.original)
        for row in depsgraph.object_instances
        if row.is_instance and row.object.original.heliform.role in ("LAMP", "RECEIVER")
    }
    real = [
        (shown, by)
        for shown, by in found
        if _owner(shown, by) == shown and not (shown == by and shown.type != "MESH")
    ]
    return sorted(real, key=lambda pair: (pair[0].name, pair[1].name))


def _owner(original: bpy.types.Object, instancer: bpy.types.Object) -> bpy.types.Object | None:
    """Whose role and material an instance has; None where what shows it or it itself is off."""
    if not (original.heliform.on and instancer.heliform.on):
        return None
    return instancer if original.heliform.role == "NONE" else original


def _mesh(instance: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Mesh:
    """What an instance shows, in its own axes and Blender units: an object, or mere geometry."""
    if not instance.data.polygons:
        return Mesh(np.zeros((0, 3)), np.zeros((0, 3), np.int32))
    whole = instance.original.evaluated_get(depsgraph)
    if whole.type == "MESH" and whole.data.as_pointer() == instance.data.as_pointer():
        return from_blender(whole)
    return from_block(instance.data)
