"""Machine profiles: what is shipped, what may stand in one, and what is said of what may not."""

import numpy as np
import pytest
from glass.paths import machine, table
from heliform.engines.core.errors import FileError, ParameterError
from heliform.engines.glass.figures import FIGURES
from heliform.engines.glass.machine import (
    PLACEHOLDERS,
    PROFILES,
    filled,
    load_machine,
    machine_of,
)


@pytest.mark.parametrize("profile", PROFILES)
def test_a_shipped_profile_loads_and_says_where_every_figure_is_from(profile):
    found = load_machine(profile)
    assert found.name
    for figure in found.figures.values():
        assert figure.source
        assert figure.confirmed or figure.said.endswith("unconfirmed")


def test_without_a_name_it_is_the_glass_printer_with_the_published_build_volume():
    found = load_machine()
    assert load_machine("") == found == load_machine(PROFILES[0])
    volume = [found.value(f"reach_{axis}") for axis in "xyz"]
    assert volume == pytest.approx([0.325, 0.325, 0.380])
    assert "Massimino 2024" in found.figures["reach_z"].said
    assert "unconfirmed" not in found.figures["reach_z"].said


@pytest.mark.parametrize(
    ("name", "value", "unit", "truth"),
    [
        ("speed_max", 600, "mm/min", 0.01),
        ("speed_max", 0.6, "m/min", 0.01),
        ("rotary_rate_max", 30, "rpm", np.pi),
        ("rotary_rate_max", 180, "deg/s", np.pi),
        ("width_max", 1, "in", 0.0254),
        ("turn_time_max", 2, "min", 120),
        ("flow", 12, "cm³/min", 200e-9),
        ("density", 2.5, "g/cm3", 2500),
        ("overlap_min", 60, "%", 0.6),
        ("overlap_min", 0.6, "", 0.6),
        ("origin_x", -20, "mm", -0.02),
    ],
)
def test_units_are_taken_to_si(name, value, unit, truth):
    given = table()
    given["figures"][name] |= {"value": value, "unit": unit}
    assert machine_of(given, "test").value(name) == pytest.approx(truth)


def figure(name, **changes):
    def change(given):
        given["figures"][name] |= changes

    return change


def without(*keys):
    def change(given):
        for key in keys[:-1]:
            given = given[key]
        del given[keys[-1]]

    return change


def put(*keys):
    def change(given):
        for key in keys[:-2]:
            given = given[key]
        given[keys[-2]] = keys[-1]

    return change


BAD = {
    "unknown figure": (put("figures", "layer_hight_min", {}), "did you mean “layer_height_min”"),
    "unknown key": (put("axis", 3), "did you mean “axes”"),
    "unknown unit": (figure("width_max", unit="furlong"), "no unit of length"),
    "unit of another kind": (figure("width_max", unit="s"), "no unit of length"),
    "missing figure": (without("figures", "flow"), "has no flow; add"),
    "missing rotary": (without("figures", "rotary_rate_max"), "has no rotary_rate_max"),
    "missing source": (without("figures", "flow", "source"), "has no source"),
    "negative": (figure("width_max", value=-1.0), "is negative"),
    "zero": (figure("flow_max", value=0), "above zero"),
    "text": (figure("width_max", value="8"), "should be a number"),
    "flag": (figure("width_max", value=True), "should be a number"),
    "infinite": (figure("width_max", value=float("inf")), "should be a number"),
    "not a number": (figure("width_max", value=float("nan")), "should be a number"),
    "confirmed by text": (figure("width_max", confirmed="yes"), "true or false"),
    "no figures": (without("figures"), "figures should be a table"),
    "figure is no table": (put("figures", "flow", 200), "should be a table"),
    "upside down": (figure("width_min", value=11.0), "is above width_max"),
    "flow outside": (figure("flow", value=500.0), "not between"),
    "overhang": (figure("overhang_max", value=120.0), "below 90"),
    "overlap": (figure("overlap_min", value=160.0), "at most 1"),
    "axes": (put("axes", "five"), "take one of three, four"),
    "extrusion": (put("extrusion", "absolute"), "take one of relative"),
    "no name": (without("name"), "has no name"),
    "filament": (put("extrusion", "relative"), "has no filament_diameter"),
    "lines are no list": (put("gcode", "start", "G28"), "list of lines"),
    "two lines in one": (put("gcode", "start", ["G28\nG29"]), "one line"),
    "unknown placeholder": (put("gcode", "start", ["G0 X{where}"]), "names what there is not"),
    "attribute": (put("gcode", "start", ["{x.__class__}"]), "names what there is not"),
    "conversion": (put("gcode", "start", ["{x!r}"]), "names what there is not"),
    "format": (put("gcode", "start", ["{x:>9999999999}"]), "names what there is not"),
    "open brace": (put("gcode", "end", ["G0 {x"]), "names what there is not"),
}


@pytest.mark.parametrize("case", BAD)
def test_a_wrong_profile_is_told_in_one_sentence(case):
    change, said = BAD[case]
    given = table()
    change(given)
    with pytest.raises(ParameterError, match=said) as told:
        machine_of(given, "shop.toml")
    assert "shop.toml" in str(told.value)
    assert "\n" not in str(told.value)


def test_figures_that_a_machine_has_no_use_for_may_be_left_out():
    plain = machine("desktop-printer")
    assert plain.axes == "three"
    assert (
        not FIGURES.keys() - plain.figures.keys() - {"rotary_rate_max", "rotary_acceleration_max"}
    )


def test_a_file_that_is_no_profile_is_told_in_one_sentence(tmp_path):
    with pytest.raises(FileError, match="no machine profile"):
        load_machine(tmp_path / "none.toml")
    file = tmp_path / "ä shop.toml"
    file.write_text("axes = ")
    with pytest.raises(FileError, match="not valid TOML"):
        load_machine(file)
    file.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileError, match="not valid TOML"):
        load_machine(file)
    file.write_bytes(b"")
    with pytest.raises(ParameterError, match="axes"):
        load_machine(file)
    file.write_bytes(b"#" * 1_000_001)
    with pytest.raises(FileError, match="larger than a megabyte"):
        load_machine(file)
    file.write_text("a = " + "[" * 100_000)
    with pytest.raises(FileError, match="not valid TOML"):
        load_machine(file)
    with pytest.raises(FileError, match="cannot be read"):
        load_machine(tmp_path)


def test_the_digest_follows_figures_and_lines_but_not_what_is_said_of_them():
    one = machine()
    assert machine(name="Another").digest == one.digest
    assert machine(width_max=11.0).digest != one.digest
    assert machine(end=["M2"]).digest != one.digest


def test_placeholders_are_filled_in_and_nothing_else():
    values = {name: name.upper() for name in PLACEHOLDERS}
    assert filled(("G0 X{x} Y{y}", "M117 {{{name}}}"), values) == ["G0 XX YY", "M117 {NAME}"]
