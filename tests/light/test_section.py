"""Sections across a map whose texels are known."""

import numpy as np
import pytest
from heliform.engines.core.errors import SceneError
from heliform.engines.core.table import load_csv
from heliform.engines.light.irradiance import MAPS, IrradianceMap
from heliform.engines.light.section import section


@pytest.fixture
def ramp() -> IrradianceMap:
    """Illuminance 10·row + column on 4 × 8 texels of a plane of 0.8 m × 0.4 m."""
    values = np.add.outer(10.0 * np.arange(4), np.arange(8)).astype(np.float32)
    maps = {name: values + index for index, name in enumerate(MAPS)}
    meta = {"quantity": "Illuminance", "unit": "lx", "receiver": "Böden/1", "size": [0.8, 0.4]}
    return IrradianceMap(**maps, meta=meta)


def test_a_section_across_the_middle_holds_every_texel_once(ramp):
    across = section(ramp)
    np.testing.assert_array_equal(across.illuminance, ramp.illuminance[2])
    np.testing.assert_array_equal(across.upper, ramp.upper[2])
    np.testing.assert_allclose(across.distance, 0.05 + 0.1 * np.arange(8))


def test_distance_is_in_metres_along_the_line(ramp):
    diagonal = section(ramp, (0, 0), (1, 1), samples=100)
    assert diagonal.distance[-1] == pytest.approx(0.995 * np.hypot(0.8, 0.4))
    assert diagonal.illuminance[0] == ramp.illuminance[0, 0]
    assert diagonal.illuminance[-1] == ramp.illuminance[3, 7]


def test_a_line_that_reaches_beyond_the_receiver_is_nan_there(ramp):
    beyond = section(ramp, (-1, 0.1), (1, 0.1))
    assert np.isnan(beyond.illuminance[:8]).all()
    np.testing.assert_array_equal(beyond.caustic[8:], ramp.caustic[0])


@pytest.mark.parametrize(
    ("start", "end", "said"),
    [((0.5, 0.5), (0.5, 0.5), "no length"), ((2, 2), (3, 3), "does not cross “Böden/1”")],
)
def test_a_line_that_cannot_be_gets_a_sentence(ramp, start, end, said):
    with pytest.raises(SceneError, match=said):
        section(ramp, start, end)


def test_files(ramp, tmp_path):
    across = section(ramp)
    across.save_csv(tmp_path / "section.csv")
    across.save_png(tmp_path / "section.png")
    columns, meta = load_csv(tmp_path / "section.csv")
    assert list(columns)[:2] == ["Distance (m)", "Illuminance (lx)"]
    np.testing.assert_allclose(columns["Caustic (lx)"], across.caustic)
    assert meta["receiver"] == "Böden/1"
    assert (tmp_path / "section.png").stat().st_size > 1000
