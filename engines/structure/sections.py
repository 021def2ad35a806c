"""Cross-sections as arrays: many at once, with everything that analysis and checks ask of them."""

from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..core.scene import Vector

Shape = Literal["rhs", "chs", "i", "rectangle"]
SHAPES: tuple[Shape, ...] = ("rhs", "chs", "i", "rectangle")


@dataclass(frozen=True, slots=True)
class Sections:
    """S cross-sections; each field (S,). y is the strong axis: the height is measured along z.

    ``name`` (S,) text; ``shape`` (S,) int8, an index into SHAPES; ``height``, ``width``, ``web``
    and ``flange`` (thicknesses of the parts along z and along y), ``radius`` (outer corner of an
    RHS, root of an I) in m, 0 where there is none.

    ``area`` in m²; ``inertia_y``, ``inertia_z`` and ``torsion`` (J of Saint-Venant) in m⁴;
    ``shear_y`` and ``shear_z``: Timoshenko shear areas in m²; ``elastic_y``, ``elastic_z``,
    ``plastic_y``, ``plastic_z``: section moduli and ``torsion_modulus`` (T ÷ τ_max) in m³;
    ``perimeter`` in m.
    """

    name: NDArray[np.str_]
    shape: NDArray[np.int8]
    height: Vector
    width: Vector
    web: Vector
    flange: Vector
    radius: Vector
    area: Vector
    inertia_y: Vector
    inertia_z: Vector
    torsion: Vector
    shear_y: Vector
    shear_z: Vector
    elastic_y: Vector
    elastic_z: Vector
    plastic_y: Vector
    plastic_z: Vector
    torsion_modulus: Vector
    perimeter: Vector

    def __len__(self) -> int:
        return len(self.area)

    def take(self, index: NDArray[np.integer] | NDArray[np.bool_] | slice) -> "Sections":
        """The sections at ``index``, repeated as often as it says."""
        return Sections(*(getattr(self, f.name)[index] for f in fields(self)))
