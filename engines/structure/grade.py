"""What a member is made of: stiffness, density, strengths, and what it costs the climate."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Grade:
    """A grade of steel or a strength class of timber.

    ``youngs`` E and ``shear`` G in Pa (means); ``density`` in kg/m³; ``energy`` embodied energy in
    J/kg; ``carbon`` in kg of CO₂ equivalent per kg; ``source``: where the figures are from.

    Steel: ``yield_strength`` f_y in Pa. Timber, characteristic strengths in Pa: ``bending`` f_m,k,
    ``tension`` f_t,0,k, ``compression`` f_c,0,k, ``shear_strength`` f_v,k; ``youngs_low`` E_0,05 and
    ``shear_low`` G_05 in Pa; ``glued`` for glued laminated timber. Zero where it says nothing.
    """

    name: str
    kind: Literal["steel", "timber"]
    youngs: float
    shear: float
    density: float
    energy: float
    carbon: float
    source: str
    yield_strength: float = 0.0
    bending: float = 0.0
    tension: float = 0.0
    compression: float = 0.0
    shear_strength: float = 0.0
    youngs_low: float = 0.0
    shear_low: float = 0.0
    glued: bool = False
