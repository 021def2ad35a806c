"""Structure: adding roofs, shells and façades, sizing them, and looking at their members."""

import math
import shutil
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy.types import Area, Context, Event, Object, Operator, Region
from bpy_extras import view3d_utils

from ..addon import structures
from ..addon.bridge import members
from ..addon.properties import enum_items
from ..addon.structures import active_structure
from ..engines.core.errors import FileError, SceneError
from ..engines.core.files import safe_name
from ..engines.structure import SIZE_STRUCTURE
from ..engines.structure.presets import OF_MESH, PRESETS
from . import ObjectMode, Reporting, named_folder
from .run import RunAnalysis, open_report

_PRESETS = [(key, structures.NAMES[key], *rest) for key, _, *rest in enum_items(PRESETS)]
_CYCLE = 48
"""Frames of a swing of the displaced structure."""


class _OnStructure(Reporting):
    """An operator on the active structure."""

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a structure."""
        if active_structure(context) is None:
            cls.poll_message_set("Select a structure; Add Structure makes one")  # type: ignore[attr-defined]
            return False
        return True


class HELIFORM_OT_add_structure(ObjectMode, Operator):
    """Add a roof, a grid shell or a façade at the 3D cursor, analysed and sized"""

    bl_idname = "heliform.add_structure"
    bl_label = "Add Structure"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(name="Preset", description="A structure to start from", items=_PRESETS)

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Add it, and bring it into view where it is the first thing of Heliform's."""
        first = all(obj.heliform.role == "NONE" for obj in context.scene.objects)
        ended = self.execute(context)
        if first and "FINISHED" in ended:
            _look_at_selected(context)
        return ended

    def act(self, context: Context) -> None:
        """Add it; its shape is in the sidebar from then on. Raises HeliformError."""
        record = PRESETS[self.preset]
        structures.add_structure(context, record, structures.NAMES[record.form])


class HELIFORM_OT_structure_from_mesh(ObjectMode, Operator):
    """Make the edges of the active mesh members of a structure, held at its lowest vertices"""

    bl_idname = "heliform.structure_from_mesh"
    bl_label = "Structure from Mesh"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a mesh that is no structure itself."""
        obj = context.object
        return (
            super().poll(context)
            and obj is not None
            and obj.type == "MESH"
            and obj.heliform.form != structures.STRUCTURE
        )

    def act(self, context: Context) -> None:
        """Add it. Raises HeliformError where it cannot stand."""
        source = context.object
        structures.add_structure(context, OF_MESH, f"{source.name} structure", source)
        source.hide_set(True)


class HELIFORM_OT_size_structure(RunAnalysis, Operator):
    """Analyse the active structure and size its members in the background, with files and report"""

    bl_idname = "heliform.size_structure"
    bl_label = "Size Members"
    analysis = SIZE_STRUCTURE
    traces = False


class HELIFORM_OT_rebuild_structure(_OnStructure, Operator):
    """Analyse and size the active structure here and now"""

    bl_idname = "heliform.rebuild_structure"
    bl_label = "Update Structure"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Update it. Raises SceneError where that is not possible."""
        obj = _target(context)
        structures.rebuild(obj, context.scene, anew=True)
        if obj.heliform.problem:
            raise SceneError(obj.heliform.problem)


class HELIFORM_OT_pick_member(_OnStructure, Operator):
    """Click a member to see its checks, line by line"""

    bl_idname = "heliform.pick_member"
    bl_label = "Pick Member"
    bl_options = {"UNDO"}

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Wait for a click."""
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set("Click a member; Esc or right click to leave")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Context, event: Event) -> set[str]:
        """Pick what is clicked; what is beside the structure is passed over."""
        if event.type in ("ESC", "RIGHTMOUSE"):
            return self._left(context, "CANCELLED")
        under = view_under(context, event)
        if under and event.type == "LEFTMOUSE" and event.value == "PRESS":
            picked = _member_under(context, *under)
            if picked is not None:
                _target(context).heliform.member = picked
                return self._left(context, "FINISHED")
            return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"}

    def act(self, context: Context) -> None:
        """Without a mouse: the member that uses most of its resistance."""
        _pick_worst(_target(context))

    def _left(self, context: Context, how: str) -> set[str]:
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        return {how}


class HELIFORM_OT_worst_member(_OnStructure, Operator):
    """Show the checks of the member that uses most of its resistance"""

    bl_idname = "heliform.worst_member"
    bl_label = "Worst Member"
    bl_options = {"UNDO"}

    def act(self, context: Context) -> None:
        """Pick it."""
        _pick_worst(_target(context))


class HELIFORM_OT_animate_displacement(_OnStructure, Operator):
    """Let the structure swing to its displaced shape and back; again to stop"""

    bl_idname = "heliform.animate_displacement"
    bl_label = "Animate"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Give the displaced shape keyframes over two seconds that repeat, or take them away."""
        obj = _target(context)
        key = members.displaced_key(obj)
        if key is None:
            raise SceneError(f"“{obj.name}” has not been analysed; press Size Members.")
        keys = obj.data.shape_keys
        if keys.animation_data:
            keys.animation_data_clear()
            key.value = 0.0
            return
        start = context.scene.frame_current
        for frame in range(0, _CYCLE + 1, _CYCLE // 8):
            key.value = 0.5 - 0.5 * math.cos(2 * math.pi * frame / _CYCLE)
            key.keyframe_insert("value", frame=start + frame)
        for curve in _curves(keys):
            curve.modifiers.new("CYCLES")


class HELIFORM_OT_export_members(_OnStructure, Operator):
    """Write member list, cutting list, reactions, combinations and lines in DXF into a folder"""

    bl_idname = "heliform.export_members"
    bl_label = "Export Members"
    bl_options = set()

    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN"})
    filter_folder: BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Ask where to."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def act(self, context: Context) -> str:
        """Write a new folder. Raises FileError where that is not possible."""
        obj = _target(context)
        folder = named_folder(self.directory) / f"{safe_name(obj.name)} members"
        if folder.exists():
            raise FileError(f"“{folder}” is there already; choose another place, or delete it.")
        sized = structures.sized_of(obj, context.scene)
        draft = Path(f"{folder}.part")
        try:
            draft.mkdir(parents=True)
            sized.save(draft)
            draft.rename(folder)
        except OSError as failed:
            raise FileError(
                f"The folder “{folder}” cannot be written: {failed.strerror}; choose another."
            ) from None
        finally:
            shutil.rmtree(draft, ignore_errors=True)
        return f"“{folder}” has the members."


class HELIFORM_OT_open_structure_report(_OnStructure, Operator):
    """Open the report of the last sizing in the browser"""

    bl_idname = "heliform.open_structure_report"
    bl_label = "Open Report"
    bl_options = set()

    def act(self, context: Context) -> None:
        """Open it. Raises FileError where there is none."""
        facts = members.facts_of(_target(context))
        if not facts or not facts["folder"]:
            raise FileError("There is no report of what was sized live; press Size Members.")
        open_report(facts["folder"], "size the members again")


def _pick_worst(obj: Object) -> None:
    worst = members.worst_member(obj)
    if worst is None:
        raise SceneError(f"“{obj.name}” has not been analysed; press Size Members.")
    obj.heliform.member = worst


def _target(context: Context) -> Object:
    """The structure that `_OnStructure.poll` has found."""
    found = active_structure(context)
    assert found is not None
    return found


def view_under(context: Context, event: Event) -> tuple[Area, tuple[int, int]] | None:
    """The 3D view under the mouse and where in it; None over its sidebar, header or tools too."""
    for area in context.screen.areas:
        over = [region for region in area.regions if _is_over(region, event)]
        if area.type == "VIEW_3D" and [region.type for region in over] == ["WINDOW"]:
            return area, (event.mouse_x - over[0].x, event.mouse_y - over[0].y)
    return None


def _is_over(region: Region, event: Event) -> bool:
    across, up = event.mouse_x - region.x, event.mouse_y - region.y
    return 0 <= across < region.width and 0 <= up < region.height


def _member_under(context: Context, area: Area, place: tuple[int, int]) -> int | None:
    """The active structure's member at a place of a view, where it is the foremost thing."""
    region = next(r for r in area.regions if r.type == "WINDOW")
    view, obj = area.spaces.active.region_3d, _target(context)
    origin = view3d_utils.region_2d_to_origin_3d(region, view, place)
    along = view3d_utils.region_2d_to_vector_3d(region, view, place)
    hit, _, _, face, found, _ = context.scene.ray_cast(
        context.evaluated_depsgraph_get(), origin, along
    )
    if not hit or found.original != obj:
        return None
    return members.member_of_face(obj, face)


def _look_at_selected(context: Context) -> None:
    area = context.area
    if area and area.type == "VIEW_3D":
        region = next(r for r in area.regions if r.type == "WINDOW")
        with context.temp_override(area=area, region=region):
            bpy.ops.view3d.view_selected()


def _curves(keys: bpy.types.Key) -> list[bpy.types.FCurve]:
    """The animation curves of shape keys."""
    animation = keys.animation_data
    bag = animation.action.layers[0].strips[0].channelbag(animation.action_slot)
    return list(bag.fcurves)


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_OT_add_structure,
        HELIFORM_OT_structure_from_mesh,
        HELIFORM_OT_size_structure,
        HELIFORM_OT_rebuild_structure,
        HELIFORM_OT_pick_member,
        HELIFORM_OT_worst_member,
        HELIFORM_OT_animate_displacement,
        HELIFORM_OT_export_members,
        HELIFORM_OT_open_structure_report,
    )
)
