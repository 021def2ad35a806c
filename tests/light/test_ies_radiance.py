"""Type B as Radiance's ies2rad and rtrace understand it, where they follow LM-63.

Its Type B takes H as atan(y/z), which is the angle of the standard in the planes V = 0 and H = 0
alone; it knows no Type A.
"""

import numpy as np
import pytest
from heliform.engines.light.ies import read_ies
from heliform.engines.light.photometry import intensity_at
from light.test_photometry import ies_text

pytest.importorskip("pyradiance")

from peers.test_ies_peer import radiance_intensity


@pytest.mark.parametrize("first", [-80, 0])
def test_a_floodlight_is_turned_as_in_radiance(tmp_path, first):
    v, h = np.arange(-80, 81, 5.0), np.arange(first, 81, 5.0)
    # Lopsided in both angles, so that a turn or a mirror image would show.
    light = 100 + 50 * np.sin(np.radians(v[None, :])) + (h[:, None] + 80) / 4
    text = ies_text(
        kind=2,
        lumens=-1,
        vertical=v.tolist(),
        horizontal=h.tolist(),
        candela=light.round(4).tolist(),
        opening=(-0.1, -0.1, -0.1),
    )
    (tmp_path / "lamp.ies").write_text(text)
    gamma = np.tile([0.0, 10, 33, 52, 75], 4)
    c = np.repeat([0.0, 90, 180, 270], 5)
    ours = intensity_at(read_ies(tmp_path / "lamp.ies"), gamma, c)
    assert ours.max() - ours.min() > 50
    assert radiance_intensity(tmp_path, gamma, c) == pytest.approx(ours, rel=5e-3)
