"""The print gate: each check against its closed form, and against shapely where there is none."""

import json
from dataclasses import replace

import numpy as np
import pytest
import shapely
from glass.paths import LOFTS, THICKNESS, circle, lobed, machine, path_on, polar, roomy, waist
from heliform.engines.glass.gate import gate, gate_loft
from heliform.engines.glass.gcode import gcode, read_gcode
from heliform.engines.glass.machine import load_machine
from heliform.engines.glass.outline import Outline
from heliform.engines.glass.reach import axes_of
from heliform.engines.glass.surface import Loft
from heliform.engines.glass.toolpath import Spiral, spiral
from hypothesis import given, settings
from hypothesis import strategies as st

RISE = 5e-3
PLACED = {"closure", "rising", "travel", "curvature", "rotary_rate", "rotary_acceleration"}
PLACED |= {"acceleration", "speed", "turn_time_min", "turn_time_max", "overhang", "overlap"}
PLACED |= {"room", "reach", "bed", "layer_height", "width", "flow"}


def verdict_on(loft, printer=None, thickness=THICKNESS, **changes):
    printer = printer or roomy()
    return gate(loft, thickness, spiral(loft, thickness, Spiral(**changes), printer), printer)


def named(verdict, name):
    return next(one for one in verdict.checks if one.name == name)


def only_failed(verdict):
    return {one.name for one in verdict.failed}


@pytest.mark.parametrize("name", LOFTS)
def test_a_roomy_machine_prints_anything(name):
    verdict = verdict_on(LOFTS[name])
    assert verdict.passed, [one.sentence for one in verdict.failed]
    assert {one.name for one in verdict.checks} >= PLACED


def test_the_turning_limit_is_speed_over_turning_rate():
    printer = roomy(rotary_rate_max=4.0, speed_min=5.0)
    radius = 5e-3 / np.radians(4.0)
    inside = verdict_on(circle(1.01 * radius), printer)
    assert inside.passed
    beyond = verdict_on(circle(0.99 * radius), printer)
    assert only_failed(beyond) == {"curvature", "rotary_rate"}
    told = named(beyond, "curvature")
    assert told.worst == pytest.approx(0.99 * radius * 1e3, rel=1e-4)
    assert told.limit == pytest.approx(radius * 1e3, rel=1e-6)
    assert told.share == pytest.approx(1 / 0.99, rel=1e-4)
    assert f"is below the {radius * 1e3:.3g} mm that is needed; take a larger" in told.sentence
    assert told.source == "rotary rate max 4 deg/s: assumed for a geared bed; unconfirmed"
    assert not told.confirmed


def test_the_turning_limit_is_speed_squared_over_acceleration_without_a_turning_bed():
    printer = roomy(axes="three", acceleration_max=0.25, speed_min=5.0)
    assert verdict_on(circle(0.101), printer).passed
    beyond = verdict_on(circle(0.099), printer)
    assert only_failed(beyond) == {"curvature", "acceleration"}
    assert named(beyond, "curvature").limit == pytest.approx(100.0)
    assert named(beyond, "curvature").source.startswith("acceleration max 0.25 mm/s²")


def test_a_slower_pace_saves_a_bend_where_flow_or_width_can_follow():
    bent = lobed(waves=5, wave=0.15)
    tightest = 1 / np.abs(bent.at(np.linspace(0, 1, 4096), 0.0).curvature).max()
    limit = np.degrees(5e-3 / tightest) * 0.9
    assert verdict_on(bent, roomy(rotary_rate_max=limit)).passed
    runs = roomy(rotary_rate_max=limit, extrusion="none", width_max=8.5)
    assert only_failed(verdict_on(bent, runs)) == {"curvature", "rotary_rate"}
    wider = roomy(rotary_rate_max=limit, extrusion="none", width_max=9.5)
    found = verdict_on(bent, wider)
    assert found.passed
    assert named(found, "width").worst == pytest.approx(8 / 0.9, rel=1e-3)


def test_a_turn_takes_its_length_over_speed():
    seconds = 2 * np.pi * 0.1 / 5e-3
    for limit, name in ((1.01, "turn_time_min"), (0.99, "turn_time_max")):
        verdict = verdict_on(circle(), roomy(**{name: limit * seconds}))
        assert only_failed(verdict) == {name}
        assert named(verdict, name).worst == pytest.approx(seconds, rel=1e-4)
        assert named(verdict, name).limit == pytest.approx(limit * seconds, rel=1e-9)
        assert verdict_on(circle(), roomy(**{name: seconds / limit})).passed


@pytest.mark.parametrize("scale", [0.7, 1.3])
def test_a_cone_leans_and_overlaps_as_its_slope_says(scale):
    step = 0.1 * abs(scale - 1) / 10
    angle = np.degrees(np.arctan(step / RISE))
    cone = circle(scale=scale)
    verdict = verdict_on(cone, chord=1e-6)
    assert named(verdict, "overhang").worst == pytest.approx(angle, rel=2e-3)
    assert named(verdict, "overlap").worst == pytest.approx(100 * (1 - step / THICKNESS), rel=2e-3)
    assert only_failed(verdict_on(cone, roomy(overhang_max=0.98 * angle))) == {"overhang"}
    assert verdict_on(cone, roomy(overhang_max=1.02 * angle)).passed
    kept = 100 * (1 - step / THICKNESS)
    assert only_failed(verdict_on(cone, roomy(overlap_min=1.02 * kept))) == {"overlap"}
    assert verdict_on(cone, roomy(overlap_min=0.98 * kept)).passed


def test_a_twisted_tube_does_not_lean():
    assert named(verdict_on(circle(twist=2.0)), "overhang").worst < 0.5


def bump(radius):
    """A tube with a nose of that tightest radius of bend, roughly."""
    width = 0.25
    tall = (width * 0.1) ** 2 / radius * 0.9

    def curve(theta):
        away = np.angle(np.exp(1j * (theta - 1)))
        return 0.1 + tall * np.exp(-((away / width) ** 2) / 2)

    return polar(curve)


def lost(loft, width):
    """The share of its width times length that a wall loses by lying over itself [shapely]."""
    ring = shapely.linearrings(loft.at(np.arange(8192) / 8192, 0.0).points[:, :2])
    covered = shapely.area(shapely.buffer(ring, width / 2, quad_segs=64))
    return 1 - covered / (width * shapely.length(ring))


@pytest.mark.parametrize(
    "loft", [*(waist(g * 1e-3) for g in (4, 7, 7.8, 8.3, 12)), *(bump(r * 1e-3) for r in (2, 3, 8))]
)
def test_a_wall_that_meets_itself_is_found_as_shapely_finds_it(loft):
    shortfall = lost(loft, THICKNESS)
    room = named(verdict_on(loft), "room")
    assert room.passed == (shortfall < 2e-4), (shortfall, room.share)
    if not room.passed:
        assert room.limit == pytest.approx(4.0)
        assert "is below the 4 mm" in room.sentence


def test_the_place_of_a_waist_is_said():
    room = named(verdict_on(waist(5e-3)), "room")
    assert room.point is not None
    assert abs(room.point[0]) < 20e-3
    assert abs(room.point[1]) == pytest.approx(2.5e-3, abs=1e-3)


def test_a_curve_that_crosses_itself_is_found():
    loft = polar(lambda t: 0.03 + 0.06 * np.cos(t))
    assert not named(verdict_on(loft), "room").passed


@pytest.mark.parametrize(("shift", "meets"), [(3e-3, True), (0.5e-3, False)])
def test_a_turn_that_comes_down_on_another_part_of_the_one_below_is_found(shift, meets):
    """A waist of 9 mm that leans across itself: each layer has room, but not above the other."""
    low = waist(9e-3).outlines[0]
    high = Outline(low.points + np.array([0.0, 9 * shift]))
    loft = Loft((low, high), np.array([0.0, 1.0]), 9 * RISE)
    assert only_failed(verdict_on(loft)) == ({"room_between"} if meets else set())
    if meets:
        told = named(verdict_on(loft), "room_between")
        assert told.worst == pytest.approx(3.0, rel=0.02)
        assert told.point is not None
        assert abs(told.point[0]) < 0.03


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_the_nozzle_has_to_reach_every_point(axis):
    loft = Loft((lobed(waves=2, wave=0.2).outlines), np.zeros(1), 0.05)
    printer = roomy(axes="three", **{f"reach_{axis}": 100.0 if axis != "z" else 49.0})
    verdict = verdict_on(loft, printer)
    assert only_failed(verdict) == {"reach"}
    reach = {"x": 120.0, "y": 80.0, "z": 60.0}[axis]  # a centimetre clear of the piece
    assert named(verdict, "reach").worst == pytest.approx(reach, rel=1e-2)
    assert f"reach {axis}" in named(verdict, "reach").source


@pytest.mark.parametrize("axes", ["three", "four"])
def test_the_nozzle_has_to_reach_the_purge(axes):
    """A tube of 100 mm and a purge of 30 mm outside: to the right, or for the bed's axes below."""
    side = "x" if axes == "three" else "y"
    path = spiral(circle(), THICKNESS, Spiral(), roomy(axes=axes))
    for way, fits in ((259.0, False), (261.0, True)):
        printer = roomy(axes=axes, **{f"reach_{side}": way})
        verdict = gate(circle(), THICKNESS, path, printer, 0.03)
        assert only_failed(verdict) == (set() if fits else {"reach"})
        assert named(verdict, "reach").worst == pytest.approx(130.0, rel=1e-3)
        assert gate(circle(), THICKNESS, path, printer).passed
        unpurged = replace(printer, dialect=replace(printer.dialect, purge=()))
        assert gate(circle(), THICKNESS, path, unpurged, 0.03).passed


def test_the_nozzle_has_to_rise_clear_of_the_piece_where_the_machine_is_told_to():
    verdict = verdict_on(circle(), roomy(reach_z=59.0))
    told = named(verdict, "reach").sentence
    assert told.startswith("Height of the nozzle 60 mm at turn 11.0, z 50 mm, is above the 59 mm")
    assert verdict_on(circle(), roomy(reach_z=61.0)).passed
    assert verdict_on(circle(), roomy(reach_z=51.0, start=[], end=[])).passed


@pytest.mark.parametrize("radius", [0.05, 0.08])
def test_what_the_gate_says_of_reach_is_where_the_gcode_goes(radius):
    loft, printer = lobed(radius), machine("desktop-printer")
    path = spiral(loft, THICKNESS, Spiral(), printer)
    axes = read_gcode(gcode(path, printer, 0.03)).axes[1:]  # without homing
    furthest = (np.abs(axes[:, :2] - 110).max(), axes[:, 2].max())
    reach = named(gate(loft, THICKNESS, path, printer, 0.03), "reach")
    share = max(furthest[0] / 110, furthest[1] / 240)
    assert reach.share == pytest.approx(share, rel=1e-4)


def test_a_lower_limit_is_told_as_one():
    passed = named(verdict_on(circle(), roomy(turn_time_min=100.0)), "turn_time_min").sentence
    assert passed.startswith("Time for a turn 126 s at turn")
    assert passed.endswith(", at least 100 s is needed.")
    failed = named(verdict_on(circle(), roomy(turn_time_min=150.0)), "turn_time_min").sentence
    assert "is below the 150 s that is needed; take a longer" in failed
    upper = named(verdict_on(circle()), "mass").sentence
    assert upper.endswith("within the 1000 kg that is allowed.")


def test_the_share_is_of_the_way_to_the_limit():
    middle = named(verdict_on(circle(), roomy(width_min=6.0, width_max=10.0)), "width")
    assert middle.share == pytest.approx(0.0, abs=1e-3)
    near = named(verdict_on(circle(), roomy(width_min=7.0, width_max=13.0)), "width")
    assert near.share == pytest.approx(2 / 3, rel=1e-3)
    turn = named(verdict_on(circle(), roomy(turn_time_min=100.0)), "turn_time_min")
    assert turn.share == pytest.approx(100 / turn.worst)
    room = named(verdict_on(circle()), "room")
    assert room.share == pytest.approx(4 / 100, rel=1e-2)


def test_a_bed_that_turns_keeps_the_path_to_one_direction():
    path = path_on(LOFTS["blended"])
    printer = roomy()
    turned = np.exp(-1j * path.rotary)
    x, y = path.points[:, :2].T
    assert axes_of(path, printer) == pytest.approx(
        np.column_stack([((x + 1j * y) * turned).real, ((x + 1j * y) * turned).imag])
    )
    heading = np.diff(x + 1j * y) / np.diff(path.arc)
    assert np.angle(heading * np.exp(-0.5j * (path.rotary[1:] + path.rotary[:-1]))) == (
        pytest.approx(0.0, abs=0.02)
    )
    round_path = path_on(circle())
    axes = axes_of(round_path, printer)
    assert axes[:, 0] == pytest.approx(0.0, abs=1e-9)
    assert axes[:, 1] == pytest.approx(-0.1)


def test_the_wall_has_to_stand_on_the_bed_with_all_its_width():
    verdict = verdict_on(circle(), roomy(bed_y=2 * 103.9))
    assert only_failed(verdict) == {"bed"}
    assert named(verdict, "bed").worst == pytest.approx(104, rel=1e-4)
    assert verdict_on(circle(), roomy(bed_y=2 * 104.1)).passed


def test_layer_height_width_flow_and_speed_have_ranges():
    assert only_failed(verdict_on(circle(), roomy(layer_height_max=4.9))) == {"layer_height"}
    assert only_failed(verdict_on(circle(), roomy(layer_height_min=5.1))) == {"layer_height"}
    assert only_failed(verdict_on(circle(), roomy(width_max=7.9))) == {"width"}
    assert only_failed(verdict_on(circle(), roomy(width_min=8.1))) == {"width"}
    slow = verdict_on(circle(), roomy(flow_min=150.0), pace="speed", speed=3e-3)
    assert only_failed(slow) == {"flow"}
    assert named(slow, "flow").worst == pytest.approx(120)
    assert "is below the 150 mm³/s that is needed" in named(slow, "flow").sentence


def test_mass_and_time_are_those_of_the_wall():
    volume = THICKNESS * 0.05 * 2 * np.pi * 0.1
    mass, seconds = 2500 * volume, 11 * 2 * np.pi * 0.1 / 5e-3
    verdict = verdict_on(circle())
    assert verdict.figures["mass"]["value"] == pytest.approx(mass, rel=1e-4)
    assert verdict.figures["time"]["value"] == pytest.approx(seconds, rel=1e-3)
    assert verdict.figures["turns"]["value"] == 11
    assert verdict.figures["surplus"]["value"] < 1e-4 * volume
    assert only_failed(verdict_on(circle(), roomy(charge=0.99 * mass))) == {"mass"}
    assert only_failed(verdict_on(circle(), roomy(time_max=0.99 * seconds / 3600))) == {"time"}


def broken(change):
    path = path_on(circle())
    points = path.points.copy()
    change(points)
    arc = np.concatenate([[0.0], np.cumsum(np.sqrt((np.diff(points, axis=0) ** 2).sum(axis=1)))])
    path = replace(path, points=points, arc=arc)
    return only_failed(gate(circle(), THICKNESS, path, roomy()))


def test_a_path_that_is_broken_is_found():
    def opened(points):
        points[0, 0] += 1e-4

    def lowered(points):
        points[2000:, 2] -= 1e-4

    def jumped(points):
        points[2000:2010, 0] += 0.01

    assert broken(opened) == {"closure"}
    assert broken(lowered) == {"rising"}
    assert "travel" in broken(jumped)


@settings(max_examples=15, deadline=None)
@given(
    waves=st.integers(2, 8),
    wave=st.floats(0, 0.3),
    radius=st.floats(0.03, 0.2),
    layers=st.integers(1, 12),
    twist=st.sampled_from([0.0, 0.0, 0.3]),
    profile=st.sampled_from(["glass-printer", "roomy"]),
)
def test_the_quick_gate_says_what_the_full_one_says(waves, wave, radius, layers, twist, profile):
    printer = load_machine() if profile == "glass-printer" else roomy(rotary_rate_max=10.0)
    loft = lobed(radius, layers * RISE, waves, wave, twist=twist)
    path = spiral(loft, THICKNESS, Spiral(), printer)
    full, quick = (
        gate(loft, THICKNESS, path, printer, Spiral().purge),
        gate_loft(loft, THICKNESS, Spiral(), printer),
    )
    assert full.inputs == quick.inputs
    assert [one.name for one in full.checks] == [one.name for one in quick.checks]
    for slow, fast in zip(full.checks, quick.checks, strict=True):
        assert slow.passed == fast.passed, slow.sentence
        assert fast.share == pytest.approx(slow.share, rel=1e-5, abs=1e-9)
        assert fast.worst == pytest.approx(slow.worst, rel=1e-5, abs=1e-9)
        assert fast.limit == pytest.approx(slow.limit, rel=1e-5)
        assert fast.utilisation is None
        if slow.utilisation is not None and not slow.name.startswith("room"):
            there = np.argmin(np.abs(path.turn - fast.turn))
            assert slow.utilisation[there] == pytest.approx(slow.share, rel=1e-4, abs=1e-9)
            assert fast.point == pytest.approx(path.points[there], abs=1e-9)
    for name, entry in full.figures.items():
        there = quick.figures[name]["value"]
        assert there == pytest.approx(entry["value"], rel=1e-6, abs=1e-12)


def test_the_map_is_the_share_at_every_point_and_its_top_the_worst():
    path = path_on(LOFTS["twisted"])
    verdict = gate(LOFTS["twisted"], THICKNESS, path, roomy())
    for one in verdict.checks:
        if one.utilisation is not None:
            assert one.utilisation.shape == path.turn.shape
            assert np.isfinite(one.utilisation).all()
            assert one.utilisation.max() == pytest.approx(one.share, rel=0.02, abs=1e-3)
    assert verdict.utilisation() == pytest.approx(
        np.max([one.utilisation for one in verdict.checks if one.utilisation is not None], axis=0)
    )
    assert verdict.worst.share == max(one.share for one in verdict.checks if one.point)


def test_the_verdict_as_json_says_where_why_and_from_where():
    verdict = verdict_on(lobed(0.05, 0.05, 8, 0.15), machine())
    told = json.loads(verdict.as_json())
    assert told["passed"] is False
    assert told["machine"] == "Glass printer"
    assert told["inputs"] == verdict.inputs
    assert told["heliform"]
    failed = [one for one in told["checks"] if not one["passed"]]
    assert failed
    for one in failed:
        assert one["source"]
        assert isinstance(one["confirmed"], bool)
        assert ";" in one["sentence"]
        assert one["sentence"].endswith(".")
    bend = next(one for one in failed if one["name"] == "curvature")
    assert len(bend["point"]) == 3
    assert bend["worst"] < bend["limit"]
    assert bend["unit"] == "mm"
