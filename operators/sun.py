"""Sun: studies of sun and sky, one sensor's hours, the sun as a lamp, tables and reports."""

import gzip
import shutil
from pathlib import Path

import bpy
from bpy.props import StringProperty
from bpy.types import Context, Event, Object, Operator
from bpy_extras import view3d_utils
from mathutils import Vector

from ..addon import sun_place
from ..addon.bridge import layers, sun, sun_sensor
from ..addon.bridge.read import objects_of
from ..engines.core.errors import FileError, SceneError
from ..engines.sun import SUN_DAYLIGHT, SUN_RADIATION
from . import FileWriting, ObjectMode, Reporting, in_object_mode
from .run import RunAnalysis, open_report
from .structure import view_under


class HELIFORM_OT_study_sun(RunAnalysis, Operator):
    """Sun hours and irradiation on the receivers over the period, from sun and sky"""

    bl_idname = "heliform.study_sun"
    bl_label = "Study Sun"
    analysis = SUN_RADIATION


class HELIFORM_OT_study_daylight(RunAnalysis, Operator):
    """Daylight on the receivers over the year, with what bodies reflect, and its metrics"""

    bl_idname = "heliform.study_daylight"
    bl_label = "Study Daylight"
    analysis = SUN_DAYLIGHT


class HELIFORM_OT_sun_sensor(RunAnalysis, Operator):
    """Click a place on a receiver to see its hours: of illuminance after Study Daylight"""

    bl_idname = "heliform.sun_sensor"
    bl_label = "Pick Sensor"
    analysis = SUN_RADIATION

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Wait for a click."""
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set("Click a receiver; Esc or right click to leave")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: Context, event: Event) -> set[str]:
        """Measure where it is clicked; what is beside the receivers is passed over."""
        if event.type in ("ESC", "RIGHTMOUSE"):
            self._leave(context)
            return {"CANCELLED"}
        under = view_under(context, event)
        if not under or event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"PASS_THROUGH"}
        found = _receiver_under(context, *under)
        if found is None:
            return {"RUNNING_MODAL"}
        self._leave(context)
        self._aim(context, *found)
        return self.begin(context)

    def execute(self, context: Context) -> set[str]:
        """Without a mouse: the middle of the active or the first receiver."""
        receivers = objects_of(context.view_layer, "RECEIVER")
        if not receivers:
            self.report({"ERROR"}, "There is no receiver to measure on; add one with Add Receiver.")
            return {"CANCELLED"}
        obj = context.object if context.object in receivers else receivers[0]
        self._aim(context, obj, *_middle(obj))
        return self.run(context)

    def _aim(self, context: Context, obj: Object, place: Vector, normal: Vector) -> None:
        self.analysis = sun_sensor.analysis_for(context.scene)
        self.staging = sun_sensor.staging_at(obj, place, normal)

    def _leave(self, context: Context) -> None:
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)


class HELIFORM_OT_show_sun_sensor(Reporting, Operator):
    """Show the hours of the picked sensor in a window of their own"""

    bl_idname = "heliform.show_sun_sensor"
    bl_label = "Show Hours"
    bl_options = set()

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only once a sensor was picked."""
        return sun_sensor.picture_of(context.scene) is not None

    def act(self, context: Context) -> None:
        """Open an image editor on the picture."""
        bpy.ops.wm.window_new()
        area = context.window_manager.windows[-1].screen.areas[0]
        area.ui_type = "IMAGE_EDITOR"
        area.spaces.active.image = sun_sensor.picture_of(context.scene)


class HELIFORM_OT_add_sun_lamp(ObjectMode, Operator):
    """Add a Blender sun that shines as the sun does at the date and hour"""

    bl_idname = "heliform.add_sun_lamp"
    bl_label = "Add Sun Lamp"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> str | None:
        """Add it, or move it where it is there. Raises ParameterError for no such day."""
        now = sun_place.sun_now(context.scene)
        sun_place.add_lamp(context)
        return None if now.direct else "The sun is below the horizon then; the lamp gives no light."


class _OnStudy(Reporting):
    """An operator on the scene's sun study."""

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a study."""
        return sun.facts_of(context.scene) is not None

    def folder(self, context: Context) -> Path:
        """Where its files are. Raises FileError where it has none."""
        facts = sun.facts_of(context.scene)
        if not facts or not facts["folder"]:
            raise FileError("Live Sun writes no files; press Study Sun.")
        return Path(facts["folder"])


class HELIFORM_OT_open_sun_report(_OnStudy, Operator):
    """Open the report of the study in the browser"""

    bl_idname = "heliform.open_sun_report"
    bl_label = "Open Report"
    bl_options = set()

    def act(self, context: Context) -> None:
        """Open it. Raises FileError where it is gone."""
        open_report(str(self.folder(context)), "do the study again")


class HELIFORM_OT_export_sun_hours(_OnStudy, FileWriting, Operator):
    """Write the hourly means over the sensors as a table"""

    bl_idname = "heliform.export_sun_hours"
    bl_label = "Export Hours"
    bl_options = set()
    ending = ".csv"

    filter_glob: StringProperty(default="*.csv", options={"HIDDEN"})

    def proposed(self, context: Context) -> str:
        """The receiver's name."""
        return f"{sun.staged_on(context.scene)[0].name} hours"

    def act(self, context: Context) -> str:
        """Write it. Raises FileError where that is not possible."""
        folder, path = self.folder(context), self.chosen()
        plain, packed = folder / "hourly.csv", folder / "hourly.csv.gz"
        if not plain.is_file() and not packed.is_file():
            raise FileError(f"There is no table in “{folder}” any more; do the study again.")
        try:
            if plain.is_file():
                shutil.copyfile(plain, path)
            else:
                path.write_bytes(gzip.decompress(packed.read_bytes()))
        except OSError as failed:
            raise FileError(
                f"“{path}” cannot be written: {failed.strerror}; choose another place."
            ) from None
        return f"The hours are in “{path}”."


class HELIFORM_OT_sun_to_vertices(_OnStudy, Operator):
    """Write the shown map as an attribute of the vertices of receivers that are meshes"""

    bl_idname = "heliform.sun_to_vertices"
    bl_label = "Values to Vertices"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a study, in Object Mode."""
        return super().poll(context) and in_object_mode(context)

    def act(self, context: Context) -> str:
        """Write it. Raises SceneError where a mesh is not what was measured on."""
        names = ", ".join(f"“{name}”" for name in sun.values_to_vertices(context))
        return f"The vertices of {names} have the attribute “{context.scene.heliform.sun_map}”."


class HELIFORM_OT_clear_sun(_OnStudy, Operator):
    """Take the study off the receivers; the views show again what they did before"""

    bl_idname = "heliform.clear_sun"
    bl_label = "Clear Study"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Clear it, and switch Live Sun off."""
        context.scene.heliform.live_sun = False
        sun.clear(context.scene)
        layers.restore_views(context)


def _middle(obj: Object) -> tuple[Vector, Vector]:
    """Where a receiver's largest face is, and its normal, in the world."""
    if not obj.data.polygons:
        raise SceneError(f"“{obj.name}” has no face to measure on.")
    face = max(obj.data.polygons, key=lambda polygon: polygon.area)
    turned = obj.matrix_world.to_3x3().inverted_safe().transposed() @ face.normal
    return obj.matrix_world @ face.center, turned.normalized()


def _receiver_under(
    context: Context, area: bpy.types.Area, place: tuple[int, int]
) -> tuple[Object, Vector, Vector] | None:
    """The receiver at a place of a view where it is foremost, where on it, and its normal there."""
    region = next(r for r in area.regions if r.type == "WINDOW")
    view = area.spaces.active.region_3d
    origin = view3d_utils.region_2d_to_origin_3d(region, view, place)
    along = view3d_utils.region_2d_to_vector_3d(region, view, place)
    hit, where, normal, _, found, _ = context.scene.ray_cast(
        context.evaluated_depsgraph_get(), origin, along
    )
    if not hit or found.original.heliform.role != "RECEIVER":
        return None
    if found.original.heliform.plane.sides == "both" and normal.dot(along) > 0:
        normal = -normal
    return found.original, where, normal


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_OT_study_sun,
        HELIFORM_OT_study_daylight,
        HELIFORM_OT_sun_sensor,
        HELIFORM_OT_show_sun_sensor,
        HELIFORM_OT_add_sun_lamp,
        HELIFORM_OT_open_sun_report,
        HELIFORM_OT_export_sun_hours,
        HELIFORM_OT_sun_to_vertices,
        HELIFORM_OT_clear_sun,
    )
)
