"""The catalogue: which families there are, and what their sections weigh and resist with."""

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .catalogue_file import read_catalogue, write_catalogue
from .family import Family, nearest
from .frame import Rigidities
from .grade import DATA, grades
from .section_range import BoardRange, SectionRange, family_of_range, thesis_family
from .sections import Sections, joined_sections

__all__ = (
    "FAMILIES",
    "BoardRange",
    "SectionRange",
    "Weights",
    "family_of_range",
    "load_family",
    "read_catalogue",
    "rigidities_of",
    "sections_of",
    "thesis_family",
    "weights_of",
    "write_catalogue",
    "write_template",
)

_FILES = ("hollow.toml", "rolled.toml", "timber.toml")
FAMILIES = (
    *("thesis-steel", "thesis-timber", "rhs", "shs", "chs", "ipe", "hea", "heb"),
    *("timber", "glulam"),
)
"""The shipped families: the thesis's over their whole range, and those of the standards."""

_EXAMPLES = ("shs", "chs", "ipe", "timber")


def load_family(name: str, grade: str = "", own: Mapping[str, Family] | None = None) -> Family:
    """A family by name, in ``grade`` where one is named; ``own`` families come before the shipped.

    Raises ParameterError where there is no such family or grade, naming the nearest.
    """
    own = own or {}
    if name in own:
        family = own[name]
    elif name in FAMILIES:
        family = _shipped()[name]
    else:
        raise ParameterError(f"There is no family “{name}”; {nearest(name, (*own, *FAMILIES))}")
    if not grade or grade == family.grade.name:
        return family
    if grade not in grades():
        raise ParameterError(f"There is no grade “{grade}”; {nearest(grade, grades())}")
    chosen = grades()[grade]
    if chosen.kind != family.grade.kind:
        raise ParameterError(
            f"The family “{name}” is of {family.grade.kind} and cannot be of {grade}, "
            f"a grade of {chosen.kind}; choose another."
        )
    return replace(family, grade=chosen)


def write_template(path: Path | str, families: Sequence[str] = _EXAMPLES) -> None:
    """Write a catalogue to edit: how it is written, and the named shipped families in full.

    Raises ParameterError where there is no such family, FileError where it cannot be written.
    """
    write_catalogue(path, {name: load_family(name) for name in families})


def sections_of(
    families: Sequence[Family], family: NDArray[np.integer], section: NDArray[np.integer]
) -> Sections:
    """The section of each member, from the indices (M,) of its family and of its section there."""
    index = _index(families, family, section)
    return joined_sections([f.sections for f in families]).take(index)


def rigidities_of(
    families: Sequence[Family], family: NDArray[np.integer], section: NDArray[np.integer]
) -> Rigidities:
    """What each member resists with, by the mean stiffness of its grade.

    ``family`` (M,) is an index into ``families``, ``section`` (M,) into that family's sections.
    Raises ParameterError naming the first member that is outside of them.
    """
    index = _index(families, family, section)
    youngs, shear, density = (
        np.array([getattr(f.grade, name) for f in families])[family]
        for name in ("youngs", "shear", "density")
    )

    def column(name: str) -> Vector:
        return np.concatenate([getattr(f.sections, name) for f in families])[index]

    area, inertia_y, inertia_z = column("area"), column("inertia_y"), column("inertia_z")
    return Rigidities(
        axial=youngs * area,
        bending_y=youngs * inertia_y,
        bending_z=youngs * inertia_z,
        torsion=shear * column("torsion"),
        shear_y=shear * column("shear_y"),
        shear_z=shear * column("shear_z"),
        mass=density * area,
        rotary=density * (inertia_y + inertia_z),
    )


@dataclass(frozen=True, slots=True)
class Weights:
    """What a metre of each member is (M,): ``mass`` in kg/m, ``energy`` embodied in J/m, ``carbon``
    in kg of CO₂ equivalent per m."""

    mass: Vector
    energy: Vector
    carbon: Vector


def weights_of(
    families: Sequence[Family], family: NDArray[np.integer], section: NDArray[np.integer]
) -> Weights:
    """What a metre of each member weighs and costs the climate; arguments as of `rigidities_of`."""
    index = _index(families, family, section)
    area = np.concatenate([f.sections.area for f in families])[index]
    mass = np.array([f.grade.density for f in families])[family] * area
    energy, carbon = (
        np.array([getattr(f.grade, name) for f in families])[family]
        for name in ("energy", "carbon")
    )
    return Weights(mass, mass * energy, mass * carbon)


@functools.cache
def _shipped() -> Mapping[str, Family]:
    found = {
        "thesis-steel": family_of_range("steel", SectionRange()),
        "thesis-timber": family_of_range("timber", BoardRange()),
    }
    for name in _FILES:
        found |= read_catalogue(DATA / name)
    return found


def _index(
    families: Sequence[Family], family: NDArray[np.integer], section: NDArray[np.integer]
) -> NDArray[np.intp]:
    """Where each member's section is in the families one after the other."""
    family, section = np.asarray(family, dtype=np.intp), np.asarray(section, dtype=np.intp)
    counts = np.array([len(f.sections) for f in families])
    good = (family >= 0) & (family < len(families))
    good &= (section >= 0) & (section < counts[np.where(good, family, 0)])
    if not good.all():
        member = int(np.argmin(good))
        raise ParameterError(
            f"Member {member} has section {section[member]} of family {family[member]}, which is "
            "not in the catalogue; choose its section again."
        )
    return (np.cumsum(counts) - counts)[family] + section
