"""The work plane: a grid of sensors over the floor of a room."""

import bpy
from bpy.types import Context, Object, Operator

from ..addon.bridge.work_plane import add_work_plane
from ..addon.properties import draw, read, scale_of, with_properties, write_unset
from ..engines.sun.work_plane import WorkPlane
from . import Reporting


@with_properties(WorkPlane)
class HELIFORM_OT_add_work_plane(Reporting, Operator):
    """Add a receiver over the floor of the selected rooms, or in Edit Mode over selected faces"""

    bl_idname = "heliform.add_work_plane"
    bl_label = "Add Work Plane"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: Context) -> bool:
        """Only with a mesh selected that is no lamp or receiver, in Object or Edit Mode."""
        if context.mode not in ("OBJECT", "EDIT_MESH") or not _rooms(context):
            cls.poll_message_set("Select the room, or faces of its floor in Edit Mode")
            return False
        return True

    def act(self, context: Context) -> None:
        """Add it. Raises SceneError where there is no floor, or the margin leaves nothing of it."""
        scale = scale_of(context.scene)
        write_unset(self, WorkPlane(), scale)
        add_work_plane(context, _rooms(context), read(self, WorkPlane, scale))

    def draw(self, context: Context) -> None:
        """Its height, margin and spacing."""
        self.layout.use_property_split = True
        draw(self.layout, self, WorkPlane)


def _rooms(context: Context) -> list[Object]:
    """The selected meshes that can be rooms, the active one first."""
    chosen = [
        obj
        for obj in context.selected_objects
        if obj.type == "MESH" and obj.heliform.role not in ("LAMP", "RECEIVER")
    ]
    return sorted(chosen, key=lambda obj: obj != context.object)


register, unregister = bpy.utils.register_classes_factory((HELIFORM_OT_add_work_plane,))
