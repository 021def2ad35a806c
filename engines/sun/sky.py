"""The sky cut into patches, and how bright each is."""

from dataclasses import dataclass

from scipy.sparse import csr_array

from ..core.scene import Vector


@dataclass(frozen=True, slots=True)
class Patches:
    """The P patches of a sky dome, from the horizon up, and the ground as one more where asked.

    ``directions`` (P, 3) float64 unit vectors to the patches' centres, X east, Y north, Z up;
    ``solid_angles`` (P,) in sr, 2π together; ``rows`` (R,) int: patches in each row of altitude.
    """

    directions: Vector
    solid_angles: Vector
    rows: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Suns:
    """S directions that the sun's light is taken to come from.

    ``directions`` (S, 3) float64 unit vectors towards the sun, X east, Y north, Z up; ``weights``
    (S, T), sparse, or None: what share of interval t's direct light comes from each; ``accuracy``
    in rad: the farthest that a true sun is from the one that stands for it, 0 where they are the
    same.
    """

    directions: Vector
    weights: csr_array | None
    accuracy: float


@dataclass(frozen=True, slots=True)
class Skies:
    """T skies whose luminance goes with height above the horizon and distance from the sun.

    At ζ from the zenith and γ from the sun, both in rad, sky t has the relative luminance
    (1 + a e^(b / cos ζ) + g cos ζ) · (f + c e^(d γ) + e cos² γ), or 0 where that is negative:
    Perez's skies and the CIE's are all of this kind.

    ``sun`` (T, 3) float64 unit vectors towards the sun, X east, Y north, Z up; ``gradation`` (T, 3)
    a, b and g; ``indicatrix`` (T, 4) f, c, d and e.
    """

    sun: Vector
    gradation: Vector
    indicatrix: Vector

    def __len__(self) -> int:
        return len(self.sun)

    def __getitem__(self, chosen) -> "Skies":
        """The skies that a slice, a mask or indices choose."""
        return Skies(self.sun[chosen], self.gradation[chosen], self.indicatrix[chosen])
