"""Combinations of actions against EN 1990, by its equations and by hand."""

from dataclasses import replace

import numpy as np
import pytest
from heliform.engines.core.errors import ParameterError
from heliform.engines.core.parameters import from_table, to_table
from heliform.engines.structure.combinations import CombinationRules, combinations_of
from heliform.engines.structure.loads import Loads

EUROCODE = CombinationRules(rule="eurocode")


def loads_of(**cases):
    """Load cases of no frame in particular: name → action, underscores for spaces."""
    count = len(cases)
    return Loads(
        tuple(name.replace("_", " ") for name in cases),
        tuple(cases.values()),
        np.zeros((count, 3)),
        np.zeros((count, 1, 6)),
        np.zeros((count, 1, 2, 3)),
    )


ROOF = loads_of(self_weight="permanent", roof_load="imposed", wind_x="wind")
TOWER = loads_of(
    self_weight="permanent",
    floors="imposed",
    wind_east="wind",
    wind_west="wind",
    wind_north="wind",
    wind_south="wind",
)


def rows(combinations, **wanted):
    kept = np.ones(len(combinations), bool)
    for name, value in wanted.items():
        kept &= getattr(combinations, name) == value
    return {tuple(np.round(row, 6)) for row in combinations.factors[kept]}


def test_the_thesis_sums_all_actions_once_for_each_wind():
    found = combinations_of(TOWER, CombinationRules())
    one_wind = {(1, 1, *row) for row in np.eye(4).astype(int).tolist()}
    both = {(1, 0, 0, 0, 0, 0), (1, 1, 0, 0, 0, 0)}
    expected = both | {tuple(row) for row in one_wind}
    assert rows(found, limit="ultimate") == rows(found, limit="service") == expected
    assert len(found) == 2 * len(expected)
    assert found.names[:3] == (
        "self weight",
        "self weight + floors",
        "self weight + floors + wind east",
    )


def test_the_thesis_roof_has_one_combination_for_its_load_and_one_for_its_weight():
    found = combinations_of(loads_of(weight="permanent", area="imposed"), CombinationRules())
    assert rows(found, limit="ultimate") == {(1, 0), (1, 1)}


def test_equation_6_10_for_a_roof_by_hand():
    found = combinations_of(ROOF, EUROCODE)
    assert rows(found, limit="ultimate") == {
        (1.35, 0, 0),
        *((g, 1.5, 0) for g in (1.35, 1.0)),
        *((g, 0, 1.5) for g in (1.35, 1.0)),
        # A roof's load has ψ0 = 0, so that beside a leading wind it is not there.
        *((g, 1.5, 0.9) for g in (1.35, 1.0)),
    }
    assert "1.35 self weight + 1.5 roof load + 0.9 wind x" in found.names
    assert "self weight + 1.5 wind x" in found.names


def test_each_variable_action_of_an_office_under_snow_and_wind_leads_in_turn():
    loads = loads_of(g="permanent", q="imposed", s="snow", w="wind")
    found = rows(combinations_of(loads, replace(EUROCODE, imposed="office")), limit="ultimate")
    together = {row for row in found if row[0] == 1.35 and all(row)}
    assert together == {
        (1.35, 1.5, 0.75, 0.9),
        (1.35, 1.05, 1.5, 0.9),
        (1.35, 1.05, 0.75, 1.5),
    }
    high = rows(combinations_of(loads, replace(EUROCODE, snow="above 1000 m")), limit="ultimate")
    assert (1.35, 1.5, 1.05, 0.9) in high


def test_service_combinations_follow_6_14b_6_15b_and_6_16b():
    loads = loads_of(g="permanent", q="imposed", w="wind")
    found = combinations_of(loads, replace(EUROCODE, imposed="shop"))
    assert rows(found, kind="characteristic") == {
        (1, 0, 0),
        (1, 1, 0),
        (1, 0, 1),
        (1, 1, 0.6),
        (1, 0.7, 1),
    }
    assert rows(found, kind="frequent") == {
        (1, 0, 0),
        (1, 0.7, 0),
        (1, 0, 0.2),
        (1, 0.6, 0.2),
    }
    assert rows(found, kind="quasi-permanent") == {(1, 0, 0), (1, 0.6, 0)}
    assert (found.limit[found.kind != "fundamental"] == "service").all()


@pytest.mark.parametrize(
    ("category", "psi"),
    [
        ("dwelling", (0.7, 0.5, 0.3)),
        ("office", (0.7, 0.5, 0.3)),
        ("assembly", (0.7, 0.7, 0.6)),
        ("shop", (0.7, 0.7, 0.6)),
        ("storage", (1.0, 0.9, 0.8)),
        ("light traffic", (0.7, 0.7, 0.6)),
        ("traffic", (0.7, 0.5, 0.3)),
        ("roof", (0.0, 0.0, 0.0)),
    ],
)
def test_psi_of_imposed_loads_are_those_of_table_a1_1(category, psi):
    loads = loads_of(q="imposed", w="wind")
    found = combinations_of(loads, replace(EUROCODE, imposed=category))
    led_by_wind = [row for row in rows(found, kind="characteristic") if row[1] == 1]
    assert max(led_by_wind)[0] == psi[0]
    frequent = [row[0] for row in rows(found, kind="frequent")]
    assert max(frequent) == psi[1]
    assert max((row[0] for row in rows(found, kind="quasi-permanent")), default=0) == psi[2]


@pytest.mark.parametrize(
    ("site", "psi", "duration"),
    [("below 1000 m", (0.5, 0.2, 0.0), "short"), ("above 1000 m", (0.7, 0.5, 0.2), "medium")],
)
def test_psi_of_snow_are_those_of_table_a1_1(site, psi, duration):
    found = combinations_of(loads_of(s="snow", w="wind"), replace(EUROCODE, snow=site))
    led_by_wind = [row for row in rows(found, kind="characteristic") if row[1] == 1]
    assert max(led_by_wind)[0] == psi[0]
    assert max(row[0] for row in rows(found, kind="frequent")) == psi[1]
    assert max((row[0] for row in rows(found, kind="quasi-permanent")), default=0) == psi[2]
    alone = found.factors[:, 1] == 0
    assert set(found.duration[alone]) == {duration}


def test_directions_of_wind_never_act_together_and_neither_do_cases_of_snow():
    loads = loads_of(g="permanent", a="snow", b="snow", c="snow", x="wind", y="wind")
    for rules in (CombinationRules(), EUROCODE):
        factors = combinations_of(loads, rules).factors
        assert ((factors[:, 1:4] > 0).sum(axis=1) <= 1).all()
        assert ((factors[:, 4:] > 0).sum(axis=1) <= 1).all()
        assert (factors > 0).any(axis=0).all()


def test_no_combination_comes_twice_and_none_is_empty():
    for loads in (ROOF, TOWER, loads_of(wind="wind"), loads_of(g="permanent")):
        found = combinations_of(loads, EUROCODE)
        keys = set(zip(found.kind, found.names, strict=True))
        assert len(keys) == len(found)
        assert found.factors.any(axis=1).all()


def test_the_duration_is_that_of_the_shortest_action():
    loads = loads_of(weight="permanent", goods="imposed", snow="snow", wind="wind")
    rules = replace(EUROCODE, imposed="storage", snow="above 1000 m", wind_duration="instantaneous")
    found = combinations_of(loads, rules)
    for factors, duration in zip(found.factors, found.duration, strict=True):
        shortest = max(np.flatnonzero(factors))
        assert duration == ("permanent", "long", "medium", "instantaneous")[shortest]


def test_a_load_on_the_roof_is_short_and_one_on_a_floor_medium():
    loads = loads_of(load="imposed")
    assert set(combinations_of(loads, EUROCODE).duration) == {"short"}
    floor = combinations_of(loads, replace(EUROCODE, imposed="office"))
    assert set(floor.duration) == {"medium"}


def test_what_lasts_is_permanent_and_the_quasi_permanent_share():
    loads = loads_of(weight="permanent", goods="imposed", wind="wind")
    found = combinations_of(loads, replace(EUROCODE, imposed="storage"))
    assert not found.of("ultimate").lasting.any()
    service = found.of("service")
    acting = service.factors > 0
    np.testing.assert_array_equal(service.lasting, acting * [1.0, 0.8, 0.0])
    assert (service.lasting <= service.factors).all()
    quasi = service.kind == "quasi-permanent"
    np.testing.assert_allclose(service.lasting[quasi], service.factors[quasi])


def test_the_report_says_rule_factors_and_every_combination():
    lines = combinations_of(TOWER, replace(EUROCODE, imposed="office")).described()
    text = "\n".join(lines)
    assert "EN 1990" in lines[0]
    assert "γG 1.35 unfavourable, 1 favourable; γQ 1.5" in text
    assert "ψ0, ψ1, ψ2 of imposed (office): 0.7, 0.5, 0.3" in text
    assert "Directions of wind exclude each other" in text
    assert "snow" not in text
    assert "ultimate, fundamental, short: 1.35 self weight + 1.05 floors + 1.5 wind east" in lines
    plain = combinations_of(TOWER, CombinationRules()).described()
    assert "as in the thesis" in plain[0]


def test_no_load_at_all_is_refused():
    with pytest.raises(ParameterError, match="no load case"):
        combinations_of(loads_of(), CombinationRules())


def test_the_rules_survive_a_table():
    rules = replace(EUROCODE, imposed="light traffic", snow="above 1000 m", variable=1.6)
    assert from_table(CombinationRules, to_table(rules), "combinations") == rules
