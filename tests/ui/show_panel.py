"""Open Heliform's sidebar in a real Blender window, to look at it or to take its picture.

    blender --python tests/ui/show_panel.py -- [demo|empty] [active object] [python statement]

The package is imported from this checkout. What it needs besides Blender must be importable, for
example through PYTHONPATH with ``--python-use-system-env``.
"""

import importlib.util
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[2]


def load() -> None:
    """Import the checkout as ``heliform`` and register it."""
    spec = importlib.util.spec_from_file_location(
        "heliform", ROOT / "__init__.py", submodule_search_locations=[str(ROOT)]
    )
    sys.modules["heliform"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules["heliform"])
    sys.modules["heliform"].register()


def steps(scene: str, active: str, statement: str) -> Iterator[float]:
    """What is done to the window, with the seconds to wait between."""
    window = bpy.context.window_manager.windows[0]
    area = next(a for a in window.screen.areas if a.type == "VIEW_3D")
    view = next(r for r in area.regions if r.type == "WINDOW")
    sidebar = next(r for r in area.regions if r.type == "UI")
    with bpy.context.temp_override(window=window, area=area, region=view):
        bpy.ops.object.select_all(action="SELECT")
        bpy.ops.object.delete()
        if scene == "demo":
            bpy.ops.heliform.add_demo()
        if active:
            bpy.ops.heliform.select(name=active)
        exec(statement, {"bpy": bpy})
    area.spaces.active.show_region_ui = True
    yield 0.5
    sidebar.active_panel_category = "Heliform"
    with bpy.context.temp_override(window=window, area=area, region=view):
        if bpy.context.selectable_objects:
            bpy.ops.view3d.view_all()
    area.tag_redraw()
    yield 0.5


def drive(work: Iterator[float]) -> float | None:
    """Take the next step; end Blender where it fails."""
    try:
        return next(work)
    except StopIteration:
        return None
    except Exception:
        traceback.print_exc()
        sys.exit(1)


bpy.context.preferences.view.show_splash = False
load()
words = [*sys.argv[sys.argv.index("--") + 1 :], "", "", ""] if "--" in sys.argv else [""] * 3
running = steps(*words[:3])
bpy.app.timers.register(lambda: drive(running), first_interval=1.0)
