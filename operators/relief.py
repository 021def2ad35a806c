"""The relief of printed layers: put on walls and other meshes, from a style, a curve or a file."""

from dataclasses import replace
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy.types import Context, Event, Modifier, Object, Operator

from ..addon import objects
from ..addon.bridge import print_layers
from ..addon.properties import enum_items, read, scale_of
from ..engines.core.errors import SceneError
from ..engines.core.files import safe_name
from ..engines.glass.loft import Wall
from ..engines.glass.profile import STYLES, Style
from ..engines.glass.relief import Relief, check_relief
from . import ObjectMode, Reporting


def relief_of(obj: Object | None) -> Modifier | None:
    """The object's first “Print Layers” modifier, or None."""
    if obj is None or obj.type != "MESH":
        return None
    return next(filter(print_layers.is_print_layers, obj.modifiers), None)


def dress(context: Context, obj: Object, style: Style, relief: Relief) -> Modifier:
    """Put a relief on an object, in the place of the one that it has.

    Raises ParameterError where it does not fit the layer, or the wall that the object is.
    """
    scale = scale_of(context.scene)
    wall = read(obj.heliform.wall, Wall, scale) if obj.heliform.form == objects.WALL else None
    check_relief(relief, wall.thickness if wall else None)
    if wall and wall.bead.height != relief.height:
        objects.set_wall(
            obj, replace(wall, bead=replace(wall.bead, height=relief.height)), context.scene
        )
    modifier = relief_of(obj)
    if modifier is None:
        return print_layers.add_modifier(obj, relief, style, scale)
    print_layers.write_modifier(modifier, relief, style, scale)
    return modifier


def relief_from(style: Style, before: Relief) -> Relief:
    """The relief that shows a style as it was found, the rest as ``before``."""
    return replace(
        before,
        style="scan",
        height=style.height,
        amplitude=style.depth,
        roughness=style.roughness,
    )


class OnMeshes(ObjectMode):
    """An operator on the selected meshes that are no lamps."""

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a mesh selected, in Object Mode."""
        if not chosen(context):
            cls.poll_message_set("Select a wall, or any mesh that is no lamp")
            return False
        return super().poll(context)


class HELIFORM_OT_add_relief(OnMeshes, Operator):
    """Put the relief of printed layers on the selected meshes, as a live modifier"""

    bl_idname = "heliform.add_relief"
    bl_label = "Print Layers"
    bl_options = {"REGISTER", "UNDO"}

    style: EnumProperty(
        name="Style",
        items=enum_items(STYLES, "Cross-section of a layer"),
        default="scalloped",
    )

    def act(self, context: Context) -> None:
        """Put it on each, with the settings that it has, if any."""
        scale = scale_of(context.scene)
        for obj in chosen(context):
            modifier = relief_of(obj)
            if modifier:
                relief, _ = print_layers.read_modifier(modifier, scale)
            elif obj.heliform.form == objects.WALL:
                bead = read(obj.heliform.wall, Wall, scale).bead
                relief = Relief(height=bead.height, amplitude=bead.sag)
            else:
                relief = Relief()
            relief = replace(relief, style=self.style)
            dress(context, obj, STYLES[self.style](relief.height, relief.amplitude), relief)


class HELIFORM_OT_load_relief(OnMeshes, Operator):
    """Put a relief that was saved, or came of a scan, on the selected meshes"""

    bl_idname = "heliform.load_relief"
    bl_label = "Load Relief"
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN"})
    filter_glob: StringProperty(default="*.npz", options={"HIDDEN"})

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Ask which."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def act(self, context: Context) -> None:
        """Load it. Raises FileError for a file that is no style."""
        style = Style.load(Path(bpy.path.abspath(self.filepath)))
        for obj in chosen(context):
            dress(context, obj, style, relief_from(style, relief_on(context, obj)))


class HELIFORM_OT_save_relief(Reporting, Operator):
    """Save the style of the active object's relief, to be used in other files and in studies"""

    bl_idname = "heliform.save_relief"
    bl_label = "Save Relief"
    bl_options = set()

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN"})
    filter_glob: StringProperty(default="*.npz", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only where there is one."""
        return relief_of(context.object) is not None

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Ask where to."""
        style = self._style(context)
        self.filepath = bpy.path.abspath(f"//{safe_name(style.name)}.npz")
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def act(self, context: Context) -> str:
        """Save it. Raises FileError where that is not possible."""
        path = Path(bpy.path.abspath(self.filepath)).with_suffix(".npz")
        self._style(context).save(path)
        return f"The relief is “{path}”."

    def _style(self, context: Context) -> Style:
        modifier = relief_of(context.object)
        assert modifier
        return print_layers.read_modifier(modifier, scale_of(context.scene))[1]


class HELIFORM_OT_draw_relief(ObjectMode, Operator):
    """Make the selected open curve the cross-section of a layer, on the other selected meshes"""

    bl_idname = "heliform.draw_relief"
    bl_label = "Relief from Curve"
    bl_options = {"REGISTER", "UNDO"}

    keep_height: BoolProperty(
        name="Keep Layer Height",
        description="Stretch the curve to the layers that there are, rather than make them so high",
        default=False,
    )

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with one curve and meshes selected."""
        curves = [o for o in context.selected_objects if o.type == "CURVE"]
        if len(curves) != 1 or not chosen(context):
            cls.poll_message_set("Select one open curve and the meshes that are to have it")
            return False
        return super().poll(context)

    def act(self, context: Context) -> None:
        """Put it on them. Raises SceneError for a curve that is no line."""
        (curve,) = (o for o in context.selected_objects if o.type == "CURVE")
        style = print_layers.style_from_curve(curve, scale_of(context.scene))
        for obj in chosen(context):
            before = relief_on(context, obj)
            relief = relief_from(style, before)
            if self.keep_height:
                relief = replace(relief, height=before.height, amplitude=before.amplitude)
            dress(context, obj, style, relief)


class HELIFORM_OT_copy_relief(OnMeshes, Operator):
    """Give the other selected meshes the active object's relief"""

    bl_idname = "heliform.copy_relief"
    bl_label = "Copy to Selected"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only where the active object has one and others are selected."""
        if relief_of(context.object) is None:
            cls.poll_message_set("The active object has no Print Layers to copy")
            return False
        return super().poll(context)

    def act(self, context: Context) -> str:
        """Copy it. Raises SceneError where no other mesh is selected."""
        modifier = relief_of(context.object)
        assert modifier
        made = print_layers.copy_to(modifier, chosen(context))
        if not made:
            raise SceneError("No other mesh is selected; select some, the one to copy from last.")
        return f"Copied to {len(made)} mesh{'es' * (len(made) > 1)}."


def relief_on(context: Context, obj: Object) -> Relief:
    """The relief that an object has, or the default one."""
    modifier = relief_of(obj)
    if modifier is None:
        return Relief()
    return print_layers.read_modifier(modifier, scale_of(context.scene))[0]


def chosen(context: Context) -> list[Object]:
    """The selected meshes that can have a relief, the active one first."""
    found = [o for o in context.selected_objects if o.type == "MESH" and o.heliform.role != "LAMP"]
    return sorted(found, key=lambda o: (o != context.object, o.name))


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_OT_add_relief,
        HELIFORM_OT_load_relief,
        HELIFORM_OT_save_relief,
        HELIFORM_OT_draw_relief,
        HELIFORM_OT_copy_relief,
    )
)
