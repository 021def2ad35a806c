"""Damaged photometric files: read, or told in one sentence; never a traceback."""

import numpy as np
import pytest
from heliform.engines.core.errors import FileError
from heliform.engines.light.ies import read_ies
from heliform.engines.light.photometry import Photometry, luminous_flux
from light.test_photometry import ies_text

FILES = {
    "C": ies_text(horizontal=(0, 45, 90), candela=[(9, 5, 1)] * 3, label="[LAMP] x\n[MORE] y"),
    "B": ies_text(
        kind=2, vertical=(-90, 0, 90), horizontal=(0, 45, 90), candela=[(9, 5, 1)] * 3, lumens=-1
    ),
    "A": ies_text(
        kind=3, vertical=(-90, 0, 90), horizontal=(-90, 45, 90), candela=[(9, 5, 1)] * 3, year=1991
    ),
    "tilt": ies_text(tilt="INCLUDE\n1\n3\n0 45 90\n1 .9 .8", opening=(-0.1, 0, -0.1)),
}
WORDS = ["", "-1", "0", "1e308", "-90", "180", "2.5", "abc", "1e9", "3", "TILT=", "\x00", "90 90"]


@pytest.mark.parametrize("kind", FILES)
def test_damage_is_read_or_told(tmp_path, kind):
    random = np.random.default_rng(7)
    path = tmp_path / "Lampe ä 1.ies"
    told = []
    for _ in range(400):
        words = FILES[kind].replace("\n", " \n ").split(" ")
        for _ in range(random.integers(1, 4)):
            words[random.integers(len(words))] = str(random.choice(WORDS))
        text = " ".join(words)
        path.write_text(text[: random.integers(len(text))] if random.random() < 0.2 else text)
        try:
            check(read_ies(path))
        except FileError as error:
            told.append(str(error))
    assert 100 < len(told) < 400
    for sentence in told:
        assert "“Lampe ä 1.ies”" in sentence
        assert sentence.endswith(".")
        assert "\n" not in sentence


def check(lamp: Photometry) -> None:
    assert np.isfinite(lamp.intensity).all()
    assert (lamp.intensity >= 0).all()
    assert np.isfinite(luminous_flux(lamp))
    assert np.all(np.diff(lamp.vertical) > 0)
    assert np.all(np.diff(lamp.horizontal) > 0)
