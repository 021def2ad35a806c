"""Glass: adding printed objects, checking and repairing them."""

from dataclasses import replace

import bpy
from bpy.props import EnumProperty, FloatProperty
from bpy.types import Context, Event, Object, Operator

from ..addon import objects
from ..addon.bridge.meshes import from_blender
from ..addon.bridge.print_layers import relief_of_wall
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
from ..engines.core.parameters import canonical
from ..engines.glass import TABLE_1, GlassObject
from ..engines.glass.loft import Wall
from ..engines.glass.presets import PRESETS
from ..engines.glass.profile import scalloped
from . import ObjectMode, Reporting, in_object_mode
from .relief import Dressing, dress

CUSTOM = "custom"
NAMES = {"tube": "Tube", "three_bulges": "Three Bulges", "four_bulges": "Four Bulges"}

_WALLS = enum_items(PRESETS, "A wall to start from")
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


class HELIFORM_OT_add_wall(ObjectMode, Operator):
    """Add a wall that a glass printer can make, with the relief of its layers, at the 3D cursor"""

    bl_idname = "heliform.add_wall"
    bl_label = "Add Wall"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(
        name="Preset", description="A wall to start from", items=_WALLS, default="rosette"
    )

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Add it, and bring it into view where it is the first thing of Heliform's."""
        first = all(obj.heliform.role == "NONE" for obj in context.scene.objects)
        ended = self.execute(context)
        area = context.area
        if first and area and area.type == "VIEW_3D":
            region = next(r for r in area.regions if r.type == "WINDOW")
            with context.temp_override(area=area, region=region):
                bpy.ops.view3d.view_selected()
        return ended

    def act(self, context: Context) -> None:
        """Add it; its shape is in the sidebar from then on."""
        record = PRESETS[self.preset]
        obj = objects.add_wall(context, record, _name(self.preset))
        _dress(context, obj, record)


class HELIFORM_OT_wall_from_curves(ObjectMode, Operator):
    """Add a wall on the selected closed curves: one, two to loft between, or a stack"""

    bl_idname = "heliform.wall_from_curves"
    bl_label = "Wall from Curves"
    bl_options = {"REGISTER", "UNDO"}

    height: FloatProperty(
        name="Height",
        description="Height of the wall, where the curves all lie at one",
        subtype="DISTANCE",
        unit="LENGTH",
        default=0.2,
        soft_min=0.005,
        soft_max=2.0,
    )

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with curves selected."""
        if not _curves(context):
            cls.poll_message_set("Select one closed curve, or more for a loft")
            return False
        return super().poll(context)

    def act(self, context: Context) -> None:
        """Add it. Raises HeliformError where a curve is open, or crosses itself."""
        record = Wall(height=canonical(self.height * scale_of(context.scene)))
        chosen = _curves(context)
        obj = objects.add_wall(context, record, f"{chosen[0].name} wall", chosen)
        _dress(context, obj, record)


class HELIFORM_OT_reshape_wall(Reporting, Operator):
    """Give the active wall the values of a preset; its relief stays"""

    bl_idname = "heliform.reshape_wall"
    bl_label = "Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(name="Preset", items=_WALLS)

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only where the active object is a wall."""
        obj = context.object
        return obj is not None and obj.heliform.form == objects.WALL and in_object_mode(context)

    def act(self, context: Context) -> None:
        """Reshape it."""
        own = context.object.heliform.wall
        bead = read(own, Wall, scale_of(context.scene)).bead
        objects.set_wall(context.object, replace(PRESETS[self.preset], bead=bead), context.scene)


class HELIFORM_OT_rebuild_wall(Reporting, Operator):
    """Follow the curves again, after they were changed"""

    bl_idname = "heliform.rebuild_wall"
    bl_label = "Follow Curves"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only where the active object is a wall on curves."""
        obj = context.object
        return obj is not None and bool(obj.heliform.curves) and in_object_mode(context)

    def act(self, context: Context) -> None:
        """Rebuild it."""
        objects.rebuild(context.object, context.scene)


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


def _name(preset: str) -> str:
    return NAMES.get(preset) or preset.capitalize()


def _dress(context: Context, obj: Object, record: Wall) -> None:
    """Give a new wall the relief of its beads."""
    style = scalloped(record.bead.height, record.bead.sag)
    dress(context, [Dressing(obj, style, relief_of_wall(record))])


def _curves(context: Context) -> list[Object]:
    """The selected curves, and meshes that are lines alone, from the lowest to the highest."""
    found = [
        obj
        for obj in context.selected_objects
        if obj.type == "CURVE" or (obj.type == "MESH" and obj.data.edges and not obj.data.polygons)
    ]
    return sorted(found, key=lambda obj: (obj.matrix_world.translation.z, obj.name))


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
    HELIFORM_OT_add_wall,
    HELIFORM_OT_wall_from_curves,
    HELIFORM_OT_reshape_wall,
    HELIFORM_OT_rebuild_wall,
    HELIFORM_OT_reshape_glass,
    HELIFORM_OT_check_glass,
    HELIFORM_OT_repair_glass,
)
register, unregister = bpy.utils.register_classes_factory(_CLASSES)
