"""Photometric files as Radiance's ies2rad and rtrace understand them."""

import subprocess

import numpy as np
import pytest
from heliform.engines.light.ies import read_ies, sample_path
from heliform.engines.light.photometry import intensity_at

pyradiance = pytest.importorskip("pyradiance")

FAR = 20.0
LUMENS_PER_WATT = 179.0

QUADRANT = """IESNA91
[LUMINAIRE] lopsided
TILT=NONE
2 900 1.5 4 3 1 1 -.2 0 0
0.9 0.8 20
0 30 60 90
0 45 90
100 80 20 0
100 90 50 5
100 60 70 9
"""


FULL = """IESNA:LM-63-2002
TILT=NONE
1 -1 1 5 5 1 2 -.1 -.1 0
1 1 20
0 30 60 90 180
0 90 180 270 360
100 80 20 10 0
100 90 50 20 0
100 60 70 30 0
100 50 90 40 0
100 80 20 10 0
"""


@pytest.mark.parametrize("text", [None, QUADRANT, FULL], ids=["sample", "quadrant", "full"])
def test_intensity_far_from_the_lamp_is_that_of_radiance(tmp_path, text):
    lamp_file = tmp_path / "lamp.ies"
    lamp_file.write_text(text or sample_path().read_text(encoding="ascii"))
    gamma = np.array([0.0, 3, 8, 12.25, 20, 31, 45, 60, 75])
    c = np.array([0.0, 20, 45, 80, 110, 170, 250, 300, 350])
    ours = intensity_at(read_ies(lamp_file), gamma, c)
    theirs = radiance_intensity(tmp_path, gamma, c)
    assert theirs == pytest.approx(ours, rel=5e-3, abs=0.02)


def radiance_intensity(folder, gamma_deg, c_deg):
    """Intensity in cd by the illuminance on small faces that look at the lamp from afar."""
    binaries = pyradiance.BINPATH

    def run(*command, data=None):
        done = subprocess.run(
            [binaries / command[0], *command[1:]],
            cwd=folder,
            input=data,
            capture_output=True,
            check=True,
        )
        return done.stdout

    run("ies2rad", "-o", "lamp", "lamp.ies")
    (folder / "lamp.oct").write_bytes(run("oconv", "lamp.rad"))
    gamma, c = np.radians(gamma_deg), np.radians(c_deg)
    away = np.stack([np.sin(gamma) * np.cos(c), np.sin(gamma) * np.sin(c), -np.cos(gamma)], -1)
    rays = "\n".join(" ".join(f"{v:.9g}" for v in (*(FAR * d), *-d)) for d in away)
    command = ["rtrace", "-h", "-I", "-ab", "0", "-ds", "0", "-dj", "0", "lamp.oct"]
    rgb = np.loadtxt(run(*command, data=rays.encode()).decode().splitlines())
    return rgb[:, 0] * LUMENS_PER_WATT * FAR**2
