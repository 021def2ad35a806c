"""The flow coupon: its shape, its bands, and what a calliper should find."""

import numpy as np
import pytest
from glass.paths import machine
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.table import load_csv
from heliform.engines.glass.coupon import Coupon, coupon
from heliform.engines.glass.gate import gate
from heliform.engines.glass.gcode import read_gcode
from heliform.engines.glass.machine import load_machine

SMALL = Coupon(straight=0.03, radius=0.01, width=8e-4, layer_height=4e-4)


def test_it_is_a_stadium_that_the_glass_printer_can_lay():
    made = coupon(Coupon(), load_machine())
    assert made.loft.length(0.0) == pytest.approx(2 * 0.1 + 2 * np.pi * 0.04, rel=1e-4)
    points = made.loft.at(np.linspace(0, 1, 4001), 0.0).points[:, :2]
    assert np.ptp(points, axis=0) == pytest.approx([0.18, 0.08], rel=1e-3)
    sides = np.abs(points[:, 0]) < 0.049
    assert np.abs(points[sides, 1]) == pytest.approx(0.04, abs=1e-6)
    verdict = gate(made.loft, 9e-3, made.path, load_machine())
    assert verdict.passed, [one.sentence for one in verdict.failed]


@pytest.mark.parametrize(
    ("record", "printer"),
    [
        (Coupon(), load_machine()),
        (Coupon(), machine(extrusion="volumetric")),
        (SMALL, machine("desktop-printer")),
    ],
)
def test_each_band_has_the_width_and_speed_of_its_row(record, printer):
    made = coupon(record, printer)
    path, bands = made.path, made.bands
    assert path.turns == record.bands * record.turns + 1
    for row in range(record.bands):
        low, high = row * record.turns + 0.05, (row + 1) * record.turns - 0.05
        inside = (path.turn > low) & (path.turn < high) & path.full
        assert path.speed[inside] * 1e3 == pytest.approx(bands["Speed (mm/s)"][row], rel=0.02)
        assert path.width[inside] * 1e3 == pytest.approx(
            bands["Expected width (mm)"][row], rel=0.02
        )
    product = bands["Speed (mm/s)"] * bands["Layer height (mm)"] * bands["Expected width (mm)"]
    assert product == pytest.approx(bands["Flow (mm³/s)"])
    assert bands["From z (mm)"][1:] == pytest.approx(bands["To z (mm)"][:-1])
    assert path.points[-1, 2] * 1e3 == pytest.approx(bands["To z (mm)"][-1])
    middle = record.bands // 2
    assert bands["Expected width (mm)"][middle] == pytest.approx(record.width * 1e3)


def test_the_table_has_the_speed_that_the_path_really_has():
    """Held back in its bends, the path gets up to less than was asked for on the straight sides."""
    printer = machine(extrusion="volumetric", rotary_rate_max=5.0, acceleration_max=0.05)
    record = Coupon()
    made = coupon(record, printer)
    path = made.path
    sides = np.abs(path.points[:, 0]) < record.straight / 2 - 2e-3
    for row in range(record.bands):
        low, high = row * record.turns, (row + 1) * record.turns
        there = path.speed[sides & path.full & (path.turn >= low) & (path.turn < high)] * 1e3
        said = made.bands["Speed (mm/s)"][row]
        assert said == pytest.approx(there.mean(), rel=0.03)
    asked = printer.value("flow") / (record.width * (1 - record.spread) * record.layer_height)
    assert made.bands["Speed (mm/s)"][0] < 0.97 * asked * 1e3


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"reach_z": 84.0}, "Height of the nozzle 85 mm"),
        ({"reach_y": 60.0}, "Way of the nozzle"),
        ({"bed_x": 187.0}, "Outer side"),
    ],
)
def test_a_coupon_beyond_the_machine_is_refused_in_one_sentence(changes, said):
    with pytest.raises(ParameterError, match=said):
        coupon(Coupon(), machine(**changes))


def test_it_is_saved_as_gcode_and_table(tmp_path):
    made = coupon(Coupon(), load_machine())
    assert made.save(tmp_path, load_machine()) == ["coupon.gcode", "coupon.csv"]
    motion = read_gcode((tmp_path / "coupon.gcode").read_text())
    assert np.abs(motion.points(load_machine()) - made.path.points).max() < 1e-6
    columns, meta = load_csv(tmp_path / "coupon.csv")
    assert columns["Band"].tolist() == [1, 2, 3, 4, 5]
    assert meta["machine"] == "Glass printer"


@pytest.mark.parametrize(
    ("changes", "said"),
    [({"width": 0.03}, "ask for"), ({"spread": 0.79}, "ask for"), ({"bands": 1}, "out of bounds")],
)
def test_what_the_machine_cannot_do_is_told_in_one_sentence(changes, said):
    with pytest.raises(ParameterError, match=said):
        coupon(Coupon(**changes), load_machine())
