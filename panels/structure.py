"""The Structure room: the active structure's form, handles, loads, sections and result."""

import textwrap
from typing import Any

import bpy
from bpy.types import Context, Object, Panel, UILayout

from ..addon import jobs
from ..addon.bridge import members
from ..addon.properties import draw
from ..addon.structures import active_structure
from ..engines.core.parameters import fields_of
from ..engines.structure.form_finding import FormFinding
from ..engines.structure.loading import Loading
from ..engines.structure.rules import Rules
from ..engines.structure.structure import Structure
from . import Room
from .scene import (
    draw_notes,
    draw_problem,
    draw_progress,
    draw_row,
    draw_sentence,
    prepare,
)

_WIDTH = 34
"""Letters in a sidebar as wide as it is at first."""

_FIGURES = (
    ("mass", "Mass", 1e-3, "t"),
    ("mass_steel", "Steel", 1e-3, "t"),
    ("mass_timber", "Timber", 1e-3, "t"),
    ("embodied_energy", "Embodied energy", 1.0, "GJ"),
    ("carbon", "Carbon", 1e-3, "t CO₂e"),
    ("max_utilisation", "Utilisation", 100.0, "%"),
    ("max_displacement", "Displacement", 1e3, "mm"),
    ("max_service_utilisation", "Deflection limit", 100.0, "%"),
    ("first_frequency", "Frequency", 1.0, "Hz"),
    ("buckling_factor", "Buckling factor", 1.0, ""),
    ("members", "Members", 1.0, ""),
    ("sections", "Sections", 1.0, ""),
    ("rounds", "Rounds", 1.0, ""),
)
_PARTS = {"columns", "opening_1", "opening_2"}
"""Of a form, what is in a panel of its own."""
_EVERYDAY = ("mode", "choose", "per", "steel", "timber", "sizes")
"""The rules that are changed daily; the rest is in a panel of its own."""


class _Part(Room):
    """A panel of the active structure's."""

    bl_parent_id = "HELIFORM_PT_structure"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a structure."""
        return active_structure(context) is not None


class HELIFORM_PT_structure_start(Room, Panel):
    """Roofs, shells and façades, analysed and sized as they are drawn"""

    bl_label = "Structure"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only without a structure."""
        return active_structure(context) is None

    def draw(self, context: Context) -> None:
        """What there is to start from."""
        prepare(self.layout)
        self.layout.operator_menu_enum("heliform.add_structure", "preset", icon="ADD")
        self.layout.operator("heliform.structure_from_mesh", icon="MESH_GRID")


class HELIFORM_PT_structure(Room, Panel):
    """The form of the active structure"""

    bl_idname = "HELIFORM_PT_structure"
    bl_label = "Structure"

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a structure."""
        return active_structure(context) is not None

    def draw(self, context: Context) -> None:
        """Its measures; those of rarely needed parts are below."""
        layout, obj = self.layout, _target(context)
        prepare(layout)
        own = obj.heliform
        draw_problem(layout, obj)
        form = own.structure.form
        if form == "mesh":
            layout.prop(own, "source")
            draw(layout, own.structure.network, _record("network"))
        else:
            draw(layout, getattr(own.structure, form), _record(form), _PARTS)


class HELIFORM_PT_structure_parts(_Part, Panel):
    """Columns and openings"""

    bl_label = "Columns and Openings"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only where the form has some."""
        return super().poll(context) and _target(context).heliform.structure.form in (
            "roof",
            "shell",
        )

    def draw(self, context: Context) -> None:
        """Those of the form."""
        prepare(self.layout)
        structure = _target(context).heliform.structure
        record = _record(structure.form)
        plain = {field.name for field in fields_of(record)} - _PARTS
        draw(self.layout, getattr(structure, structure.form), record, plain)


class HELIFORM_PT_structure_handles(_Part, Panel):
    """What is dragged in the view"""

    bl_label = "Handles"

    def draw(self, context: Context) -> None:
        """Which handles are shown, and how members meet."""
        layout, own = self.layout, _target(context).heliform
        prepare(layout)
        column = layout.column(heading="Drag")
        column.enabled = own.structure.form != "mesh"
        column.prop(own, "controls")
        column.prop(own, "levels")
        column.prop(own, "turns")
        layout.prop(own.structure, "turn_limit")
        layout.prop(own, "joint")


class HELIFORM_PT_structure_levels(_Part, Panel):
    """The nine values of the level sets, as numbers"""

    bl_label = "Level Sets"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Material above, turn below; seen from above, u to the right."""
        layout, own = self.layout, _target(context).heliform
        for kind, label in (("material", "Material: above 0 is steel"), ("turn", "Turn")):
            layout.label(text=label)
            grid = layout.column(align=True)
            for v in (2, 1, 0):
                row = grid.row(align=True)
                for u in range(3):
                    row.prop(getattr(own.structure, kind), f"c{u}{v}", text="", slider=True)


class HELIFORM_PT_structure_found(_Part, Panel):
    """The shape that a net finds for itself"""

    bl_label = "Form Finding"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Not for a façade, which is as its plan is."""
        obj = active_structure(context)
        return obj is not None and obj.heliform.structure.form != "facade"

    def draw(self, context: Context) -> None:
        """Whether, and by which forces."""
        prepare(self.layout)
        draw(self.layout, _target(context).heliform.structure.form_finding, FormFinding)


class HELIFORM_PT_structure_loads(_Part, Panel):
    """What it carries"""

    bl_label = "Loads"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """The loads."""
        prepare(self.layout)
        draw(self.layout, _target(context).heliform.structure.loading, Loading)


class HELIFORM_PT_structure_sections(_Part, Panel):
    """How sections are chosen"""

    bl_label = "Sections"

    def draw(self, context: Context) -> None:
        """The everyday rules, and the button."""
        layout, own = self.layout, _target(context).heliform
        prepare(layout)
        for name in _EVERYDAY:
            layout.prop(own.structure.rules, name)
        layout.prop(own, "live")
        if jobs.state.running:
            draw_progress(layout)
        else:
            row = layout.row()
            row.scale_y = 1.4
            row.operator("heliform.size_structure", icon="PLAY")
        if jobs.state.label == "Size Members":
            draw_sentence(layout, jobs.state.message)


class HELIFORM_PT_structure_rules(_Part, Panel):
    """The rest of the rules"""

    bl_label = "Rules"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Everything but the everyday ones."""
        prepare(self.layout)
        draw(self.layout, _target(context).heliform.structure.rules, Rules, set(_EVERYDAY))


class HELIFORM_PT_structure_result(_Part, Panel):
    """What came out"""

    bl_label = "Result"

    def draw(self, context: Context) -> None:
        """What is shown, the numbers, and the files."""
        layout, obj = self.layout, _target(context)
        prepare(layout)
        facts = members.facts_of(obj)
        if facts is None:
            layout.label(text="Not sized yet", icon="INFO")
            return
        layout.prop(obj.heliform, "member_map")
        _draw_displaced(layout, obj, facts)
        _draw_failing(layout, facts)
        _draw_figures(layout, facts["figures"])
        row = layout.row(align=True)
        row.operator("heliform.export_members", icon="EXPORT")
        row.operator("heliform.open_structure_report", text="", icon="URL")
        row.operator("heliform.clear_layer", text="", icon="X")
        draw_notes(layout, facts["notes"])


class HELIFORM_PT_structure_member(_Part, Panel):
    """A picked member's checks"""

    bl_label = "Member"

    def draw(self, context: Context) -> None:
        """Which member, what it is, and how much it uses of each limit."""
        layout, obj = self.layout, _target(context)
        prepare(layout)
        row = layout.row(align=True)
        row.operator("heliform.pick_member", icon="EYEDROPPER")
        row.operator("heliform.worst_member")
        layout.prop(obj.heliform, "member")
        known = members.member_facts(obj, obj.heliform.member)
        if known is None:
            return
        start, end = known["nodes"]
        box = layout.box().column(align=True)
        draw_row(box, "Section", known["section"])
        draw_row(box, "Grade", known["grade"])
        draw_row(box, "Group", known["group"].capitalize())
        draw_row(box, "Nodes", f"{start} and {end}")
        draw_row(box, "Length", f"{known['length']:.3g} m")
        draw_row(box, "Mass", f"{_plain(known['mass'])} kg")
        for name, used in known["checks"]:
            line = layout.column(align=True)
            line.alert = used > 1
            line.progress(text=f"{100 * used:.0f} %", factor=min(used, 1.0))
            for part in textwrap.wrap(name, _WIDTH):
                line.label(text=part)


class HELIFORM_PT_structure_combinations(_Part, Panel):
    """How load cases act together"""

    bl_label = "Combinations"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Context) -> None:
        """Each combination, as it was analysed."""
        facts = members.facts_of(_target(context))
        column = self.layout.column(align=True)
        column.scale_y = 0.8
        for line in facts["combinations"] if facts else ():
            for part in textwrap.wrap(_said(line), _WIDTH):
                column.label(text=part)


def _target(context: Context) -> Object:
    """The structure that `poll` has found."""
    found = active_structure(context)
    assert found is not None
    return found


def _record(name: str) -> Any:
    return next(field.record for field in fields_of(Structure) if field.name == name)


def _said(line: Any) -> str:
    return line if isinstance(line, str) else ": ".join(str(part) for part in line.values())


def _draw_displaced(layout: UILayout, obj: Object, facts: dict[str, Any]) -> None:
    key = members.displaced_key(obj)
    if key is not None:
        row = layout.row(align=True)
        row.use_property_split = False
        row.prop(key, "value", text=f"Displaced × {facts['exaggeration']:g}", slider=True)
        row.operator("heliform.animate_displacement", text="", icon="PLAY")


def _draw_failing(layout: UILayout, facts: dict[str, Any]) -> None:
    failing = int(facts["figures"]["failing"]["value"])
    row = layout.row()
    if failing:
        row.alert = True
        row.label(text=f"{failing} members fail", icon="ERROR")
    else:
        row.label(text="Every member suffices", icon="CHECKMARK")
    if facts["figures"].get("max_service_utilisation", {"value": 0.0})["value"] > 1:
        row = layout.row()
        row.alert = True
        row.label(text="Deflects beyond its limit", icon="ERROR")


def _draw_figures(layout: UILayout, figures: dict[str, Any]) -> None:
    box = layout.box().column(align=True)
    for key, label, factor, unit in _FIGURES:
        if key in figures:
            draw_row(box, label, f"{_plain(factor * figures[key]['value'])} {unit}")


def _plain(value: float) -> str:
    """Four digits or more, and no exponent."""
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


register, unregister = bpy.utils.register_classes_factory(
    (
        HELIFORM_PT_structure_start,
        HELIFORM_PT_structure,
        HELIFORM_PT_structure_handles,
        HELIFORM_PT_structure_result,
        HELIFORM_PT_structure_member,
        HELIFORM_PT_structure_levels,
        HELIFORM_PT_structure_parts,
        HELIFORM_PT_structure_found,
        HELIFORM_PT_structure_loads,
        HELIFORM_PT_structure_sections,
        HELIFORM_PT_structure_rules,
        HELIFORM_PT_structure_combinations,
    )
)
