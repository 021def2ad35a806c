"""What may go wrong in the window: undo, a killed worker, another file, a click on the display.

    blender --factory-startup --python-use-system-env --enable-event-simulate \\
        --window-geometry 0 0 1600 1000 --python tests/ui/trouble.py -- DIR
"""

import os
import signal
import sys
from collections.abc import Generator
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import window


def pixels(name: str) -> np.ndarray:
    """An image's values."""
    image = bpy.data.images[name]
    values = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(values)
    return values


def trace(**settings: object) -> Generator[float]:
    """Press the button and wait for the end."""
    from heliform.addon import jobs

    for name, value in settings.items():
        setattr(bpy.context.scene.heliform.photon_tracing, name, value)
    window.call(bpy.ops.heliform.trace_photons, "INVOKE_DEFAULT")
    while jobs.state.running:
        yield 0.1
    yield 0.3


def steps() -> Generator[float]:
    window.load()
    from heliform.addon import jobs

    yield from window.open_sidebar()
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    window.call(bpy.ops.heliform.add_demo)
    bpy.context.view_layer.objects.active = None
    window.call(bpy.ops.ed.undo_push, message="Demo")

    yield from trace(until="landed", landed=20_000)
    first = pixels("Receiver illuminance")
    yield from trace(landed=200_000)
    second = pixels("Receiver illuminance")
    assert not np.array_equal(first, second)
    window.call(bpy.ops.ed.undo)
    yield 0.3
    print(
        "undo brings the first result back:", np.array_equal(pixels("Receiver illuminance"), first)
    )
    window.call(bpy.ops.ed.redo)
    yield 0.3
    print("redo the second:", np.array_equal(pixels("Receiver illuminance"), second))
    window.call(bpy.ops.ed.undo)
    window.call(bpy.ops.ed.undo)
    yield 0.3
    print("undone wholly:", bpy.context.scene.heliform.shown, len(bpy.data.images))
    window.call(bpy.ops.ed.redo)
    yield 0.5

    picture = pixels("Receiver false colour")
    yield from window.click(1144, 145)  # Log
    yield 0.5
    window.picture("clicked")
    changed = not np.array_equal(picture, pixels("Receiver false colour"))
    print("log:", bpy.context.scene.heliform.display.log, "recoloured:", changed)

    window.call(bpy.ops.heliform.trace_photons, "INVOKE_DEFAULT")
    yield 0.5
    os.kill(jobs.worker().pid, signal.SIGKILL)
    yield 1.0
    window.picture("killed")
    print("killed:", jobs.state)
    yield from trace(landed=20_000)
    assert not jobs.state.message

    bpy.context.scene.heliform.photon_tracing.until = "time"
    window.call(bpy.ops.heliform.trace_photons, "INVOKE_DEFAULT")
    yield 1.0
    window.call(bpy.ops.wm.read_homefile)
    yield 2.0
    print("another file:", jobs.state, jobs._tasks)
    sys.modules["heliform"].unregister()
    yield 0.5


window.play(steps())
