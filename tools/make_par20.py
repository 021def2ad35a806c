"""Write engines/light/data/par20.ies: an assumed PAR20-like spot, not a measured one.

I(γ) = I₀ [(1 − s) 2^(−(γ/w)^p) + s cos²γ] below the horizon and 0 above: a super-Gaussian beam and
spill light. w makes the beam angle, I₀ the flux. Run: python tools/make_par20.py
"""

from collections.abc import Iterable

import numpy as np
from heliform.engines.light.ies import sample_path
from heliform.engines.light.photometry import Photometry, scaled_to

FLUX, WATTS, DIAMETER = 500.0, 10.8, 0.05
BEAM, STEEPNESS, SPILL = 25.0, 2.5, 0.03

LABEL = f"""\
IES:LM-63-2019
[TEST] None: computed, not measured
[TESTLAB] None
[ISSUEDATE] 01-JAN-2026
[MANUFAC] Heliform
[LUMCAT] PAR20-LIKE
[LUMINAIRE] PAR20-like spot, assumed
[LAMP] {WATTS:g} W reflector lamp of PAR20 size (63 mm wide)
[OTHER] Distribution, beam angle ({BEAM:g} degrees), flux ({FLUX:g} lm) and luminous opening
[MORE] ({1000 * DIAMETER:g} mm across) are assumptions of Heliform's, not a manufacturer's
[MORE] measurement. They stand in for a lamp of which only the type and power are known.
TILT=NONE
"""


def relative_intensity(gamma_deg: np.ndarray) -> np.ndarray:
    """Intensity toward γ in degrees as a share of that on the axis."""
    half = BEAM / 2
    beam_there = (0.5 - SPILL * np.cos(np.radians(half)) ** 2) / (1 - SPILL)
    w = half / (-np.log2(beam_there)) ** (1 / STEEPNESS)
    beam = (1 - SPILL) * 2.0 ** -((gamma_deg / w) ** STEEPNESS)
    spill = SPILL * np.cos(np.radians(gamma_deg)) ** 2
    return np.where(gamma_deg < 90, beam + spill, 0.0)


def par20_text() -> str:
    """The file as it is shipped."""
    vertical = np.linspace(0.0, 90.0, 181)
    plane = relative_intensity(vertical)
    shape = Photometry(vertical, np.array([0.0, 360.0]), np.stack([plane, plane]), flux=1.0)
    candela = scaled_to(shape, FLUX).intensity[0]
    return LABEL + "\n".join(
        [
            f"1 {FLUX:g} 1 {len(vertical)} 1 1 2 {-DIAMETER:g} {-DIAMETER:g} 0",
            f"1 1.00001 {WATTS:g}",
            *_lines(f"{angle:g}" for angle in vertical),
            "0",
            *_lines(f"{value:.2f}" for value in candela),
            "",
        ]
    )


def _lines(words: Iterable[str]) -> list[str]:
    words = list(words)
    return [" ".join(words[k : k + 10]) for k in range(0, len(words), 10)]


if __name__ == "__main__":
    sample_path().write_text(par20_text(), encoding="ascii", newline="\r\n")
