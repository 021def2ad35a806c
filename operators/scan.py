"""Scans: reading a sample, and putting its relief on walls."""

import bpy
from bpy.props import StringProperty
from bpy.types import Context, Event, Operator

from ..addon.bridge import as_printed, scan
from ..addon.bridge.print_layers import style_of
from ..engines.scan import COMPARE_PRINT, READ_SCAN
from . import Reporting
from .relief import OnMeshes, chosen, put_on
from .run import RunAnalysis, open_report


class HELIFORM_OT_read_scan(RunAnalysis, Operator):
    """Read the layers of a scanned sample: their profile, height, tilt and roughness"""

    bl_idname = "heliform.read_scan"
    bl_label = "Read Scan"
    analysis = READ_SCAN
    traces = False


class HELIFORM_OT_choose_scan(RunAnalysis, Operator):
    """Choose the scan of a sample, PLY, OBJ or STL, and read it"""

    bl_idname = "heliform.choose_scan"
    bl_label = "Choose Scan"
    label = HELIFORM_OT_read_scan.bl_label
    analysis = READ_SCAN
    traces = False

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN"})
    filter_glob: StringProperty(default="*.ply;*.obj;*.stl", options={"HIDDEN"})

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Ask which."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: Context) -> set[str]:
        """Keep its name, and read it: in the window as a job, else to the end."""
        context.scene.heliform.scan_reading.file = self.filepath
        return self.run(context) if bpy.app.background else self.begin(context)


class HELIFORM_OT_use_scan(OnMeshes, Operator):
    """Put the relief of the scan that was read on the selected meshes"""

    bl_idname = "heliform.use_scan"
    bl_label = "Put on Selected"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a relief that was read, and meshes to put it on."""
        if context.scene.heliform.relief is None:
            cls.poll_message_set("Read a scan first")
            return False
        return super().poll(context)

    def act(self, context: Context) -> None:
        """Put it on all, layer height and depth as they were found. Raises HeliformError."""
        put_on(context, chosen(context), style_of(context.scene.heliform.relief))


class HELIFORM_OT_open_scan_report(Reporting, Operator):
    """Open the quality report of the scan in the browser"""

    bl_idname = "heliform.open_scan_report"
    bl_label = "Open Report"
    bl_options = set()

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a scan that was read."""
        return scan.facts_of(context.scene.heliform.relief) is not None

    def act(self, context: Context) -> None:
        """Open it. Raises FileError where the folder is gone."""
        facts = scan.facts_of(context.scene.heliform.relief)
        assert facts
        open_report(facts["folder"], "read the scan again")


class HELIFORM_OT_compare_print(RunAnalysis, Operator):
    """Compare the scan of a finished piece with its design, the active object"""

    bl_idname = "heliform.compare_print"
    bl_label = "Compare Print"
    analysis = COMPARE_PRINT
    traces = False

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a body that can be the design, and a scan."""
        obj = context.object
        if obj is None or obj.heliform.role != "BODY":
            cls.poll_message_set("Select the wall or body that was printed")
            return False
        if not context.scene.heliform.comparison.file:
            cls.poll_message_set("Choose the scan of the finished piece first")
            return False
        return super().poll(context)


class HELIFORM_OT_open_comparison(Reporting, Operator):
    """Open the report of the comparison in the browser"""

    bl_idname = "heliform.open_comparison"
    bl_label = "Open Report"
    bl_options = set()

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with an object that was compared."""
        return as_printed.facts_of(context.object) is not None

    def act(self, context: Context) -> None:
        """Open it. Raises FileError where the folder is gone."""
        facts = as_printed.facts_of(context.object)
        assert facts
        open_report(facts["folder"], "compare the print again")


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_OT_read_scan,
        HELIFORM_OT_choose_scan,
        HELIFORM_OT_use_scan,
        HELIFORM_OT_open_scan_report,
        HELIFORM_OT_compare_print,
        HELIFORM_OT_open_comparison,
    )
)
