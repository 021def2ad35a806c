"""The relief of printed layers: put on walls and other meshes, from a style, a curve or a file."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy.types import Context, Event, Modifier, Object, Operator

from ..addon import objects
from ..addon.bridge import print_layers
from ..addon.properties import enum_items, read, scale_of
from ..engines.core.errors import HeliformError, ParameterError, SceneError
from ..engines.core.parameters import canonical
from ..engines.glass.loft import Wall
from ..engines.glass.profile import STYLES, Style
from ..engines.glass.relief import Relief, check_relief
from . import FileWriting, ObjectMode


def relief_of(obj: Object | None) -> Modifier | None:
    """The object's first “Print Layers” modifier, or None."""
    if obj is None or obj.type != "MESH":
        return None
    return next(filter(print_layers.is_print_layers, obj.modifiers), None)


class Dressing(NamedTuple):
    """An object, and the relief that it is to have."""

    obj: Object
    style: Style
    relief: Relief


def dress(context: Context, dressings: Sequence[Dressing]) -> None:
    """Put reliefs on objects, in the place of those that they have: on all of them or on none.

    Raises HeliformError where one does not fit its layer, or the wall that the object is.
    """
    for obj, _, relief in dressings:
        wall = _wall(context, obj)
        check_relief(relief, wall.thickness if wall else None)
    undo: list[Callable[[], None]] = []
    try:
        for dressing in dressings:
            undo.append(_as_it_is(context, dressing.obj))
            _put(context, *dressing)
    except HeliformError:
        for back in reversed(undo):
            back()
        raise


def _put(context: Context, obj: Object, style: Style, relief: Relief) -> None:
    scale, modifier = scale_of(context.scene), relief_of(obj)
    if modifier is None:
        print_layers.add_modifier(obj, relief, style, scale)
    else:
        print_layers.write_modifier(modifier, relief, style, scale)
    wall, height = _wall(context, obj), canonical(relief.height)
    if wall and wall.bead.height != height:
        bead = replace(wall.bead, height=height)
        objects.set_wall(obj, replace(wall, bead=bead), context.scene)
        if obj.heliform.problem:
            raise ParameterError(obj.heliform.problem)


def _as_it_is(context: Context, obj: Object) -> Callable[[], None]:
    """What makes an object again what it is now: its relief and, if it is one, its wall."""
    modifier, wall, problem = relief_of(obj), _wall(context, obj), obj.heliform.problem
    settings = print_layers.settings_of(modifier) if modifier else {}

    def back() -> None:
        there = relief_of(obj)
        if modifier:
            print_layers.set_settings(modifier, settings)
        elif there:
            obj.modifiers.remove(there)
        if wall and wall != _wall(context, obj):
            objects.set_wall(obj, wall, context.scene)
            obj.heliform.problem = problem

    return back


def _wall(context: Context, obj: Object) -> Wall | None:
    """What a wall's settings are; None where the object is no wall."""
    if obj.heliform.form != objects.WALL:
        return None
    return read(obj.heliform.wall, Wall, scale_of(context.scene))


def put_on(context: Context, found: Sequence[Object], style: Style) -> None:
    """Put a style on objects as it was found, on all or none. Raises HeliformError as `dress`."""
    dress(
        context,
        [Dressing(obj, style, relief_from(style, relief_on(context, obj))) for obj in found],
    )


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
        """Put it on all, with the settings that they have, if any. Raises HeliformError."""
        dressings = []
        for obj in chosen(context):
            relief = replace(relief_on(context, obj), style=self.style)
            style = STYLES[self.style](relief.height, relief.amplitude)
            dressings.append(Dressing(obj, style, relief))
        dress(context, dressings)


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
        """Put it on all. Raises FileError for a file that is no style, HeliformError as `dress`."""
        put_on(context, chosen(context), Style.load(Path(bpy.path.abspath(self.filepath))))


class HELIFORM_OT_save_relief(FileWriting, Operator):
    """Save the style of the active object's relief, to be used in other files and in studies"""

    bl_idname = "heliform.save_relief"
    bl_label = "Save Relief"
    bl_options = set()
    ending = ".npz"

    filter_glob: StringProperty(default="*.npz", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only where there is one."""
        return relief_of(context.object) is not None

    def proposed(self, context: Context) -> str:
        """The style's name."""
        return self._style(context).name

    def act(self, context: Context) -> str:
        """Save it. Raises FileError where that is not possible."""
        path = self.chosen()
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
        """Put it on all. Raises SceneError for what is no line, HeliformError as `dress`."""
        (curve,) = (o for o in context.selected_objects if o.type == "CURVE")
        style = print_layers.style_from_curve(curve, scale_of(context.scene))
        dressings = []
        for obj in chosen(context):
            before = relief_on(context, obj)
            relief = relief_from(style, before)
            if self.keep_height:
                relief = replace(relief, height=before.height, amplitude=before.amplitude)
            dressings.append(Dressing(obj, style, relief))
        dress(context, dressings)


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
        """Copy it to all. Raises SceneError where there is no other, HeliformError as `dress`."""
        modifier = relief_of(context.object)
        assert modifier
        others = [obj for obj in chosen(context) if obj != context.object]
        if not others:
            raise SceneError("No other mesh is selected; select some, the one to copy from last.")
        relief, style = print_layers.read_modifier(modifier, scale_of(context.scene))
        dress(context, [Dressing(obj, style, relief) for obj in others])
        print_layers.copy_to(modifier, others)  # its mask, too
        return f"Copied to {len(others)} mesh{'es' * (len(others) > 1)}."


def relief_on(context: Context, obj: Object) -> Relief:
    """The relief that an object has, or the one of its beads where it is a wall, or the default."""
    modifier = relief_of(obj)
    if modifier is None:
        wall = _wall(context, obj)
        return print_layers.relief_of_wall(wall) if wall else Relief()
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
