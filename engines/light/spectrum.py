"""Colour of light: index of glass by wavelength, lamps' spectra, and wavelengths for photons.

Wavelengths are in nm, in air, and within 380–780. A spectrum is the relative power per nm on
`WAVELENGTHS`; between its nodes everything is linear, so that sums over the nodes are CIE's own
5 nm summation and what is drawn at random agrees with them exactly.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.errors import ParameterError
from ..core.scene import Material

Array = NDArray[np.float64]
Illuminant = Literal["equal-energy", "incandescent", "daylight", "led"]

LINES = {"d": 587.5618, "F": 486.1327, "C": 656.2725}
"""Helium's d and hydrogen's F and C: V_d = (n_d − 1) ÷ (n_F − n_C)."""

STEP = 5.0
WAVELENGTHS: Array = np.arange(380.0, 781.0, STEP)

# Glass

AIR = 1.000272
"""Index of air at 20 °C and 1013 hPa; 3e-6 off at most [Ciddor, Appl. Opt. 35, 1996]."""

SELLMEIER = {
    "crown": (
        (1.03961212, 0.231792344, 1.01046945),
        (0.00600069867, 0.0200179144, 103.560653),
    ),
    "flint": (
        (1.73759695, 0.313747346, 1.89878101),
        (0.013188707, 0.0623068142, 155.23629),
    ),
    "water": (
        (0.5684027565, 0.1726177391, 0.02086189578, 0.1130748688),
        (0.005101829712, 0.01821153936, 0.02620722293, 10.69792721),
    ),
}
"""B and C (µm²) in n² = 1 + Σ B λ² ÷ (λ² − C)."""


def ior_at(material: Material, wavelength: ArrayLike) -> Array:
    """Index of refraction of a material against air; of ``wavelength``'s shape.

    ``own`` glass follows Cauchy's n = A + B ÷ λ² through its ``ior`` at d and its ``abbe`` number,
    nowhere below 1; an Abbe number of 0 leaves ``ior`` at all wavelengths. The others are what was
    published, whatever ``ior`` says:

    - ``soda-lime``: clear float glass, n_d 1.5234, V_d 64.0 [Rubin, Sol. Energy Mater. 12, 1985].
      His formula disperses 8 % less than Schott's soda-lime B 270 (1.523, 59); for that, or
      where a maker states an Abbe number, take ``own``.
    - ``crown``: Schott N-BK7, 1.51680, 64.17, and ``flint``: Schott N-SF11, 1.78472, 25.68 [data
      sheets, 22 °C].
    - ``water``: at 20 °C, 1.33304, 55.74 [Daimon & Masumura, Appl. Opt. 46, 2007; there against
      vacuum].
    """
    squared = np.square(np.asarray(wavelength, dtype=np.float64) / 1e3)
    match material.glass:
        case "own":
            return _cauchy(material.ior, material.abbe, squared)
        case "soda-lime":
            return 1.5130 - 0.003169 * squared + 0.003962 / squared
        case "water":
            return _sellmeier("water", squared * AIR**2) / AIR
        case glass:
            return _sellmeier(glass, squared)


def _cauchy(ior: float, abbe: float, squared: Array) -> Array:
    if abbe == 0:
        return np.full_like(squared, ior)
    d, f, c = (1e6 / LINES[line] ** 2 for line in "dFC")
    slope = (ior - 1) / abbe / (f - c)
    return np.maximum(ior + slope * (1 / squared - d), 1.0)


def _sellmeier(glass: str, squared: Array) -> Array:
    strengths, resonances = SELLMEIER[glass]
    terms = zip(strengths, resonances, strict=True)
    return np.sqrt(1 + sum(b * squared / (squared - c) for b, c in terms))


# The eye

_X = """
    1368 2236 4243 7650 14310 23190 43510 77630 134380 214770 283900 328500 348280 348060 336200
    318700 290800 251100 195360 142100 95640 57950 32010 14700 4900 2400 9300 29100 63270 109600
    165500 225750 290400 359700 433450 512050 594500 678400 762100 842500 916300 978600 1026300
    1056700 1062200 1045600 1002600 938400 854450 751400 642400 541900 447900 360800 283500 218700
    164900 121200 87400 63600 46770 32900 22700 15840 11359 8111 5790 4109 2899 2049 1440 1000 690
    476 332 235 166 117 83 59 42
"""
_Y = """
    39 64 120 217 396 640 1210 2180 4000 7300 11600 16840 23000 29800 38000 48000 60000 73900 90980
    112600 139020 169300 208020 258600 323000 407300 503000 608200 710000 793200 862000 914850
    954000 980300 994950 1000000 995000 978600 952000 915400 870000 816300 757000 694900 631000
    566800 503000 441200 381000 321000 265000 217000 175000 138200 107000 81600 61000 44580 32000
    23200 17000 11920 8210 5723 4102 2929 2091 1484 1047 740 520 361 249 172 120 85 60 42 30 21 15
"""
_Z = """
    6450 10550 20050 36210 67850 110200 207400 371300 645600 1039050 1385600 1622960 1747060 1782600
    1772110 1744100 1669200 1528100 1287640 1041900 812950 616200 465180 353300 272000 212300 158200
    111700 78250 57250 42160 29840 20300 13400 8750 5750 3900 2750 2100 1800 1650 1400 1100 1000 800
    600 340 240 190 100 50 30 20 10
"""


def _numbers(text: str, size: int) -> Array:
    """The numbers of a table, with noughts behind."""
    numbers = np.array(text.split(), dtype=np.float64)
    return np.pad(numbers, (0, size - numbers.size))


MATCHING: Array = np.stack([_numbers(text, WAVELENGTHS.size) for text in (_X, _Y, _Z)], 1) / 1e6
"""x̄, ȳ and z̄ (81, 3) of the CIE 1931 2° observer [CIE 15:2004, table T.4]; ȳ is V(λ)."""


def tristimulus(power: Array) -> Array:
    """X, Y and Z (3,) of a spectrum; relative as the spectrum is."""
    return np.asarray(np.trapezoid(power[:, None] * MATCHING, WAVELENGTHS, axis=0))


# Lamps

_S0 = """
    63.4 65.8 94.8 104.8 105.9 96.8 113.9 125.6 125.5 121.3 121.3 113.5 113.1 110.8 106.5 108.8
    105.3 104.4 100 96 95.1 89.1 90.5 90.3 88.4 84 85.1 81.9 82.6 84.9 81.3 71.9 74.3 76.4 63.3
    71.7 77 65.2 47.7 68.6 65
"""
_S1 = """
    38.5 35 43.4 46.3 43.9 37.1 36.7 35.9 32.6 27.9 24.3 20.1 16.2 13.2 8.6 6.1 4.2 1.9 0 -1.6 -3.5
    -3.5 -5.8 -7.2 -8.6 -9.5 -10.9 -10.7 -12 -14 -13.6 -12 -13.3 -12.9 -10.6 -11.6 -12.2 -10.2 -7.8
    -11.2 -10.4
"""
_S2 = """
    3 1.2 -1.1 -0.5 -0.7 -1.2 -2.6 -2.9 -2.8 -2.6 -2.6 -1.8 -1.5 -1.3 -1.2 -1 -0.5 -0.3 0 0.2 0.5
    2.1 3.2 4.1 4.7 5.1 6.7 7.3 8.6 9.8 10.2 8.3 9.6 8.5 7 7.6 8 6.7 5.2 7.4 6.8
"""


def spectrum(name: Illuminant) -> Array:
    """Relative power per nm (81,) on `WAVELENGTHS`, 1 at 560 nm.

    - ``equal-energy``: CIE's E, the same everywhere.
    - ``incandescent``: CIE standard illuminant A, a black body of 2856 K.
    - ``daylight``: CIE standard illuminant D65.
    - ``led``: a white phosphor LED of 4000 K. An assumption, not a measured lamp: a blue peak at
      450 nm, 25 nm wide at half its height, and a phosphor's, 130 nm wide; the phosphor's place,
      580.55 nm, and the blue's height, 0.948 of the phosphor's, put its white on the black body's
      at 4000 K.
    """
    match name:
        case "equal-energy":
            power = np.ones_like(WAVELENGTHS)
        case "incandescent":
            # In CIE's definition, which keeps the constant c₂ and the 2848 K of 1931.
            power = WAVELENGTHS**-5 / np.expm1(1.435e7 / 2848 / WAVELENGTHS)
        case "daylight":
            power = _daylight(6500 * 1.4388 / 1.4380)
        case "led":
            power = 0.948 * _peak(450.0, 25.0) + _peak(580.55, 130.0)
    return power / np.interp(560.0, WAVELENGTHS, power)


def _daylight(temperature: float) -> Array:
    """CIE's daylight of a correlated colour temperature between 4000 and 7000 K [CIE 15:2004]."""
    t = 1e3 / temperature
    x = -4.6070 * t**3 + 2.9678 * t**2 + 0.09911 * t + 0.244063
    y = -3.000 * x**2 + 2.870 * x - 0.275
    m = 0.0241 + 0.2562 * x - 0.7341 * y
    first = (-1.3515 - 1.7703 * x + 5.9114 * y) / m
    second = (0.0300 - 31.4424 * x + 30.0717 * y) / m
    s0, s1, s2 = (
        np.interp(WAVELENGTHS, WAVELENGTHS[::2], _numbers(text, WAVELENGTHS[::2].size))
        for text in (_S0, _S1, _S2)
    )
    return s0 + first * s1 + second * s2


def _peak(centre: float, width: float) -> Array:
    """A bell of height 1, as wide as ``width`` at half of it."""
    return np.exp(-4 * np.log(2) * ((WAVELENGTHS - centre) / width) ** 2)


# Photons


@dataclass(frozen=True, eq=False)
class Bands:
    """Wavelengths for the photons of a lamp with the spectrum ``power``, and what they weigh.

    A photon carries luminous flux in lm. Times its three weights, summed over what lands on an
    area, this gives X, Y and Z with Y in lx: over all wavelengths the weights average `white`,
    whose Y is 1. Wavelengths are dealt in proportion to ``power`` × (x̄ + ȳ + z̄); so all photons
    have the same sum of weights, and each three are in proportion to the chromaticity of their
    wavelength.

    Raises ParameterError where ``power`` is not a spectrum.
    """

    power: Array

    def __post_init__(self) -> None:
        power = np.asarray(self.power)
        valid = power.shape == WAVELENGTHS.shape and np.isfinite(power).all()
        if not valid or power.min() < 0 or power.max() == 0:
            raise ParameterError(
                f"A lamp's spectrum needs {WAVELENGTHS.size} powers, one every 5 nm from 380 to "
                "780 nm, none negative and not all 0."
            )

    @property
    def white(self) -> Array:
        """X, Y and Z (3,) of the lamp, Y = 1."""
        return self._cumulative[-1]

    def draw(self, u: ArrayLike) -> tuple[Array, Array]:
        """Wavelengths (...) and weights (..., 3) for even random numbers ``u`` (...) in 0..1."""
        cell, t = self._find(u)
        low, high = self._density[cell], self._density[cell + 1]
        shares = low + (high - low) * t[..., None]
        total = shares.sum(-1, keepdims=True)
        weights = np.divide(shares, total, out=np.zeros_like(shares), where=total > 0)
        return WAVELENGTHS[cell] + STEP * t, weights * self.white.sum()

    def table(self, size: int = 256) -> NDArray[np.float32]:
        """The same to look up: wavelength and weights (``size``, 4) of even shares of the photons.

        Row k stands for u = (k + ½) ÷ size: the wavelength there, and the weights' mean over the
        row's share. Read at u · size − ½, held within 0..size − 1 and linear between the rows, the
        weights average `white` exactly; half a row's tail at each end takes the row's wavelength.
        """
        middle, _ = self.draw((np.arange(size) + 0.5) / size)
        cell, t = self._find(np.arange(size + 1) / size)
        low, high, t = self._density[cell], self._density[cell + 1], t[:, None]
        upto = self._cumulative[cell] + STEP * (low * t + (high - low) * t * t / 2)
        return np.column_stack([middle, np.diff(upto, axis=0) * size]).astype(np.float32)

    @cached_property
    def _density(self) -> Array:
        """X, Y and Z per nm (81, 3), of a lamp whose Y is 1."""
        return self.power[:, None] * MATCHING / tristimulus(self.power)[1]

    @cached_property
    def _cumulative(self) -> Array:
        """X, Y and Z (81, 3) of what is below each node."""
        cells = STEP * (self._density[:-1] + self._density[1:]) / 2
        return np.concatenate([np.zeros((1, 3)), np.cumsum(cells, axis=0)])

    def _find(self, u: ArrayLike) -> tuple[NDArray[np.intp], Array]:
        """The cell below which, and the part of it, that the share ``u`` of the photons lies."""
        below = self._cumulative.sum(1)
        wanted = np.asarray(u, dtype=np.float64) * below[-1]
        cell = np.clip(np.searchsorted(below, wanted, side="right") - 1, 0, below.size - 2)
        # low t + (high − low) t² ÷ 2 = rest, solved for t without cancellation
        rest = (wanted - below[cell]) / STEP
        density = self._density.sum(1)
        low, high = density[cell], density[cell + 1]
        root = low + np.sqrt(np.maximum(low * low + 2 * (high - low) * rest, 0))
        t = np.divide(2 * rest, root, out=np.zeros_like(rest), where=root > 0)
        return cell, np.clip(t, 0, 1)


# Display

BRADFORD = np.array(
    [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]
)
"""From XYZ to the cones' sharpened responses [Lam 1985]."""


def _upright(x: float, y: float) -> Array:
    """X, Y and Z of a chromaticity, Y = 1."""
    return np.array([x / y, 1.0, (1 - x - y) / y])


D65: Array = _upright(0.3127, 0.3290)
_PRIMARIES = np.stack([_upright(0.64, 0.33), _upright(0.30, 0.60), _upright(0.15, 0.06)], 1)
REC709: Array = np.linalg.inv(_PRIMARIES * np.linalg.solve(_PRIMARIES, D65))
"""From XYZ to linear red, green and blue [ITU-R BT.709]."""


def to_rgb(xyz: ArrayLike, white: ArrayLike) -> Array:
    """Linear Rec. 709 (..., 3) of ``xyz`` (..., 3) as an eye used to the lamp's ``white`` sees it.

    ``white`` becomes neutral by Bradford's transform, at its own luminance: light of the lamp's
    colour has three equal parts, its Y. What Rec. 709 cannot show, near a pure spectral colour, is
    clipped at 0.
    """
    adapt = np.diag(BRADFORD @ D65 / (BRADFORD @ np.asarray(white, dtype=np.float64)))
    matrix = REC709 @ np.linalg.solve(BRADFORD, adapt @ BRADFORD)
    return np.maximum(np.asarray(xyz, dtype=np.float64) @ matrix.T, 0)
