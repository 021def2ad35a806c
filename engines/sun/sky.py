"""The sky cut into patches, and how bright each is."""

from dataclasses import dataclass

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
    (S, T) or None: what share of interval t's direct light comes from each; ``accuracy`` in rad: the
    farthest that a true sun is from the one that stands for it, 0 where they are the same.
    """

    directions: Vector
    weights: Vector | None
    accuracy: float
