"""Printing: the gate, the path, and the files that a printer and others take."""

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy.types import Context, Event, Operator

from ..addon import objects, printing
from ..addon.bridge import layers
from ..addon.bridge.read import read_mesh
from ..addon.properties import read, scale_of, with_properties, write_unset
from ..engines.core.errors import FileError, SceneError
from ..engines.core.files import written
from ..engines.glass.coupon import Coupon, coupon
from ..engines.glass.export import export_solid
from ..engines.glass.gcode import write_gcode, write_path
from ..engines.glass.machine import DATA, FILE, PROFILES
from ..engines.glass.printing import gcode_notes
from . import FileWriting, Reporting, named_folder


class _OnWall(Reporting):
    """An operator on the active wall."""

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a wall that Heliform made."""
        obj = context.object
        if obj is None or obj.heliform.form != objects.WALL:
            cls.poll_message_set("Select a wall; Add Wall makes one")  # type: ignore[attr-defined]
            return False
        return True


class HELIFORM_OT_check_print(_OnWall, Operator):
    """Say whether the machine can print the active wall, and colour the wall by it"""

    bl_idname = "heliform.check_print"
    bl_label = "Check Print"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> str:
        """Check it; warns of the first limit that it fails. Raises HeliformError as `print_of`."""
        obj = context.object
        shown = printing.print_of(obj, context)  # before anything changes
        obj.heliform.gate = True
        failed = shown.verdict.failed
        if failed:
            self.report({"WARNING"}, failed[0].sentence)
            return ""
        return f"“{obj.name}” can be printed by {shown.machine.name}."


class HELIFORM_OT_preview_path(_OnWall, Operator):
    """Show the way of the nozzle on the active wall, with speed and flow at every point"""

    bl_idname = "heliform.preview_path"
    bl_label = "Preview Path"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> str:
        """Show it. Raises HeliformError where there can be none."""
        obj = context.object
        given = printing.print_of(obj, context)  # before anything changes
        obj.heliform.path = True
        return f"{given.path.turns:.0f} turns, {given.path.seconds / 60:.0f} minutes."


class HELIFORM_OT_show_check(_OnWall, Operator):
    """Colour the wall by this check alone, its worst place marked; again for all"""

    bl_idname = "heliform.show_check"
    bl_label = "Show Check"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(options={"HIDDEN"})

    def act(self, context: Context) -> None:
        """Show it, or all where it is shown already."""
        own = context.object.heliform
        own.gate_check = "" if own.gate_check == self.name else self.name


class HELIFORM_OT_export_gcode(_OnWall, FileWriting, Operator):
    """Write the wall's path as G-code for the machine, the verdict of the gate beside it"""

    bl_idname = "heliform.export_gcode"
    bl_label = "Export G-code"
    bl_options = set()
    ending = ".gcode"
    others = (".nc", ".csv")

    filter_glob: StringProperty(default="*.gcode;*.nc;*.csv", options={"HIDDEN"})

    def act(self, context: Context) -> str:
        """Write it; a .csv becomes the table of the path. Raises HeliformError."""
        path = self.chosen()
        given = printing.print_of(context.object, context)
        if path.suffix.lower() == ".csv":
            write_path(path, given.path)
            return f"The path is “{path}”."
        name, notes = context.object.name, gcode_notes(given.loft.notes, given.verdict)
        write_gcode(path, given.path, given.machine, given.spiral.purge, name, notes)
        verdict = path.with_name(f"{path.stem}.gate.json")
        with written(verdict) as draft:
            draft.write_text(given.verdict.as_json(), encoding="utf-8")
        if not given.verdict.passed:
            self.report({"WARNING"}, f"Written, but: {given.verdict.failed[0].sentence}")
            return ""
        return f"The G-code is “{path}”."


class HELIFORM_OT_export_solid(FileWriting, Operator):
    """Write the active glass, as it is with its modifiers, as STL, 3MF or OBJ"""

    bl_idname = "heliform.export_solid"
    bl_label = "Export Solid"
    bl_options = set()
    ending = ".3mf"
    others = (".stl", ".obj")

    filter_glob: StringProperty(default="*.3mf;*.stl;*.obj", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a mesh."""
        return context.object is not None and context.object.type == "MESH"

    def act(self, context: Context) -> str:
        """Write it. Raises SceneError for what is no solid, FileError where it cannot be."""
        path = self.chosen()
        depsgraph = context.evaluated_depsgraph_get()
        mesh = read_mesh(context.object, depsgraph, scale_of(context.scene))
        export_solid(path, mesh, context.object.name)
        return f"The solid is “{path}”."


@with_properties(Coupon)
class HELIFORM_OT_export_coupon(Reporting, Operator):
    """Write a test piece for the machine's flow: its G-code, and a table of its bands"""

    bl_idname = "heliform.export_coupon"
    bl_label = "Export Flow Coupon"
    bl_options = set()

    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN"})
    filter_folder: BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Ask where to; its sizes are beside the files."""
        write_unset(self, Coupon(), scale_of(context.scene))
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def act(self, context: Context) -> str:
        """Write it. Raises HeliformError where the machine cannot print it."""
        machine = printing.machine_of(context.scene)
        write_unset(self, Coupon(), scale_of(context.scene))
        record = read(self, Coupon, scale_of(context.scene))
        folder = named_folder(self.directory)
        files = coupon(record, machine).save(folder, machine)
        return f"“{folder}” has {' and '.join(files)}."


class HELIFORM_OT_edit_machine(FileWriting, Operator):
    """Copy a shipped machine profile to a file of your own, and print with that"""

    bl_idname = "heliform.edit_machine"
    bl_label = "Own Machine Profile"
    bl_options = {"REGISTER", "UNDO"}
    ending = ".toml"

    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    def proposed(self, context: Context) -> str:
        """Some name."""
        return "my printer"

    def act(self, context: Context) -> str:
        """Copy it. Raises FileError where that is not possible, or would replace a file."""
        settings = context.scene.heliform
        shipped = settings.machine if settings.machine in PROFILES else PROFILES[0]
        path = self.chosen()
        if path.exists():
            raise FileError(f"“{path}” is there already; choose another name.")
        with written(path) as draft:
            draft.write_bytes((DATA / f"{shipped}.toml").read_bytes())
        settings.machine_file, settings.machine = str(path), FILE
        return f"The profile is “{path}”; edit it with any text editor."


class HELIFORM_OT_clear_layer(Reporting, Operator):
    """Take the colours off the selected objects; the views show again what they did before"""

    bl_idname = "heliform.clear_layer"
    bl_label = "Clear Colours"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Clear them. Raises SceneError where there are none."""
        found = [o for o in context.selected_objects if layers.layer_of(o)]
        if not found:
            raise SceneError("None of the selected objects has a layer; select one that has.")
        for obj in found:
            obj.heliform.gate = False
        layers.clear(found)
        layers.restore_views(context)


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_OT_check_print,
        HELIFORM_OT_preview_path,
        HELIFORM_OT_show_check,
        HELIFORM_OT_export_gcode,
        HELIFORM_OT_export_solid,
        HELIFORM_OT_export_coupon,
        HELIFORM_OT_edit_machine,
        HELIFORM_OT_clear_layer,
    )
)
