"""A person's first minutes: press Add Demo, Trace Photons, Cancel, and Trace Photons again.

    blender --enable-event-simulate --window-geometry 0 0 1600 1000 \\
        --python tests/ui/press.py -- DIR

Nothing is called: every operator is run by a click on its button. Prints how long the window did
not answer, and fails where that is more than 0.3 s longer than idle at the 95th percentile.
"""

import sys
from collections.abc import Generator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).parent))
import window

DEMO, TRACE, CANCEL = (1165, 820), (1165, 380), (1264, 380)
"""Where the buttons are in a window of 1600 × 1000, from its lower left."""
SLACK = 0.3


def steps() -> Generator[float]:
    window.load()
    jobs, scene = window.jobs(), bpy.context.scene
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    yield from window.open_sidebar()
    window.picture("empty")
    yield from window.press(DEMO, lambda: "Tube" in bpy.data.objects)
    yield 3.0
    window.picture("demo")
    gaps = window.Gaps()
    yield 3.0
    idle = gaps.say("idle")
    scene.heliform.photon_tracing.until = "time"
    scene.heliform.photon_tracing.seconds = 60.0
    yield 1.0
    yield from window.press(TRACE, lambda: jobs.state.running)
    gaps.gaps.clear()
    yield 6.0
    busy = gaps.say("while tracing")
    window.picture("running")
    assert jobs.state.fraction > 0
    yield from window.press(CANCEL, lambda: not jobs.state.running)
    assert scene.heliform.shown is None
    scene.heliform.photon_tracing.until = "landed"
    scene.heliform.photon_tracing.landed = 1_000_000
    yield from window.press(TRACE, lambda: jobs.state.running)
    while jobs.state.running:
        yield 0.2
    yield 2.0
    window.picture("result")
    assert scene.heliform.shown, jobs.state.message
    assert scene.heliform.shown.packed_file
    assert busy < idle + SLACK, (idle, busy)


window.play(steps())
