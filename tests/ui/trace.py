"""The demo in the window: trace, watch, cancel, trace again, look at the section.

    blender --factory-startup --python-use-system-env --window-geometry 0 0 1600 1000 \\
        --python tests/ui/trace.py -- DIR

with the packages that Heliform needs on PYTHONPATH.
"""

import sys
from collections.abc import Generator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import window


def steps() -> Generator[float]:
    window.load()
    yield from window.open_sidebar()
    jobs = window.jobs()
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    window.call(bpy.ops.heliform.add_demo)
    window.call(bpy.ops.view3d.view_all)
    bpy.context.view_layer.objects.active = None
    yield 3.0  # shaders compile
    gaps = window.Gaps()
    yield 3.0
    gaps.say("idle")
    tracing = bpy.context.scene.heliform.photon_tracing
    tracing.until, tracing.error = "error", 0.25
    window.call(bpy.ops.heliform.trace_photons, "INVOKE_DEFAULT")
    yield 6.0
    gaps.say("while tracing")
    window.picture("running")
    window.call(bpy.ops.heliform.cancel_job)
    while jobs.state.running:
        yield 0.1
    yield 0.5
    assert bpy.context.scene.heliform.shown is None
    window.picture("cancelled")
    tracing.until, tracing.landed = "landed", 500_000
    window.call(bpy.ops.heliform.trace_photons, "INVOKE_DEFAULT")
    while jobs.state.running:
        yield 0.2
    yield 1.0
    gaps.say("tracing to the end")
    assert bpy.context.scene.heliform.shown, jobs.state.message
    window.picture("done")
    bpy.context.scene.heliform.display.log = True
    window.call(bpy.ops.heliform.recolour)
    window.call(bpy.ops.heliform.section)
    yield 2.0
    window.picture("section")
    bpy.context.scene.heliform.shown.heliform_map = "half_width"
    yield 1.0
    window.picture("half_width")


window.play(steps())
