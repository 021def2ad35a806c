"""What a person can do, one file a room: read properties, call an engine, hand on the result."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import bpy
from bpy.props import BoolProperty, StringProperty

from ..engines.core.errors import FileError, HeliformError
from ..engines.core.files import safe_name


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


class FileWriting(Reporting):
    """An operator that asks where to and writes a file; Blender warns where there is one already.

    ``ending`` is put to a name that has neither it nor one of the ``others``.
    """

    ending = ""
    others: tuple[str, ...] = ()

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN"})
    check_existing: BoolProperty(default=True, options={"HIDDEN"})

    def proposed(self, context: bpy.types.Context) -> str:
        """What the file may be called, without its ending."""
        return context.object.name

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Ask where to."""
        name = f"{safe_name(self.proposed(context))}{self.ending}"
        self.filepath = bpy.path.abspath(f"//{name}")
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def check(self, context: bpy.types.Context) -> bool:
        """Show the ending while the name is chosen, so that Blender looks for the right file."""
        before = self.filepath
        if _last(before):
            self.filepath = _ended(before, self.ending, self.others)
        return self.filepath != before

    def chosen(self) -> Path:
        """The file that was chosen. Raises FileError as `named_file`."""
        return named_file(self.filepath, self.ending, self.others)


def named_file(filepath: str, ending: str, others: Sequence[str] = ()) -> Path:
    """The file that a person chose, ``ending`` put to its name unless it or an other is there.

    Raises FileError where there is no name, or a folder has it.
    """
    name = _last(filepath)
    if not name or name.lower() in (ending, *others):
        raise FileError(f"The file has no name; give it one, such as “wall{ending}”.")
    path = Path(bpy.path.abspath(filepath))
    if not path.is_dir():
        path = Path(_ended(str(path), ending, others))
    if path.is_dir():
        raise FileError(f"“{path}” is a folder; give the file a name.")
    return path


def named_folder(directory: str) -> Path:
    """The folder that a person chose. Raises FileError where none was."""
    if not directory:
        raise FileError("There is no folder to write into; choose one.")
    return Path(bpy.path.abspath(directory))


def _last(filepath: str) -> str:
    """What follows the last folder."""
    return "" if filepath.endswith(("/", os.sep)) else Path(filepath.removeprefix("//")).name


def _ended(filepath: str, ending: str, others: Sequence[str]) -> str:
    there = filepath.lower().endswith((ending, *others))
    return filepath if there else f"{filepath}{ending}"
