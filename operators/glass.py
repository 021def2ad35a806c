"""Glass: adding printed objects, checking and repairing them."""

import bpy
from bpy.props import EnumProperty
from bpy.types import Context, Object, Operator

from ..addon import objects
from ..addon.bridge.meshes import from_blender
from ..addon.bridge.read import read_mesh
from ..addon.properties import (
    draw,
    enum_items,
    read,
    scale_of,
    with_properties,
    write,
    write_unset,
)
from ..engines.core import solid
from ..engines.glass import TABLE_1, GlassObject
from . import ObjectMode, Reporting, in_object_mode

CUSTOM = "custom"
NAMES = {"tube": "Tube", "three_bulges": "Three Bulges", "four_bulges": "Four Bulges"}

_PRESETS = enum_items(TABLE_1, "Size and face count as in Table 1 of the thesis")


@with_properties(GlassObject)
class HELIFORM_OT_add_glass_object(ObjectMode, Operator):
    """Add a printed glass vessel that stands at the 3D cursor"""

    bl_idname = "heliform.add_glass_object"
    bl_label = "Add Glass"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(
        name="Preset",
        description="A printed object of the thesis, or your own",
        items=[*_PRESETS, *enum_items([CUSTOM], "The values below")],
        default="tube",
    )

    def act(self, context: Context) -> None:
        """Add the object; a preset also fills in the values that the redo panel shows."""
        scale = scale_of(context.scene)
        if self.preset != CUSTOM:
            write(self, TABLE_1[self.preset], scale)
        else:
            write_unset(self, GlassObject(), scale)
        record = read(self, GlassObject, scale)
        objects.add_glass(context, record, NAMES.get(self.preset, "Glass"))

    def draw(self, context: Context) -> None:
        """The preset, and the values once they are the user's own."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "preset")
        column = layout.column()
        column.enabled = self.preset == CUSTOM
        draw(column, self, GlassObject)


class HELIFORM_OT_reshape_glass(Reporting, Operator):
    """Give the active glass object the values of a printed one"""

    bl_idname = "heliform.reshape_glass"
    bl_label = "Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(name="Preset", items=_PRESETS)

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only where Heliform made the active object's mesh."""
        obj = context.object
        return obj is not None and obj.heliform.form == objects.GLASS and in_object_mode(context)

    def act(self, context: Context) -> None:
        """Reshape the active object."""
        objects.set_glass(context.object, TABLE_1[self.preset], context.scene)


class _OnMeshes(ObjectMode):
    """An operator on the selected meshes."""

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a mesh selected, in Object Mode."""
        if not _chosen(context):
            cls.poll_message_set("Select a mesh that is no lamp or receiver")
            return False
        return super().poll(context)


class HELIFORM_OT_check_glass(_OnMeshes, Operator):
    """Check whether the selected meshes are closed solids, as glass must be"""

    bl_idname = "heliform.check_glass"
    bl_label = "Check"

    def act(self, context: Context) -> str:
        """Inspect each. Raises SceneError for the first that is no solid."""
        depsgraph = context.evaluated_depsgraph_get()
        for obj in _chosen(context):
            solid.require_solid(obj.name, read_mesh(obj, depsgraph))
        return _each(_chosen(context), "is a closed solid", "are closed solids")


class HELIFORM_OT_repair_glass(_OnMeshes, Operator):
    """Make the selected meshes closed solids: join, drop, turn and fill faces"""

    bl_idname = "heliform.repair_glass"
    bl_label = "Repair"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> str:
        """Repair each; where a mesh has to change, its modifiers and shape keys are applied."""
        depsgraph = context.evaluated_depsgraph_get()
        said = []
        for obj in _chosen(context):
            mesh, notes = solid.repair(from_blender(obj.evaluated_get(depsgraph)))
            if notes:
                objects.replace_mesh(obj, mesh)
                said.append(f"“{obj.name}”: {' '.join(notes)}")
        return " ".join(said) or _each(_chosen(context), "needs no repair", "need no repair")


def _chosen(context: Context) -> list[Object]:
    """The selected meshes that are or could be bodies."""
    return [
        obj
        for obj in context.selected_objects
        if obj.type == "MESH" and obj.heliform.role in ("NONE", "BODY")
    ]


def _each(chosen: list[Object], one: str, many: str) -> str:
    return f"“{chosen[0].name}” {one}." if len(chosen) == 1 else f"{len(chosen)} meshes {many}."


_CLASSES = (
    HELIFORM_OT_add_glass_object,
    HELIFORM_OT_reshape_glass,
    HELIFORM_OT_check_glass,
    HELIFORM_OT_repair_glass,
)
register, unregister = bpy.utils.register_classes_factory(_CLASSES)
