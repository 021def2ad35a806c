"""Daylight as NREL put it into a TMY3 file, by efficacies of its own."""

from pathlib import Path

import numpy as np
import pvlib
import pytest
from heliform.engines.sun.hourly import hourly_skies
from peers.skies import typical_year

pytestmark = pytest.mark.peer


def test_light_is_as_much_as_the_files_own():
    name = "703165TY.csv"
    weather = typical_year(name)
    table, _ = pvlib.iotools.read_tmy3(Path(pvlib.__file__).parent / "data" / name)
    ours = hourly_skies(weather, weather.site, "light")
    bright = (weather.diffuse_horizontal > 30) & (ours.sun[:, 2] > 0.1)
    sunny = bright & (weather.direct_normal > 50)
    for light, column, hours in (
        (ours.diffuse, "DH illum (lx)", bright),
        (ours.direct, "DN illum (lx)", sunny),
    ):
        ratio = light[hours] / table[column].to_numpy()[hours]
        assert np.median(ratio) == pytest.approx(1, abs=0.03)
        assert 0.9 < np.quantile(ratio, 0.05) < np.quantile(ratio, 0.95) < 1.25
