"""Steel members that the tests of the checks share."""

import numpy as np
from heliform.engines.structure.checking import FORCES, Demand
from heliform.engines.structure.grade import Grade
from heliform.engines.structure.sections import Sections, i_section


def steel(strength: float, youngs: float = 210e9) -> Grade:
    """A steel of so many MPa."""
    return Grade(
        name=f"S{strength:g}",
        kind="steel",
        youngs=youngs,
        shear=youngs / 2.6,
        density=7850.0,
        energy=24.4e6,
        carbon=1.5,
        source="EN 1993-1-1 Table 3.1",
        yield_strength=strength * 1e6,
    )


def demand(length: float | np.ndarray = 3.0, members: int = 1, **forces) -> Demand:
    """One combination of the same forces at 5 stations; each a number, 5 of them or (members, 5).

    ``length`` is every buckling length too.
    """
    values = np.zeros((1, members, 5, 6))
    for name, value in forces.items():
        values[0, :, :, FORCES.index(name)] = np.broadcast_to(value, (members, 5))
    lengths = np.broadcast_to(np.asarray(length, dtype=float), members).copy()
    return Demand(values, lengths, lengths, lengths, lengths)


def used(checked, part: str) -> float:
    """What the first member uses of the one check whose name has ``part`` in it."""
    rows = [row for row, name in enumerate(checked.names) if part in name]
    assert len(rows) == 1
    return float(checked.utilisation[rows[0], 0])


def ipe(height: float) -> Sections:
    """IPE 300, 330 or 600 of EN 10365, by its height in mm."""
    sizes = {
        300: (0.300, 0.150, 0.0071, 0.0107, 0.015),
        330: (0.330, 0.160, 0.0075, 0.0115, 0.018),
        600: (0.600, 0.220, 0.012, 0.019, 0.024),
    }
    return i_section(*sizes[int(height)])
