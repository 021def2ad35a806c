"""The sections that sizing may choose from, laid out so that few of them need be checked."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..core.errors import ParameterError
from .family import Family
from .sections import Sections, joined_sections

Index = NDArray[np.intp]

_GROWING = (
    *("area", "inertia_y", "inertia_z", "torsion", "torsion_modulus"),
    *("elastic_y", "elastic_z", "plastic_y", "plastic_z"),
)
"""What grows from each section of a chain to the next."""


@dataclass(frozen=True, slots=True)
class Menu:
    """Sections to choose from, and the order in which they are preferred.

    ``order`` (n,): the preferred section first, indices into the pool. ``chains``: the same
    sections in chains along which everything that resists grows, each in the menu's order and
    given by places in ``order``; so what suffices on a chain is found by bisection.
    """

    order: Index
    chains: tuple[Index, ...]


@dataclass(frozen=True, slots=True)
class Pool:
    """All sections of some families, one after the other.

    ``family`` and ``section`` (T,): the family of each and its index in there.
    """

    families: tuple[Family, ...]
    sections: Sections
    family: Index
    section: Index

    def density(self) -> NDArray[np.float64]:
        """The density (T,) of each section's material in kg/m³."""
        return np.array([one.grade.density for one in self.families])[self.family]

    def youngs(self) -> NDArray[np.float64]:
        """Young's modulus (T,) of each section's material in Pa."""
        return np.array([one.grade.youngs for one in self.families])[self.family]

    def energy(self) -> NDArray[np.float64]:
        """The embodied energy (T,) of each section's material in J/kg."""
        return np.array([one.grade.energy for one in self.families])[self.family]


def pool_of(families: Sequence[Family]) -> Pool:
    """The pool of some families. Raises ParameterError where one is empty."""
    for one in families:
        if not len(one.sections):
            raise ParameterError(
                f"The family “{one.name}” has no sections; widen its range or choose another."
            )
    counts = [len(one.sections) for one in families]
    return Pool(
        tuple(families),
        joined_sections([one.sections for one in families]),
        np.repeat(np.arange(len(families)), counts),
        np.concatenate([np.arange(count) for count in counts]),
    )


def menu_of(pool: Pool, allowed: Index, cost: NDArray[np.float64] | None = None) -> Menu:
    """The menu of the sections ``allowed`` (n,), in that order or, with ``cost`` (T,), cheapest
    first."""
    order = allowed if cost is None else allowed[np.argsort(cost[allowed], kind="stable")]
    return Menu(order, _chains(pool, order))


def _chains(pool: Pool, order: Index) -> tuple[Index, ...]:
    """Split a menu greedily into chains: each section goes on the chain whose end is closest below.

    A chain keeps to one family and shape, and along it every property in `_GROWING` grows.
    """
    strengths = np.stack([getattr(pool.sections, name)[order] for name in _GROWING], axis=1)
    kind = np.stack([pool.family[order], pool.sections.shape[order]], axis=1)
    width = pool.sections.width[order]
    chains: list[list[int]] = []
    for place in range(len(order)):
        least = strengths[place] * (1 + 1e-9)
        fits = [
            chain
            for chain in chains
            if (kind[chain[-1]] == kind[place]).all() and (strengths[chain[-1]] <= least).all()
        ]
        if fits:
            # Of equal width first, so that a range of heights and widths falls into its columns.
            best = min(fits, key=lambda c: (abs(width[c[-1]] - width[place]), -c[-1]))
            best.append(place)
        else:
            chains.append([place])
    return tuple(np.array(chain) for chain in chains)
