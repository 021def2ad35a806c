"""A printable wall in the window: one click, its gate and path, G-code, another relief, undo.

    blender --enable-event-simulate --window-geometry 0 0 1600 1000 \\
        --python tests/ui/wall.py -- DIR

The wall is a click on its button; the rest is called as from the window.
"""

import importlib
import json
import sys
from collections.abc import Generator
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import window

WALL = (1080, 872)
"""Where the button is in a window of 1600 × 1000, from its lower left."""


def wall() -> bpy.types.Object:
    """The wall, looked up anew: undo makes it another."""
    return bpy.data.objects["Rosette"]


def places() -> np.ndarray:
    """The vertices of the wall with its relief."""
    block = wall().evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    found = np.empty(3 * len(block.vertices), dtype=np.float32)
    block.vertices.foreach_get("co", found)
    return found.reshape(-1, 3)


def path() -> bpy.types.Object | None:
    """The curve of the path, if it is shown."""
    return next((o for o in wall().children if o.type == "CURVES"), None)


def nozzle() -> np.ndarray:
    """The points of the path in m."""
    shown = path()
    found = np.empty(3 * len(shown.data.points), dtype=np.float32)
    shown.data.position_data.foreach_get("vector", found)
    return found.reshape(-1, 3)


def exported() -> None:
    """Write the G-code and read the path in it back."""
    file = window.folder() / "Wand ä.gcode"
    assert window.call(bpy.ops.heliform.export_gcode, filepath=str(file)) == {"FINISHED"}
    glass = f"{window.package()}.engines.glass"
    gcode, machine = (importlib.import_module(f"{glass}.{n}") for n in ("gcode", "machine"))
    text = file.read_text(encoding="utf-8")
    found = gcode.read_gcode(text).points(machine.load_machine())
    assert np.abs(found - nozzle()).max() < 1e-6
    verdict = json.loads(file.with_suffix(".gate.json").read_text(encoding="utf-8"))
    assert verdict["passed"]
    print(f"G-code: {len(text.splitlines())} lines, {len(found)} points", flush=True)


def steps() -> Generator[float]:
    window.load()
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    yield from window.open_sidebar()
    yield from window.press(WALL, lambda: "Rosette" in bpy.data.objects)
    yield 2.0
    window.call(bpy.ops.view3d.view_selected)
    yield 2.0
    window.picture("wall")
    assert len(wall().evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons) > 250_000
    yield from window.scroll(60)
    window.picture("wall below")
    window.call(bpy.ops.heliform.check_print, "EXEC_DEFAULT", True)
    yield 2.0
    window.picture("gate")
    window.call(bpy.ops.heliform.preview_path, "EXEC_DEFAULT", True)
    yield 2.0
    yield from window.scroll(60)
    window.picture("path")
    assert len(nozzle()) > 10_000
    exported()
    yield from window.scroll(-60)

    scalloped = places()
    window.call(bpy.ops.heliform.add_relief, "EXEC_DEFAULT", True, style="flat")
    yield 2.0
    window.picture("flat bead")
    flat = places()
    assert np.abs(flat - scalloped).max() > 1e-4
    window.call(bpy.ops.ed.undo)
    yield 1.0
    assert np.array_equal(places(), scalloped)
    assert path() is not None
    window.call(bpy.ops.ed.undo)
    yield 1.0
    assert not wall().heliform.path
    assert path() is None
    assert wall().heliform.gate
    window.picture("undone twice")
    window.call(bpy.ops.ed.redo)
    window.call(bpy.ops.ed.redo)
    yield 1.0
    assert np.array_equal(places(), flat)
    assert path() is not None

    wall().heliform.wall.height = 0.6
    yield 2.0
    window.call(bpy.ops.view3d.view_selected)
    yield from window.scroll(60)
    window.picture("not printable")
    shown = importlib.import_module(f"{window.package()}.addon.printing").verdict_of(wall())
    assert not shown["passed"]
    wall().heliform.wall.thickness = 0.25
    yield from window.scroll(-60)
    window.picture("too thick")
    assert wall().heliform.problem


window.play(steps())
