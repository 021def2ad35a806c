"""Finding the first sufficient section of each slot, with as few checks as can be."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .candidates import Index, Menu

Suffices = Callable[[Index, Index], NDArray[np.bool_]]
"""``suffices(slots (R,), places (R,)) -> (R,)``: whether the menu's section does for the slot."""

NONE = -1
_ROWS = 4000  # that are asked of at a time, of few slots


def first_sufficient(
    menu: Menu, slots: Index, current: Index, suffices: Suffices, *, thorough: bool = False
) -> Index:
    """The first place in ``menu`` that suffices for each of ``slots`` (n,); NONE where none does.

    ``current`` (n,) are the places that they have now: the search begins there, since few change
    from one round to the next. On each chain the first sufficient section is found by doubling and
    halving steps, on the understanding that what is larger suffices too; whatever is returned was
    asked of ``suffices`` itself. Where that finds nothing and the search is to be ``thorough``, all
    of the menu is gone through, since larger is not always better: thin walls and boards buckle.
    """
    if not len(slots):
        return np.zeros(0, dtype=np.intp)
    none, count = len(menu.order), len(menu.chains)
    lengths = np.array([len(chain) for chain in menu.chains])
    places = np.full((count, lengths.max()), none)
    own, step = np.zeros((2, none), dtype=np.intp)
    for number, chain in enumerate(menu.chains):
        places[number, : len(chain)] = chain
        own[chain], step[chain] = number, np.arange(len(chain))
    padded = np.hstack([places, np.full((count, 1), none)])

    chain = own[current]
    found = _along(places, chain, slots, step[current], lengths[chain], suffices)
    best = padded[chain, found]
    # Of the other chains only what is preferred to that is worth a look.
    limit = (places[None] < best[:, None, None]).sum(axis=2)
    limit[np.arange(len(slots)), chain] = 0
    row, chain = np.nonzero(limit)
    limit = limit[row, chain]
    found = _along(places, chain, slots[row], limit - 1, limit, suffices)
    better = found < limit
    np.minimum.at(best, row[better], places[chain[better], found[better]])
    if thorough and (lost := np.flatnonzero(best == none)).size:
        best[lost] = _anywhere(none, slots[lost], suffices)
    return np.where(best < none, best, NONE)


def _anywhere(none: int, slots: Index, suffices: Suffices) -> Index:
    """The first of ``none`` places that suffices for each of ``slots`` (n,); that, for none."""
    best, start = np.full(len(slots), none), 0
    while start < none and (lost := np.flatnonzero(best == none)).size:
        tried = np.arange(start, min(start + max(1, _ROWS // len(lost)), none))
        rows, places = np.repeat(lost, len(tried)), np.tile(tried, len(lost))
        holds = suffices(slots[rows], places)
        np.minimum.at(best, rows[holds], places[holds])
        start = tried[-1] + 1
    return best


def _along(
    places: Index, chain: Index, slots: Index, start: Index, limit: Index, suffices: Suffices
) -> Index:
    """The first sufficient step of each one's ``chain`` (n,) below ``limit`` (n,); that, for none.

    ``places`` (chains, steps). The search goes out from ``start`` (n,) in strides that double, and
    then halves what is left.
    """
    low, high = np.full(len(slots), -1), limit.copy()  # insufficient; sufficient, or none
    probe, stride = start.copy(), 1
    while (left := np.flatnonzero(high - low > 1)).size:
        at = probe[left]
        holds = suffices(slots[left], places[chain[left], at])
        high[left] = np.where(holds, at, high[left])
        low[left] = np.where(holds, low[left], at)
        ahead = np.where(holds, at - stride, at + stride)
        halved = (low[left] + high[left]) // 2
        bracketed = (low[left] >= 0) & (high[left] < limit[left])
        inside = (ahead > low[left]) & (ahead < high[left])
        probe[left] = np.where(bracketed | ~inside, halved, ahead)
        stride *= 2
    return high
