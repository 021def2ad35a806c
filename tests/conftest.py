"""Blender comes first: bpy must be loaded before pymeshlab, and see nothing of the user's."""

import contextlib
import os
import tempfile

_empty = tempfile.TemporaryDirectory(prefix="heliform-blender-", ignore_cleanup_errors=True)
os.environ["BLENDER_USER_RESOURCES"] = _empty.name
os.environ["BLENDER_USER_EXTENSIONS"] = os.path.join(_empty.name, "extensions")

with contextlib.suppress(ImportError):
    import bpy  # noqa: F401
