"""What a person can do, one file a room: read properties, call an engine, hand on the result."""

from collections.abc import Callable
from typing import Any

import bpy

from ..engines.core.errors import HeliformError


class Reporting:
    """An operator whose `act` does the work; what a user can do wrong is said in one sentence."""

    report: Callable[[set[str], str], None]

    def act(self, context: bpy.types.Context) -> str | None:
        """Do it; returns a sentence to report, if there is one. Raises HeliformError."""
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> Any:
        """Act, and say how it went."""
        try:
            said = self.act(context)
        except HeliformError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if said:
            self.report({"INFO"}, said)
        return {"FINISHED"}


class ObjectMode(Reporting):
    """An operator that adds or replaces objects."""

    poll_message_set: Callable[[str], None]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only in Object Mode."""
        if not in_object_mode(context):
            cls.poll_message_set("Leave Edit Mode first")
            return False
        return True


def in_object_mode(context: bpy.types.Context) -> bool:
    """Whether objects can be added and replaced."""
    return context.mode == "OBJECT"
