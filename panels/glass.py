"""The Glass room: the shape of the active printed object, its check and repair."""

import bpy
from bpy.types import Context, Object, Panel, Scene, UILayout

from ..addon.objects import GLASS
from ..addon.properties import draw, scale_of
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
            shape = obj.heliform.glass_object
            draw(layout, shape, GlassObject, () if shape.lobes else {"lobe"})
        _facts(layout, obj, context.scene)
        row = layout.row(align=True)
        row.operator("heliform.check_glass", icon="CHECKMARK")
        row.operator("heliform.repair_glass", icon="MODIFIER")


def _facts(layout: UILayout, obj: Object, scene: Scene) -> None:
    """What the mesh is now."""
    column = layout.column(align=True)
    _fact(column, "Size", size_text(tuple(d * scale_of(scene) for d in obj.dimensions)))
    _fact(column, "Faces", f"{len(obj.data.polygons):,}".replace(",", "\u2009"))
    if obj.heliform.form == GLASS and not obj.modifiers:
        _fact(column, "Watertight", "By construction")


def size_text(metres: tuple[float, ...]) -> str:
    """217 × 217 × 209 mm; in metres from 10 m on."""
    factor, unit = (1, "m") if max(metres) >= 10 else (1e3, "mm")
    return " × ".join(f"{size * factor:.4g}" for size in metres) + f" {unit}"


def _fact(column: UILayout, name: str, value: str) -> None:
    split = column.split(factor=0.4)
    left = split.row()
    left.alignment = "RIGHT"
    left.label(text=name)
    split.label(text=value)


register, unregister = bpy.utils.register_classes_factory((HELIFORM_PT_glass,))
