"""Sun and sky in the window: studied, recoloured, followed live, picked, drawn and reopened.

    blender --enable-event-simulate --window-geometry 0 0 1600 1000 \\
        --python tests/ui/sun.py -- DIR

A roof stands over a receiver. While Live Sun is on, a control point of the roof is dragged with G
and the mouse, and a sensor is picked with a click; the rest is called as from the window. Prints
how often a second the colours follow.
"""

import importlib
import sys
import time
from collections.abc import Generator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Vector

sys.path.insert(0, str(Path(__file__).parent))
import window

HEADER = (1077, 316)
"""Where the panel's header is in a window of 1600 × 1000, from its lower left."""
MOVES = 25


def module(name: str) -> Any:
    """A module of Heliform."""
    return importlib.import_module(f"{window.package()}.{name}")


def choose(obj: bpy.types.Object) -> None:
    """Select this object alone."""
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj


def pixel(place: Vector) -> tuple[int, int]:
    """Where a place of the world is in the window."""
    view = window.view()
    region = view["region"]
    found = location_3d_to_region_2d(region, view["area"].spaces.active.region_3d, place)
    return region.x + round(found.x), region.y + round(found.y)


def key(name: str, place: tuple[int, int]) -> Generator[float]:
    """Press and release a key with the mouse at a place."""
    for value in ("PRESS", "RELEASE"):
        window.view()["window"].event_simulate(name, value, x=place[0], y=place[1])
        yield 0.2


def roof() -> bpy.types.Object:
    """The roof, looked up anew: undo makes it another."""
    return bpy.data.objects["Roof"]


def ground() -> bpy.types.Object:
    """The receiver below it."""
    return bpy.data.objects["Receiver"]


def picture() -> np.ndarray:
    """The colours on the receiver."""
    results = module("addon.bridge.results")
    return results.pixels_of(results.find(ground(), results.PICTURE, ""))


def built() -> Generator[float]:
    """A roof over a receiver, seen from above and aside."""
    window.call(bpy.ops.heliform.add_structure, "INVOKE_DEFAULT", preset="roof")
    yield 0.5
    size = roof().dimensions
    window.call(bpy.ops.heliform.add_receiver)
    obj = ground()
    obj.heliform.plane.width, obj.heliform.plane.length = 1.5 * size.x, 1.5 * size.y
    obj.heliform.plane.resolution = 96
    obj.location = (0.0, 0.0, 0.02)
    choose(obj)
    view = window.view()["area"].spaces.active.region_3d
    view.view_rotation = (0.82, 0.42, 0.18, 0.35)
    window.call(bpy.ops.view3d.view_selected)
    yield 1.0
    view.view_distance *= 1.05
    view.view_location += view.view_distance * (view.view_rotation @ Vector((0.1, 0.0, 0.0)))
    panels = window.view()["area"].regions
    sidebar = next(region for region in panels if region.type == "UI")
    assert sidebar.active_panel_category == "Heliform"
    yield 1.0
    window.picture("built")
    yield from window.click(*HEADER)
    yield from window.scroll(60)
    window.picture("panel")


def studied() -> Generator[float]:
    """Study Sun in the background while the window answers."""
    jobs = window.jobs()
    gaps = window.Gaps()
    begun = time.perf_counter()
    window.call(bpy.ops.heliform.study_sun, "INVOKE_DEFAULT")
    while jobs.state.running:
        yield 0.1
    gaps.say("while studying")
    print(f"Study Sun: {time.perf_counter() - begun:.1f} s", flush=True)
    yield 1.0
    assert not jobs.state.message, jobs.state.message
    window.picture("studied")
    layers = module("addon.bridge.layers")
    before = picture()
    bpy.context.scene.heliform.sun_map = "shading"
    yield 0.5
    window.picture("shading")
    assert layers.layer_of(ground()).quantity == "Shading"
    assert np.abs(picture() - before).max() > 0.1
    bpy.context.scene.heliform.sun_map = "total"
    yield 0.5


def followed() -> Generator[float]:
    """Live Sun: a control point is lifted with the mouse, and the colours follow."""
    live, sun = module("addon.live_sun"), module("addon.bridge.sun")
    scene, obj = bpy.context.scene, roof()
    scene.heliform.live_sun = True
    for _ in range(200):
        yield 0.1
        if live._answered:
            break
    assert not live.state.problem, live.state.problem
    window.picture("live")
    obj.heliform.controls = True
    yield 1.0
    handle = module("addon.bridge.handles").handles_of(obj)["net.p22"]
    choose(handle)
    window.call(bpy.ops.ed.undo_push, message="Select")
    yield 1.0
    before = sun.mean_on(ground(), "total")
    told: list[float] = []
    parts: dict[str, list[float]] = {"gather": [], "stage": [], "engine": [], "whole": []}
    true = {"gather": sun.gather, "stage": sun.stage}

    def timed(name: str) -> Any:
        def act(*given, **options):
            begun = time.perf_counter()
            if name == "gather":
                told.append(begun)
            out = true[name](*given, **options)
            parts[name].append(time.perf_counter() - begun)
            if name == "stage":
                parts["engine"].append(given[2].meta["seconds"])
                parts["whole"].append(time.perf_counter() - told[-1])
            return out

        return act

    sun.gather, sun.stage = timed("gather"), timed("stage")
    x, y = pixel(handle.matrix_world.translation)
    target = window.view()["window"]
    target.event_simulate("MOUSEMOVE", "NOTHING", x=x, y=y)
    yield 0.2
    yield from key("G", (x, y))
    yield from key("Z", (x, y))
    begun = time.perf_counter()
    answers = len(parts["whole"])
    for step in range(MOVES):
        target.event_simulate("MOUSEMOVE", "NOTHING", x=x, y=y + 3 * (step + 1))
        yield 0.01
    took = time.perf_counter() - begun
    count = len(parts["whole"]) - answers
    window.picture("dragging")
    print(
        f"live: {count} answers while the point moved, {count / took:.1f} a second with drawing; "
        + ", ".join(f"{n} {1e3 * float(np.median(v)):.0f} ms" for n, v in parts.items() if v),
        flush=True,
    )
    target.event_simulate("LEFTMOUSE", "PRESS", x=x, y=y + 3 * MOVES)
    target.event_simulate("LEFTMOUSE", "RELEASE", x=x, y=y + 3 * MOVES)
    yield 3.0
    sun.gather, sun.stage = true["gather"], true["stage"]
    window.picture("dragged")
    assert count > 3
    assert sun.mean_on(ground(), "total") != before
    obj.heliform.controls = False
    begun, answers = time.perf_counter(), []
    true_stage = sun.stage
    sun.stage = lambda *a, **k: answers.append(time.perf_counter()) or true_stage(*a, **k)
    for step in range(20):
        roof().location.z = 0.5 + 0.5 * np.cos(step / 4)
        yield 0.02
    sun.stage = true_stage
    took = time.perf_counter() - begun
    print(f"live: {len(answers) / took:.1f} a second while the whole roof moves", flush=True)
    roof().location.z = 0.0
    yield 1.0
    window.picture("moved")


def picked() -> Generator[float]:
    """Click a place of the receiver, and look at its hours."""
    jobs, sensor = window.jobs(), module("addon.bridge.sun_sensor")
    bpy.context.scene.heliform.live_sun = False
    corner = ground().matrix_world @ Vector((0.4 * ground().dimensions.x, -6.0, 0.0))
    window.call(bpy.ops.heliform.sun_sensor, "INVOKE_DEFAULT")
    yield from window.press(
        pixel(corner), lambda: jobs.state.running or sensor.picture_of(bpy.context.scene)
    )
    while jobs.state.running:
        yield 0.1
    yield 0.5
    assert not jobs.state.message, jobs.state.message
    image = sensor.picture_of(bpy.context.scene)
    assert image is not None
    image.save(filepath=str(window.folder() / "sensor.png"))
    choose(ground())
    yield 0.5
    window.picture("picked")


def drawn() -> Generator[float]:
    """The sun's path, and a lamp that follows the hour."""
    own = bpy.context.scene.heliform
    own.sun_path = True
    window.call(bpy.ops.heliform.add_sun_lamp)
    window.call(bpy.ops.view3d.view_all)
    yield 1.0
    window.picture("path")
    before = own.sun_lamp.rotation_euler.copy()
    own.sun_hour = 16.5
    own.radiation.site.north = np.radians(30.0)
    yield 1.0
    window.picture("path turned")
    assert own.sun_lamp.rotation_euler != before
    own.radiation.site.north = 0.0


def refused() -> Generator[float]:
    """A weather file that is not there, and a period that holds nothing."""
    jobs, own = window.jobs(), bpy.context.scene.heliform
    own.radiation.weather_file = "/nowhere/Ürümqi.epw"
    yield 0.5
    window.picture("no weather")
    window.call(bpy.ops.heliform.study_sun, "INVOKE_DEFAULT")
    while jobs.state.running:
        yield 0.1
    yield 0.5
    window.picture("refused")
    assert "Ürümqi" in jobs.state.message
    own.radiation.weather_file = ""
    yield 0.2


def reopened() -> Generator[float]:
    """Save, open again, and look at another map."""
    sun = module("addon.bridge.sun")
    file = str(window.folder() / "Sonne ä.blend")
    known = sun.facts_of(bpy.context.scene)
    window.call(bpy.ops.wm.save_as_mainfile, filepath=file)
    yield 0.5
    window.call(bpy.ops.wm.open_mainfile, filepath=file)
    yield 2.0
    assert sun.facts_of(bpy.context.scene) == known
    bpy.context.scene.heliform.sun_map = "sun_hours"
    yield 1.0
    window.picture("reopened")
    assert module("addon.bridge.layers").layer_of(ground()).quantity == "Sun hours"


def daylit() -> Generator[float]:
    """The shipped room with a work plane of its own: its daylight, looked at from outside."""
    jobs, sun = window.jobs(), module("addon.bridge.sun")
    scene = bpy.context.scene
    for obj in list(scene.objects):
        bpy.data.objects.remove(obj)
    scene.heliform.sun_path = False
    file = module("addon.bridge.studies").SHIPPED / "sun-room.toml"
    window.call(bpy.ops.heliform.load_study, filepath=str(file))
    yield 1.0
    receivers = [o for o in bpy.context.scene.objects if o.heliform.role == "RECEIVER"]
    bpy.data.objects.remove(receivers[0])
    choose(bpy.data.objects["floor"])
    window.call(bpy.ops.heliform.add_work_plane)
    plane = bpy.context.object
    assert plane.heliform.role == "RECEIVER"
    bpy.context.scene.heliform.daylight.error = 0.05
    window.call(bpy.ops.view3d.view_all)
    yield 1.0
    window.picture("room")
    window.call(bpy.ops.heliform.study_daylight, "INVOKE_DEFAULT")
    while jobs.state.running:
        yield 0.1
    assert not jobs.state.message, jobs.state.message
    bpy.context.scene.heliform.see_inside = True
    yield 1.0
    window.picture("daylight")
    assert 50 < sun.mean_on(plane, "daylight_autonomy") <= 100
    window.call(bpy.ops.heliform.sun_sensor, "EXEC_DEFAULT")
    yield 1.0
    window.picture("daylight picked")


def steps() -> Generator[float]:
    window.load()
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    yield from window.open_sidebar()
    for stage in (built, studied, followed, picked, drawn, refused, reopened, daylit):
        begun = time.perf_counter()
        yield from stage()
        print(f"{stage.__name__}: {time.perf_counter() - begun:.1f} s", flush=True)


window.play(steps())
