"""What a person sets once for all files, and what this machine can do."""

import getpass
from pathlib import Path

import bpy

from ..engines.core import doctor
from .workers import new_worker

PACKAGE = __package__.rpartition(".")[0]
"""The add-on's name, as an extension or as a module."""


class HELIFORM_preferences(bpy.types.AddonPreferences):
    """Heliform's preferences."""

    bl_idname = PACKAGE

    folder: bpy.props.StringProperty(
        name="Results",
        description="Folder that results go into; empty puts them into a folder “heliform” beside "
        "the .blend, or among the temporary files until that is saved",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )

    def draw(self, context: bpy.types.Context) -> None:
        """The folder, the backend and the doctor."""
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "folder")
        row = layout.row()
        row.label(text=f"Photons are traced by: {doctor.backend_text()}", icon="LIGHT")
        row.operator("heliform.doctor")


class HELIFORM_OT_doctor(bpy.types.Operator):
    """Look at everything that Heliform stands on, and say what is missing"""

    bl_idname = "heliform.doctor"
    bl_label = "Doctor"
    bl_options = set()

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Print the lines and keep them in a text."""
        self._lines = _examine()
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Show the lines in a window of their own."""
        self._lines = _examine()
        return context.window_manager.invoke_popup(self, width=640)

    def draw(self, context: bpy.types.Context) -> None:
        """A row a line."""
        self.layout.label(text="Heliform on this machine")
        column = self.layout.column(align=True)
        for line in self._lines:
            split = column.split(factor=0.2)
            split.label(text=line.name, icon="CHECKMARK" if line.ok else "ERROR")
            split.label(text=line.text)
        self.layout.label(text=f"The same stands in the text “{TEXT}”.")


TEXT = "Heliform Doctor"


def _examine() -> list[doctor.Line]:
    lines = doctor.examine(new_worker())
    text = bpy.data.texts.get(TEXT) or bpy.data.texts.new(TEXT)
    text.from_string("\n".join(map(str, lines)) + "\n")
    print(*lines, sep="\n")
    return lines


def results_folder() -> Path:
    """Where the folders of results go."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    chosen = addon.preferences.folder if addon and addon.preferences else ""
    if chosen and (bpy.data.filepath or not chosen.startswith("//")):
        return Path(bpy.path.abspath(chosen))
    if bpy.data.filepath:
        return Path(bpy.data.filepath).parent / "heliform"
    return Path(bpy.app.tempdir).parent / f"heliform-{getpass.getuser()}"


register, unregister = bpy.utils.register_classes_factory(
    (HELIFORM_preferences, HELIFORM_OT_doctor)
)
