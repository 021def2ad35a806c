"""The scene: adding lamps and receivers, saying what a mesh is, the demo."""

from collections.abc import Iterator
from dataclasses import replace

import bpy
from bpy.props import EnumProperty, StringProperty
from bpy.types import Context, Event, Object, Operator

from ..addon import objects
from ..addon.bridge.read import read_receiver
from ..addon.bridge.receivers import unwrap_those
from ..addon.model import ROLES
from ..addon.properties import (
    draw,
    enum_items,
    enum_number,
    read,
    scale_of,
    with_properties,
    write_unset,
)
from ..engines.core.atlas import require_chart
from ..engines.core.errors import SceneError
from ..engines.core.material_presets import material_presets
from ..engines.core.parameters import fields_of
from ..engines.core.scene import Lamp, Material, Plane, Surface
from ..engines.glass import TABLE_1
from . import ObjectMode, Reporting

_FLUX = 500.0
"""Luminous flux in lm that a lamp without a photometric file starts with."""

_KINDS = next(field for field in fields_of(Material) if field.name == "kind")


def _preset_items() -> Iterator[tuple[str, str, str, int]]:
    """The typical materials as a menu has them, under headings."""
    group = ""
    for name, preset in material_presets().items():
        if preset.group != group:
            group = preset.group
            yield "", group, "", 0
        yield name, preset.label, preset.told.rstrip("."), enum_number(name)


@with_properties(Lamp)
class HELIFORM_OT_add_lamp(ObjectMode, Operator):
    """Add a lamp 22 cm above the 3D cursor, shining down"""

    bl_idname = "heliform.add_lamp"
    bl_label = "Add Lamp"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Add the lamp; what keeps it from shining is shown in the panel."""
        scale = scale_of(context.scene)
        flux = 0.0 if self.source == "ies" else _FLUX
        write_unset(self, replace(Lamp(), source=self.source, flux=flux), scale)
        objects.add_lamp(context, read(self, Lamp, scale), "Lamp")

    def draw(self, context: Context) -> None:
        """What the source needs."""
        self.layout.use_property_split = True
        draw(self.layout, self, Lamp, objects.lamp_hides(self))


@with_properties(Plane)
class HELIFORM_OT_add_receiver(ObjectMode, Operator):
    """Add a plane that gathers light, 1 mm below the 3D cursor so that glass does not touch it"""

    bl_idname = "heliform.add_receiver"
    bl_label = "Add Receiver"
    bl_options = {"REGISTER", "UNDO"}

    def act(self, context: Context) -> None:
        """Add the receiver."""
        scale = scale_of(context.scene)
        write_unset(self, Plane(), scale)
        objects.add_receiver(context, read(self, Plane, scale), "Receiver")

    def draw(self, context: Context) -> None:
        """The plane's values."""
        self.layout.use_property_split = True
        draw(self.layout, self, Plane)


class HELIFORM_OT_mark_as(Reporting, Operator):
    """Say what the selected meshes are to light"""

    bl_idname = "heliform.mark_as"
    bl_label = "Mark As"
    bl_options = {"REGISTER", "UNDO"}

    role: EnumProperty(
        name="Role",
        description="What the selected meshes are to light",
        items=[item for item in ROLES if item[0] != "LAMP"],
        default="BODY",
    )
    kind: EnumProperty(
        name="Material",
        description=_KINDS.help,
        items=enum_items(_KINDS.choices, _KINDS.help),
        default="diffuse",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a mesh selected that is no lamp, or with an instance of a collection."""
        return bool(_meshes(context))

    def act(self, context: Context) -> str:
        """Mark each; a body keeps its material unless a kind is set, and is matte without one.

        A receiver that has no UV map gets one. Raises SceneError where one cannot be a receiver;
        none is marked then.
        """
        chosen = _meshes(context)
        notes: list[str] = []
        if self.role == "RECEIVER":
            notes = unwrap_those(context, chosen)
            depsgraph = context.evaluated_depsgraph_get()
            for obj in chosen:
                found = read_receiver(obj, depsgraph, scale_of(context.scene))
                if isinstance(found, Surface):
                    require_chart(found)
        kind = self.kind if self.properties.is_property_set("kind") else ""
        notes += [objects.mark(obj, self.role, kind) for obj in chosen]
        return " ".join(filter(None, notes))

    def draw(self, context: Context) -> None:
        """The material only for bodies."""
        self.layout.use_property_split = True
        self.layout.prop(self, "role")
        if self.role == "BODY":
            self.layout.prop(self, "kind")


class HELIFORM_OT_set_material(Reporting, Operator):
    """Give the selected bodies a typical material; its figure and source are in the tooltip"""

    bl_idname = "heliform.set_material"
    bl_label = "Material Preset"
    bl_options = {"REGISTER", "UNDO"}

    preset: EnumProperty(
        name="Preset",
        description="A typical material",
        items=list(_preset_items()),
        default="wall",
    )

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a body that is active or selected."""
        return bool(_bodies(context))

    def act(self, context: Context) -> str:
        """Set it on each; says the figure and where it is from."""
        preset = material_presets()[self.preset]
        for obj in _bodies(context):
            objects.set_material(obj, preset.material)
        return preset.told


class HELIFORM_OT_mark_light(Reporting, Operator):
    """Say whether the selected Blender lights shine in the simulation"""

    bl_idname = "heliform.mark_light"
    bl_label = "Mark Light"
    bl_options = {"REGISTER", "UNDO"}

    role: EnumProperty(
        name="Role",
        description="Whether Heliform sees the selected lights",
        items=[item for item in ROLES if item[0] in ("LAMP", "NONE")],
        default="LAMP",
    )

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a light selected."""
        return bool(_lights(context))

    def act(self, context: Context) -> None:
        """Mark each; what of it is not understood is shown in the panel."""
        for obj in _lights(context):
            objects.mark(obj, self.role)


class HELIFORM_OT_select(ObjectMode, Operator):
    """Select this object alone and make it active"""

    bl_idname = "heliform.select"
    bl_label = "Select"
    bl_options = {"INTERNAL", "UNDO"}

    name: StringProperty(options={"HIDDEN"})

    def act(self, context: Context) -> None:
        """Select it. Raises SceneError when it is gone."""
        obj = context.view_layer.objects.get(self.name)
        if obj is None:
            raise SceneError(f"There is no “{self.name}” in this view layer any more.")
        objects.select_only(context, obj)


class HELIFORM_OT_add_demo(ObjectMode, Operator):
    """Add the printed tube, a lamp above it and a receiver below it"""

    bl_idname = "heliform.add_demo"
    bl_label = "Demo Scene"
    bl_options = {"REGISTER", "UNDO"}

    def invoke(self, context: Context, event: Event) -> set[str]:
        """Add it, and bring it into view."""
        ended = self.execute(context)
        area = context.area
        if area and area.type == "VIEW_3D":
            region = next(r for r in area.regions if r.type == "WINDOW")
            with context.temp_override(area=area, region=region):
                bpy.ops.view3d.view_all()
        return ended

    def act(self, context: Context) -> None:
        """Experiment A: a tube 1 mm above the plane, the lamp 0.22 m over the plane."""
        objects.add_demo(context, TABLE_1["tube"])


def _meshes(context: Context) -> list[Object]:
    return [obj for obj in context.selected_objects if objects.may_be_body(obj)]


def _bodies(context: Context) -> list[Object]:
    """The bodies that are selected, the active object among them."""
    chosen = {*context.selected_objects, context.object} - {None}
    return [obj for obj in chosen if obj.heliform.role == "BODY"]


def _lights(context: Context) -> list[Object]:
    return [obj for obj in context.selected_objects if obj.type == "LIGHT"]


_CLASSES = (
    HELIFORM_OT_add_lamp,
    HELIFORM_OT_add_receiver,
    HELIFORM_OT_mark_as,
    HELIFORM_OT_set_material,
    HELIFORM_OT_mark_light,
    HELIFORM_OT_select,
    HELIFORM_OT_add_demo,
)
register, unregister = bpy.utils.register_classes_factory(_CLASSES)
