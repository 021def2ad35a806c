"""Light: tracing photons, colouring the result anew, sections across it."""

from pathlib import Path

import bpy
from bpy.types import Context, Operator

from ..addon.bridge import sections, stage
from ..addon.properties import read, scale_of
from ..engines import light
from ..engines.core.colour import Display
from ..engines.core.errors import HeliformError
from ..engines.light.section import section
from . import Reporting, in_object_mode
from .run import RunAnalysis


class HELIFORM_OT_trace_photons(RunAnalysis, Operator):
    """Trace photons from the lamps through the glass onto the receiver"""

    bl_idname = "heliform.trace_photons"
    bl_label = "Trace Photons"
    analysis = light.TRACE_PHOTONS


class _OnResult(Reporting):
    """An operator on the shown result."""

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a result."""
        return stage.is_result(context.scene.heliform.shown)


class HELIFORM_OT_recolour(_OnResult, Operator):
    """Colour the result anew from its values, without tracing again"""

    bl_idname = "heliform.recolour"
    bl_label = "Recolour"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Colour the shown picture. Raises ParameterError for a range that is none."""
        settings = context.scene.heliform
        stage.recolour(settings.shown, read(settings.display, Display))


class HELIFORM_OT_section(_OnResult, Operator):
    """Plot the illuminance along the section line, or across the middle where there is none"""

    bl_idname = "heliform.section"
    bl_label = "Section"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> str:
        """Write the section beside the result and plot it in the view."""
        picture = context.scene.heliform.shown
        start, end = sections.line_of(context, picture)
        made = section(stage.staged(picture), start, end)
        sections.stage_section(picture, made)
        folder = Path(stage.meta_of(picture)["folder"])
        try:
            made.save_csv(folder / "section.csv")
            made.save_png(folder / "section.png", context.scene.heliform.display.log)
        except HeliformError as error:  # moved away since: the text and the plot are there
            return f"The section is in the text “{sections.text_name(picture)}”. {error}"
        return f"The section is in “{folder / 'section.csv'}”."


class HELIFORM_OT_clear_section(_OnResult, Operator):
    """Take the plot of the section away"""

    bl_idname = "heliform.clear_section"
    bl_label = "Hide Section"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Forget the section; its text and files stay."""
        context.scene.heliform.shown.pop(stage.SECTION, None)


class HELIFORM_OT_add_section_line(_OnResult, Operator):
    """Add a line over the receiver; move its ends, then press Section"""

    bl_idname = "heliform.add_section_line"
    bl_label = "Add Section Line"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a result, in Object Mode."""
        return super().poll(context) and in_object_mode(context)

    def act(self, context: Context) -> None:
        """Add it along the receiver's X. Raises SceneError where the receiver is gone."""
        sections.add_line(context, context.scene.heliform.shown, scale_of(context.scene))


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_OT_trace_photons,
        HELIFORM_OT_recolour,
        HELIFORM_OT_section,
        HELIFORM_OT_clear_section,
        HELIFORM_OT_add_section_line,
    )
)
