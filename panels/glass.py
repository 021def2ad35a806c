"""The Glass room: the shape of the active printed object, its check and repair."""

import bpy
from bpy.types import Context, Object, Panel, UILayout

from ..addon.objects import GLASS
from ..addon.properties import draw
from ..engines.glass import GlassObject
from . import Room
from .scene import draw_problem


class HELIFORM_PT_glass(Room, Panel):
    """Printed glass: its shape, and whether it is a solid"""

    bl_label = "Glass"

    def draw(self, context: Context) -> None:
        """The active glass object, or how to get one."""
        layout, obj = self.layout, context.object
        layout.use_property_split = True
        layout.use_property_decorate = False
        if obj is None or obj.heliform.role != "BODY":
            layout.label(text="Select a glass object, or add one.", icon="INFO")
            return
        if obj.heliform.form == GLASS:
            layout.operator_menu_enum("heliform.reshape_glass", "preset", icon="PRESET")
            draw_problem(layout, obj)
            draw(layout, obj.heliform.glass_object, GlassObject)
        _facts(layout, obj)
        row = layout.row(align=True)
        row.operator("heliform.check_glass", icon="CHECKMARK")
        row.operator("heliform.repair_glass", icon="MODIFIER")


def _facts(layout: UILayout, obj: Object) -> None:
    """What the mesh is now."""
    system = bpy.context.scene.unit_settings
    column = layout.column(align=True)
    size = " × ".join(
        bpy.utils.units.to_string(
            system.system, "LENGTH", value * system.scale_length, precision=4
        )
        for value in obj.dimensions
    )
    _fact(column, "Size", size)
    _fact(column, "Faces", f"{len(obj.data.polygons):,}")
    if obj.heliform.form == GLASS and not obj.modifiers:
        _fact(column, "Watertight", "By construction")


def _fact(column: UILayout, name: str, value: str) -> None:
    split = column.split(factor=0.4)
    left = split.row()
    left.alignment = "RIGHT"
    left.label(text=name)
    split.label(text=value)


register, unregister = bpy.utils.register_classes_factory((HELIFORM_PT_glass,))
