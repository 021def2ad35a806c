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
    jobs = window.jobs()
    for name, value in settings.items():
        setattr(bpy.context.scene.heliform.photon_tracing, name, value)
    window.call(bpy.ops.heliform.trace_photons, "INVOKE_DEFAULT")
    while jobs.state.running:
        yield 0.1
    yield 0.3


def steps() -> Generator[float]:
    window.load()
    jobs = window.jobs()
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
    assert np.array_equal(pixels("Receiver illuminance"), first)
    window.call(bpy.ops.ed.redo)
    yield 0.3
    assert np.array_equal(pixels("Receiver illuminance"), second)
    window.call(bpy.ops.ed.undo)
    window.call(bpy.ops.ed.undo)
    yield 0.3
    assert bpy.context.scene.heliform.shown is None
    window.call(bpy.ops.ed.redo)
    yield 0.5

    yield from window.scroll(60)
    window.picture("scrolled")
    picture, log = pixels("Receiver false colour"), bpy.context.scene.heliform.display.log
    for _ in range(5):  # a busy machine loses a click
        if bpy.context.scene.heliform.display.log == log:
            yield from window.click(1144, 378)  # Log, where it is with this size of window
            yield 1.0
    window.picture("clicked")
    assert bpy.context.scene.heliform.display.log != log
    assert not np.array_equal(picture, pixels("Receiver false colour"))

    window.call(bpy.ops.heliform.trace_photons, "INVOKE_DEFAULT")
    yield 0.5
    os.kill(jobs.worker().pid, signal.SIGKILL)
    yield 1.0
    window.picture("killed")
    assert "ended with signal 9" in jobs.state.message
    yield from trace(landed=20_000)
    assert not jobs.state.message

    bpy.context.scene.heliform.photon_tracing.until = "time"
    window.call(bpy.ops.heliform.trace_photons, "INVOKE_DEFAULT")
    yield 1.0
    window.call(bpy.ops.wm.read_homefile)
    yield 2.0
    assert not jobs.state.running
    assert not jobs._tasks
    if window.package() == window.INSTALLED:
        bpy.ops.preferences.addon_disable(module=window.INSTALLED)
    else:
        sys.modules["heliform"].unregister()
    yield 0.5


window.play(steps())
