"""Running analyses, and their studies and reports: what is the same for every room."""

from pathlib import Path
from typing import Any

import bpy
from bpy.props import StringProperty
from bpy.types import Context, Event, Operator

from ..addon import jobs
from ..addon.bridge import results, studies
from ..addon.rooms import staging_of
from ..addon.staging import Staging
from ..engines.core import runtime
from ..engines.core.analysis import Analysis, find_analysis
from ..engines.core.errors import Cancelled, FileError, HeliformError
from ..engines.core.files import safe_name
from ..engines.core.study import load_study
from ..engines.light import TRACE_PHOTONS
from . import Reporting, in_object_mode, named_folder


class RunAnalysis:
    """An operator that runs ``analysis`` on the scene: in the window as a job, else to the end."""

    analysis: Analysis
    traces = True
    label = ""
    """What the job is called, if not like the operator."""
    staging: Staging | None = None
    """How it meets the scene, if not as the analysis does."""
    bl_label: str
    bl_options = set()
    report: Any

    @classmethod
    def poll(cls, context: Context) -> bool:
        """One job at a time, and only where Mitsuba runs if it ``traces`` light."""
        why = reason_against(cls.traces)
        if why:
            cls.poll_message_set(why)  # type: ignore[attr-defined]
        return not why

    def settings(self, context: Context) -> tuple[str, ...]:
        """What overrides the study that the scene is; see `load_study`."""
        return ()

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Start the job; the panel shows how far it is."""
        return self.begin(context)

    def execute(self, context: Context) -> set[str]:
        """Run the job to its end."""
        return self.run(context)

    def begin(self, context: Context) -> set[str]:
        """Start the job and return; the panel says what keeps it from starting."""
        label = self.label or self.bl_label
        try:
            jobs.begin(context, self.analysis, label, self.settings(context), self.staging)
        except HeliformError as error:
            jobs.state.label, jobs.state.message = label, str(error)
            self.report({"ERROR"}, str(error))
        return {"CANCELLED"}  # nothing is to be undone yet

    def run(self, context: Context) -> set[str]:
        """Run the job to its end, and say how it went."""
        label = self.label or self.bl_label
        try:
            jobs.run(context, self.analysis, label, self.settings(context), self.staging)
        except Cancelled:
            self.report({"WARNING"}, f"{label} was cancelled.")
            return {"CANCELLED"}
        except HeliformError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


def reason_against(traces: bool = True) -> str:
    """Why no analysis, or none that ``traces`` light, can be started now, or an empty text."""
    if jobs.state.running:
        return f"{jobs.state.label} is running; wait or cancel it"
    if not traces:
        return ""
    choice = runtime.choose()
    return "" if choice.backend else f"Photons cannot be traced here: {choice.reason}"


class HELIFORM_OT_cancel_job(Operator):
    """Stop the running job; the scene stays as it is"""

    bl_idname = "heliform.cancel_job"
    bl_label = "Cancel"
    bl_options = set()

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only while a job runs."""
        return jobs.state.running

    def execute(self, context: Context) -> set[str]:
        """Ask it to stop."""
        jobs.cancel()
        return {"FINISHED"}


class HELIFORM_OT_export_study(Reporting, Operator):
    """Write the scene as a study: a folder that runs on any machine that has Heliform"""

    bl_idname = "heliform.export_study"
    bl_label = "Export Study"
    bl_options = set()

    analysis: StringProperty(default=TRACE_PHOTONS.name, options={"HIDDEN", "SKIP_SAVE"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN"})
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Ask where to."""
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def act(self, context: Context) -> str:
        """Write a new folder. Raises FileError where that is not possible."""
        name = safe_name(Path(bpy.data.filepath).stem or context.scene.name)
        folder = named_folder(self.directory) / f"{name} study"
        if folder.exists():
            raise FileError(f"“{folder}” is there already; choose another place, or delete it.")
        analysis = find_analysis(self.analysis, self.bl_label)
        staging = staging_of(analysis)
        assert staging, f"{analysis.name} has no staging"
        given = staging.gather(context, analysis)
        path = jobs.export(context.scene, given, analysis, folder)
        return " ".join([f"The study is “{path}”.", *given.notes])


class HELIFORM_OT_load_study(Reporting, Operator):
    """Add the objects and settings of a study to the scene"""

    bl_idname = "heliform.load_study"
    bl_label = "Load Study"
    bl_options = {"REGISTER", "UNDO"}

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN"})
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only in Object Mode."""
        return in_object_mode(context)

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Ask which, starting among the studies that come with Heliform."""
        if not self.filepath:
            self.filepath = str(studies.SHIPPED / "demo.toml")
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def act(self, context: Context) -> str | None:
        """Add the study's first case. Raises HeliformError, and adds nothing then."""
        study = load_study(Path(bpy.path.abspath(self.filepath)))
        case = study.cases[0]
        studies.add_case(context.scene, case, study.seed)
        staging = staging_of(case.analysis)
        if staging and staging.add:
            staging.add(context.scene, case.parameters)
        if len(study.cases) > 1:
            first = study.cases[0].name
            return f"“{first}” is the first of {len(study.cases)} cases of “{study.title}”."
        return None


class HELIFORM_OT_open_report(Reporting, Operator):
    """Open the report of the shown result in the browser"""

    bl_idname = "heliform.open_report"
    bl_label = "Open Report"
    bl_options = set()

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a result."""
        return results.is_result(context.scene.heliform.shown)

    def act(self, context: Context) -> None:
        """Open it. Raises FileError where the folder is gone."""
        folder = results.meta_of(context.scene.heliform.shown)["folder"]
        open_report(folder, "trace photons again")


def open_report(folder: str, remedy: str) -> None:
    """Open the report in a result's folder. Raises FileError, with the remedy, where it is gone."""
    report = Path(folder, "report.html")
    if not report.is_file():
        raise FileError(f"There is no report “{report}” any more; {remedy}.")
    bpy.ops.wm.url_open(url=report.as_uri())


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_OT_cancel_job,
        HELIFORM_OT_export_study,
        HELIFORM_OT_load_study,
        HELIFORM_OT_open_report,
    )
)
