"""Light: tracing photons and adding more, what of the result is shown, sections across it."""

import json
from pathlib import Path

import bpy
from bpy.props import StringProperty
from bpy.types import Context, Operator

from ..addon.bridge import results, sections, shading, showing
from ..addon.bridge.receivers import values_to_vertices
from ..addon.properties import read, scale_of
from ..engines import light
from ..engines.core.colour import Display
from ..engines.core.errors import HeliformError, SceneError
from ..engines.light.section import section
from . import Reporting, in_object_mode
from .run import RunAnalysis


class HELIFORM_OT_trace_photons(RunAnalysis, Operator):
    """Trace photons from the lamps through the glass onto the receivers"""

    bl_idname = "heliform.trace_photons"
    bl_label = "Trace Photons"
    analysis = light.TRACE_PHOTONS

    def settings(self, context: Context) -> tuple[str, ...]:
        """Keep the sums of the photons, so that more can be added."""
        return ("parameters.keep_sums=true",)


class HELIFORM_OT_refine_photons(RunAnalysis, Operator):
    """Trace more photons of the shown result's scene, until what is asked for now is reached"""

    bl_idname = "heliform.refine_photons"
    bl_label = "Add Photons"
    analysis = light.TRACE_PHOTONS

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only where the shown result has kept its sums."""
        picture = context.scene.heliform.shown
        if not results.is_result(picture):
            return False
        if not Path(results.meta_of(picture)["folder"], cls.analysis.sums).is_file():
            cls.poll_message_set("The folder of this result has no sums of photons any more")
            return False
        return super().poll(context)

    def settings(self, context: Context) -> tuple[str, ...]:
        """Go on from the shown result."""
        folder = results.meta_of(context.scene.heliform.shown)["folder"]
        return (f"refine={json.dumps(folder, ensure_ascii=False)}",)


class _OnResult(Reporting):
    """An operator on the shown result."""

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a result."""
        return results.is_result(context.scene.heliform.shown)


class HELIFORM_OT_recolour(_OnResult, Operator):
    """Colour the result anew from its values, without tracing again"""

    bl_idname = "heliform.recolour"
    bl_label = "Recolour"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Colour all pictures. Raises ParameterError for a range that is none."""
        display = read(context.scene.heliform.display, Display)
        showing.recolour(results.results_of(context.scene), display)


class HELIFORM_OT_show_result(_OnResult, Operator):
    """Show the numbers and the legend of this receiver's result"""

    bl_idname = "heliform.show_result"
    bl_label = "Show Result"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(options={"HIDDEN"})

    def act(self, context: Context) -> None:
        """Show it. Raises SceneError when it is gone."""
        found = [p for p in results.results_of(context.scene) if p.name == self.name]
        if not found:
            raise SceneError(f"There is no result “{self.name}” in this scene any more.")
        context.scene.heliform.shown = found[0]
        shading.bring_forward(results.owner_of(found[0]), results.side_of(found[0]))


class HELIFORM_OT_values_to_vertices(_OnResult, Operator):
    """Write the shown map as an attribute of its mesh's vertices, named after the map"""

    bl_idname = "heliform.values_to_vertices"
    bl_label = "Values to Vertices"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with the result of a mesh, in Object Mode."""
        picture = context.scene.heliform.shown
        if not super().poll(context) or results.is_plane(picture):
            return False
        if picture.heliform_map == results.COLOUR:
            cls.poll_message_set("Show a map in lx first")
            return False
        return in_object_mode(context)

    def act(self, context: Context) -> str:
        """Write it. Raises SceneError where the mesh is not what was traced."""
        picture = context.scene.heliform.shown
        name = values_to_vertices(context, picture)
        return f"The vertices of “{results.name_of(picture)}” have the attribute “{name}”."


class _OnPlane(_OnResult):
    """An operator on the shown result of a plane."""

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a result that a section can go across."""
        return super().poll(context) and results.is_plane(context.scene.heliform.shown)


class HELIFORM_OT_section(_OnPlane, Operator):
    """Plot the illuminance along the section line, or across the middle where there is none"""

    bl_idname = "heliform.section"
    bl_label = "Section"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> str:
        """Write the section beside the result and plot it in the view."""
        picture = context.scene.heliform.shown
        start, end = sections.line_of(context, picture)
        made = section(results.staged(picture), start, end)
        sections.stage_section(picture, made)
        folder = Path(results.meta_of(picture)["folder"])
        try:
            made.save_csv(folder / "section.csv")
            made.save_png(folder / "section.png", context.scene.heliform.display.log)
        except HeliformError as error:  # moved away since: the text and the plot are there
            return f"The section is in the text “{sections.text_name(picture)}”. {error}"
        return f"The section is in “{folder / 'section.csv'}”."


class HELIFORM_OT_clear_section(_OnPlane, Operator):
    """Take the plot of the section away"""

    bl_idname = "heliform.clear_section"
    bl_label = "Hide Section"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Forget the section; its text and files stay."""
        context.scene.heliform.shown.pop(results.SECTION, None)


class HELIFORM_OT_add_section_line(_OnPlane, Operator):
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
        HELIFORM_OT_refine_photons,
        HELIFORM_OT_recolour,
        HELIFORM_OT_show_result,
        HELIFORM_OT_values_to_vertices,
        HELIFORM_OT_section,
        HELIFORM_OT_clear_section,
        HELIFORM_OT_add_section_line,
    )
)
