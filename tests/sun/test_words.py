"""Studies of sun and sky in words."""

import math

import pytest
from heliform.engines.core.parameters import to_table
from heliform.engines.sun.site import Site
from heliform.engines.sun.words import (
    facts_of,
    figure_text,
    figure_title,
    figure_words,
    matters,
    number_text,
    share_text,
)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("mean_total", ("", "Irradiation")),
        ("max_shading", ("", "Shading, greatest")),
        ("sda_300_50_without_blinds", ("LM-83", "sDA 300/50, no blinds")),
        ("en17037_target_300", ("EN 17037", "Target 300 lx")),
        ("en17037_sunlight_level", ("EN 17037", "Sunlight level")),
        ("error_daylight_factor", ("Error (95 %)", "Daylight factor")),
        ("given_up", ("", "After last bounce")),
        ("something_new", ("", "Something new")),
    ],
)
def test_a_figure_has_its_words(name, words):
    assert figure_words(name) == words
    assert figure_title(name) == ": ".join(filter(None, words))


def test_a_receivers_figure_has_its_name_before():
    assert figure_title("Floor.001.mean_total") == "Floor.001: Irradiation"
    assert figure_title("sda_333.5_50") == "LM-83: sDA 333.5/50"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.179, "0.179"),
        (0.0000123, "0"),
        (117.4, "117"),
        (999.7, "1000"),
        (1652.4, "1652"),
        (51440.0, "51\u2009400"),
        (-12345.0, "-12\u2009300"),
        (math.nan, "–"),
    ],
)
def test_a_number_reads_without_exponent(value, text):
    assert number_text(value) == text


def test_a_level_has_its_name_and_what_is_unknown_a_dash():
    assert figure_text("en17037_level", {"value": 2, "unit": ""}) == "medium"
    assert figure_text("ase_1000_250", {"value": 49.2, "unit": "%"}) == "49.2 %"
    assert figure_text("mean_shading", {"value": math.nan, "unit": "%"}) == "–"


def test_where_and_when_is_said():
    site = Site(latitude=-33.95, longitude=151.18, elevation=6.0, utc_offset=9.5, north=-20.0)
    facts = facts_of({"site": to_table(site), "source": "Sydney", "period": "year"})
    assert facts["Place"] == "33.95° S, 151.18° E"
    assert facts["Clock"].startswith("UTC+9:30")
    assert facts["+Y axis"] == "340°, clockwise from north"
    assert facts["Weather"] == "Sydney"


@pytest.mark.parametrize(
    ("share", "text"),
    [(0.0374, "3.7 %"), (0.2, "20 %"), (1.234, "120 %"), (0.0004, "0.04 %"), (0.0, "0 %")],
)
def test_a_share_has_two_digits_and_no_exponent(share, text):
    assert share_text(share) == text


@pytest.mark.parametrize(
    "note",
    [
        "“House” is closed and looks inward, so it is measured on its inner side.",
        "“House”: 3 edges have faces that look opposite ways, so part of it is measured on its "
        "wrong side.",
        "No floor lies below “Desk”: light of the open ground comes up through it.",
    ],
)
def test_what_a_receiver_measures_amiss_matters(note):
    assert matters(note)
