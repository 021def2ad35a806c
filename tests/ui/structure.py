"""Structures in the window: added, dragged, picked, coloured, swung, failed, sized and reopened.

    blender --enable-event-simulate --window-geometry 0 0 1600 1000 \\
        --python tests/ui/structure.py -- DIR

The roof is a click in its menu, a control point is dragged with G and the mouse, and a member is
picked with a click; the rest is called as from the window. Prints how often a second a roof of a
thousand members is laid out, analysed and sized while it is dragged.
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

MENU, ROOF = (1165, 847), (1165, 822)
"""Where the menu and its first entry are in a window of 1600 × 1000, from its lower left."""
DENSE = 1.12
"""Metres between the beams of a roof of about a thousand members."""
MOVES = 40


def module(name: str) -> Any:
    """A module of Heliform."""
    return importlib.import_module(f"{window.package()}.{name}")


def key(name: str, place: tuple[int, int]) -> Generator[float]:
    """Press and release a key with the mouse at a place."""
    for value in ("PRESS", "RELEASE"):
        window.view()["window"].event_simulate(name, value, x=place[0], y=place[1])
        yield 0.2


def look(obj: bpy.types.Object, closer: float = 0.8, up: float = 0.0) -> Generator[float]:
    """Have the object, and nothing else, fill what the sidebar leaves of the view."""
    choose(obj)
    window.call(bpy.ops.view3d.view_selected)
    yield 1.0
    view = window.view()["area"].spaces.active.region_3d
    view.view_distance *= closer
    aside = view.view_rotation @ Vector((0.12, up, 0.0))
    view.view_location = view.view_location + view.view_distance * aside
    yield 0.5


def choose(obj: bpy.types.Object) -> None:
    """Select this object alone."""
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj


def hide(obj: bpy.types.Object) -> None:
    """Hide an object with its handles."""
    for other in (obj, *obj.children):
        other.hide_set(True)


def pixel(place: Vector) -> tuple[int, int]:
    """Where a place of the world is in the window."""
    view = window.view()
    region = view["region"]
    found = location_3d_to_region_2d(region, view["area"].spaces.active.region_3d, place)
    return region.x + round(found.x), region.y + round(found.y)


def settled(obj: bpy.types.Object) -> Generator[float]:
    """Wait until the sizing of the object has gone to its end."""
    for _ in range(100):
        yield 0.2
        if obj["heliform_built"] == module("engines.core.parameters").digest(asked(obj)):
            return
    raise AssertionError("The structure did not settle.")


def asked(obj: bpy.types.Object):
    """The record that the object holds."""
    return module("addon.structures").record_of(obj, bpy.context.scene)


def figures(obj: bpy.types.Object) -> dict[str, float]:
    """The figures of the object's result."""
    told = module("addon.bridge.members").facts_of(obj)["figures"]
    return {name: figure["value"] for name, figure in told.items()}


def places(obj: bpy.types.Object) -> np.ndarray:
    """The vertices of the object (V, 3)."""
    found = np.empty(3 * len(obj.data.vertices), dtype=np.float32)
    obj.data.vertices.foreach_get("co", found)
    return found.reshape(-1, 3)


def roof() -> bpy.types.Object:
    """The roof, looked up anew: undo makes it another."""
    return bpy.data.objects["Roof"]


# What a person does


def added() -> Generator[float]:
    """Choose Roof in the menu."""
    window.picture("empty")
    yield from window.press(MENU, lambda: True)
    window.picture("menu")
    yield from window.press(ROOF, lambda: "Roof" in bpy.data.objects)
    yield from look(roof())
    window.picture("roof")
    assert figures(roof())["failing"] == 0
    assert figures(roof())["converged"] == 1


def coloured() -> Generator[float]:
    """Every map, and the member that uses most."""
    for name in ("stress", "displacement", "material", "height", "class", "utilisation"):
        roof().heliform.member_map = name
        yield 0.5
        window.picture(f"roof {name}")


def seen(obj: bpy.types.Object) -> tuple[tuple[int, int], int]:
    """A place of the window where a member of the object is foremost, and which."""
    scene, view = bpy.context.scene, window.view()
    region = view["region"]
    eye = view["area"].spaces.active.region_3d.view_matrix.inverted().translation
    graph = bpy.context.evaluated_depsgraph_get()
    for polygon in sorted(obj.data.polygons, key=lambda polygon: -polygon.area):
        place = obj.matrix_world @ polygon.center
        hit, _, _, face, _, _ = scene.ray_cast(graph, eye, (place - eye).normalized())
        x, y = pixel(place)
        clear = region.x + 100 < x < region.x + region.width - 420
        if hit and face == polygon.index and clear and region.y + 150 < y < region.y + 700:
            return (x, y), obj.data.attributes["member"].data[face].value
    raise AssertionError("No member is to be seen.")


def picked() -> Generator[float]:
    """Click a member that can be seen."""
    place, wanted = seen(roof())
    window.call(bpy.ops.heliform.pick_member, "INVOKE_DEFAULT")
    yield from window.press(place, lambda: roof().heliform.member == wanted)
    yield 0.5
    window.picture("picked")
    yield from window.scroll(8)
    window.picture("picked checks")
    yield from window.scroll(-60)


def swung() -> Generator[float]:
    """Play the displaced shape, and stop."""
    obj, scene = roof(), bpy.context.scene
    choose(obj)
    window.call(bpy.ops.heliform.animate_displacement)
    window.call(bpy.ops.screen.animation_play)
    yield 2.0
    assert scene.frame_current > 1
    window.call(bpy.ops.screen.animation_cancel, restore_frame=True)
    scene.frame_set(1 + 24)
    yield 0.5
    obj.heliform.member_map = "displacement"
    yield 0.5
    window.picture("displaced")
    obj.heliform.member_map = "utilisation"
    scene.frame_set(1)
    window.call(bpy.ops.heliform.animate_displacement)
    yield 0.3


def dragged() -> Generator[float]:
    """Lift a control point of a roof of a thousand members with the mouse, and take it back."""
    structures = module("addon.structures")
    obj = roof()
    obj.heliform.structure.roof.spacing = DENSE
    obj.heliform.controls = True
    obj.heliform.member = -1
    yield 1.0
    window.call(bpy.ops.ed.undo_push, message="Denser")
    members, before = figures(obj)["members"], places(obj)
    handle = module("addon.bridge.handles").handles_of(obj)["net.p22"]
    choose(handle)
    window.call(bpy.ops.ed.undo_push, message="Select")
    yield 1.0
    window.picture("handle")

    times: list[tuple[float, float]] = []
    true = structures.rebuild

    def timed(*given, **options) -> None:
        begun = time.perf_counter()
        true(*given, **options)
        times.append((begun, time.perf_counter()))

    structures.rebuild = timed
    x, y = pixel(handle.matrix_world.translation)
    target = window.view()["window"]
    target.event_simulate("MOUSEMOVE", "NOTHING", x=x, y=y)
    yield 0.2
    yield from key("G", (x, y))
    yield from key("Z", (x, y))
    for step in range(MOVES):
        target.event_simulate("MOUSEMOVE", "NOTHING", x=x, y=y + 3 * (step + 1))
        yield 0.0
    structures.rebuild = true
    window.picture("dragging")
    target.event_simulate("LEFTMOUSE", "PRESS", x=x, y=y + 3 * MOVES)
    target.event_simulate("LEFTMOUSE", "RELEASE", x=x, y=y + 3 * MOVES)
    yield 0.0
    spans = np.array(times)
    took = np.diff(spans, axis=1)
    print(
        f"drag: {members:.0f} members, {len(times)} updates, {len(times) / np.ptp(spans):.2f} a "
        f"second with drawing; an update {np.median(took):.3f} s, at 95 % "
        f"{np.percentile(took, 95):.3f} s, alone {1 / np.median(took):.2f} a second",
        flush=True,
    )
    assert len(times) > 5
    yield 0.5
    yield from settled(obj)
    window.picture("dragged")
    lifted = places(obj)
    assert handle.location.z > 1.0
    assert obj.heliform.structure.net.p22.z > 0.5
    assert figures(obj)["converged"] == 1
    cold = module("engines.structure.structure").design(
        asked(obj), module("engines.core.scene").Scene()
    )
    warm = structures.sized_of(obj, bpy.context.scene)
    assert np.array_equal(cold.model.frame.nodes, warm.model.frame.nodes)
    change = figures(obj)["mass"] / cold.figures()["mass"]["value"] - 1
    print(f"drag: mass {100 * change:+.1f} % of the one sized cold", flush=True)
    assert np.abs(lifted[: len(before)] - before[: len(lifted)]).max() > 0.5

    window.call(bpy.ops.ed.undo)
    yield 1.0
    yield from settled(roof())
    window.picture("undone")
    shift = roof().heliform.structure.net.p22
    assert abs(shift.z) < 1e-5, shift.z
    back = places(roof())
    assert np.abs(np.ptp(back, axis=0) - np.ptp(before, axis=0)).max() < 0.1


def failed() -> Generator[float]:
    """Thin timber under snow, a wrong number, and the roof as it was."""
    obj = roof()
    obj.heliform.controls = False
    obj.heliform.structure.roof.spacing = 1.5
    yield from look(obj)
    level = obj.heliform.structure.material
    for column in range(3):
        for row in range(3):
            setattr(level, f"c{column}{row}", -1.0)
    yield 2.0
    window.picture("failing")
    assert figures(obj)["failing"] > 0
    obj.heliform.structure.roof.spacing = 1000.0
    yield 1.0
    window.picture("wrong")
    assert obj.heliform.problem
    obj.heliform.structure.roof.spacing = 1.5
    yield 1.0
    assert not obj.heliform.problem
    for row in range(3):
        setattr(level, f"c0{row}", 1.0)
    obj.heliform.levels = True
    obj.heliform.member_map = "material"
    yield 2.0
    window.picture("two materials")
    obj.heliform.levels = False
    for column in range(3):
        for row in range(3):
            setattr(level, f"c{column}{row}", 1.0)
    obj.heliform.member_map = "utilisation"
    yield 0.5


def shell_and_facade() -> Generator[float]:
    """A shell, and a façade whose members turn towards its middle."""
    hide(roof())
    window.call(bpy.ops.heliform.add_structure, "INVOKE_DEFAULT", preset="shell")
    shell = bpy.context.object
    yield from look(shell)
    window.picture("shell")
    hide(shell)
    window.call(bpy.ops.heliform.add_structure, "INVOKE_DEFAULT", preset="facade")
    facade = bpy.context.object
    yield from look(facade, 0.75)
    window.picture("facade")
    facade.heliform.structure.turn.c11 = 1.0
    facade.heliform.structure.turn_limit = np.radians(60.0)
    facade.heliform.turns = True
    yield 2.0
    window.picture("facade turned")
    assert not facade.heliform.problem
    hide(facade)


def sized() -> Generator[float]:
    """Size in the background while the window answers."""
    jobs, obj = window.jobs(), roof()
    obj.hide_set(False)
    obj.heliform.structure.roof.spacing = DENSE
    yield from look(obj)
    gaps = window.Gaps()
    yield 2.0
    idle = gaps.say("idle")
    window.call(bpy.ops.heliform.size_structure, "INVOKE_DEFAULT")
    begun = time.perf_counter()
    yield from window.scroll(60)
    gaps.gaps.clear()
    while jobs.state.running and jobs.state.fraction < 0.2:
        yield 0.1
    busy = gaps.say("while sizing")
    window.picture("sizing")
    gaps.gaps.clear()
    while jobs.state.running:
        yield 0.1
    gaps.say("while its result comes in")
    print(f"Size Members: {time.perf_counter() - begun:.1f} s", flush=True)
    yield 1.0
    window.picture("sized")
    assert not jobs.state.message, jobs.state.message
    assert module("addon.bridge.members").facts_of(obj)["folder"]
    assert busy < idle + 0.3, (idle, busy)


def reopened() -> Generator[float]:
    """Save, open again, and look at another map."""
    file = str(window.folder() / "Dach ä.blend")
    known = figures(roof())
    window.call(bpy.ops.wm.save_as_mainfile, filepath=file)
    yield 0.5
    window.call(bpy.ops.wm.open_mainfile, filepath=file)
    yield 2.0
    assert figures(roof()) == known
    roof().heliform.member_map = "height"
    yield 1.0
    window.picture("reopened")
    roof().heliform.structure.roof.rise = 2.0
    yield 1.0
    assert not roof().heliform.problem
    assert figures(roof())["mass"] != known["mass"]


def steps() -> Generator[float]:
    window.load()
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    yield from window.open_sidebar()
    for stage in (
        *(added, coloured, picked, swung, dragged, failed, shell_and_facade, sized, reopened),
    ):
        begun = time.perf_counter()
        yield from stage()
        print(f"{stage.__name__}: {time.perf_counter() - begun:.1f} s", flush=True)


window.play(steps())
