"""Blender with nothing of the user's in it, and a clean file with Heliform for each test."""

import os
import tempfile

_EMPTY = tempfile.mkdtemp(prefix="heliform-blender-")
os.environ["BLENDER_USER_RESOURCES"] = _EMPTY
os.environ["BLENDER_USER_EXTENSIONS"] = os.path.join(_EMPTY, "extensions")

import bpy  # noqa: E402
import heliform  # noqa: E402
import pytest  # noqa: E402


@pytest.fixture(scope="session", autouse=True)
def registered():
    heliform.register()
    yield
    heliform.unregister()


@pytest.fixture(autouse=True)
def clean_file(registered):
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)


@pytest.fixture
def scene(clean_file):
    return bpy.context.scene


@pytest.fixture
def seen(scene):
    """Reads the Blender scene as the engines get it."""
    from heliform.addon.bridge.read import read_scene

    return lambda: read_scene(scene, bpy.context.evaluated_depsgraph_get())
