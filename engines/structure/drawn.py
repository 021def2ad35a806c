"""What a sized structure looks like: its members' sections, values along them, and how it bends."""

import numpy as np

from ..core.parameters import from_table
from ..core.scene import Mesh, Scene, Vector
from .catalogue import sections_of
from .fins import member_solids
from .joints import node_normals
from .sections import Sections
from .sized import Sized
from .structure import Structure, size_structure
from .tasks import families_of

_LOUD = 0.04  # share of the structure's size that its displacement is drawn with
_ROUND = (1, 2, 5, 10)


def structure_mesh(record: Structure) -> Mesh:
    """The solids of a structure that is sized by itself, for light and sun to meet.

    Raises as `size_structure`; a “mesh” has nothing to be sized and raises SceneError.
    """
    sized = size_structure(Scene(), record)
    model = sized.model
    normals = node_normals(model.frame, model.cells)
    return member_solids(model.frame, drawn_sections(sized), normals=normals).mesh


def drawn_sections(sized: Sized) -> Sections:
    """The members' sections (M,), from the families that they were chosen from."""
    record = from_table(Structure, sized.meta["parameters"], "parameters")
    rows = sized.rows
    return sections_of(families_of(record.rules), rows["family"], rows["section"])


def bent(sized: Sized, stations: int) -> tuple[Vector, Vector]:
    """How the members go in the combination that moves one farthest: `fins.deformed` takes it.

    Deflections (M, stations, 3) in m and the rotations (M, 2, 3) of the ends in rad, world axes.
    """
    turns = sized.displacements[sized.meta["worst"]][sized.model.frame.members, 3:]
    return _resampled(sized.deflections, stations), turns


def exaggeration(sized: Sized) -> float:
    """How many times too large displacements are drawn so that they are seen: 1, 2 or 5 · 10ⁿ."""
    size = np.ptp(sized.model.frame.nodes, axis=0).max()
    most = np.linalg.norm(sized.deflections, axis=-1).max()
    if most <= 0:
        return 1.0
    wanted = _LOUD * size / most
    decade = 10.0 ** np.floor(np.log10(wanted))
    return float(max(f for f in _ROUND if f * decade <= wanted * (1 + 1e-9)) * decade)


def values_along(sized: Sized, stations: int) -> dict[str, Vector]:
    """What members can be coloured by, each (M, stations) or, where it is one a member, (M, 1).

    ``utilisation``; ``stress`` in MPa, the greatest elastic one; ``displacement`` in mm in the
    worst combination; ``material``, 1 for steel and 0 for timber; ``height`` of the sections in cm;
    ``class``, EN 1993-1-1's, 0 for timber.
    """
    rows = sized.rows
    return {
        "utilisation": rows["utilisation"][:, None],
        "stress": 1e-6 * _resampled(np.abs(sized.stress).max(axis=0), stations),
        "displacement": 1e3 * np.linalg.norm(bent(sized, stations)[0], axis=-1),
        "material": (rows["material"] == "steel")[:, None].astype(float),
        "height": 1e2 * rows["height"][:, None],
        "class": sized.checked.section_class[:, None].astype(float),
    }


def _resampled(values: Vector, stations: int) -> Vector:
    """``values`` (M, S, …), even along the members, at other stations (M, stations, …) between."""
    place = np.linspace(0.0, values.shape[1] - 1.0, stations)
    before = np.minimum(place.astype(int), values.shape[1] - 2)
    share = (place - before).reshape(-1, *[1] * (values.ndim - 2))
    return (1 - share) * values[:, before] + share * values[:, before + 1]
