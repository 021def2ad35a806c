"""Finding the first sufficient section of each slot, with as few checks as can be."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .candidates import Index, Menu

Suffices = Callable[[Index, Index], NDArray[np.bool_]]
"""``suffices(slots (R,), places (R,)) -> (R,)``: whether the menu's section does for the slot."""

NONE = -1


def first_sufficient(menu: Menu, slots: Index, current: Index, suffices: Suffices) -> Index:
    """The first place in ``menu`` that suffices for each of ``slots`` (n,); NONE where none does.

    ``current`` (n,) are the places that they have now: the search begins there, since few change
    from one round to the next. On each chain the first sufficient section is found by doubling and
    halving steps, on the understanding that what is larger suffices too; whatever is returned was
    asked of ``suffices`` itself.
    """
    own = np.zeros(len(menu.order), dtype=np.intp)
    for number, chain in enumerate(menu.chains):
        own[chain] = number
    none = len(menu.order)
    best = np.full(len(slots), none)
    for number, chain in enumerate(menu.chains):
        here = np.flatnonzero(own[current] == number)
        start, limit = np.searchsorted(chain, current[here]), np.full(len(here), len(chain))
        found = _along(chain, slots[here], start, limit, suffices)
        best[here] = np.append(chain, none)[found]
    for number, chain in enumerate(menu.chains):
        # Only what is preferred to the best so far is worth a look.
        limit = np.searchsorted(chain, best)
        here = np.flatnonzero((own[current] != number) & (limit > 0))
        limit = limit[here]
        found = _along(chain, slots[here], limit - 1, limit, suffices)
        better = found < limit
        best[here[better]] = chain[found[better]]
    return np.where(best < none, best, NONE)


def _along(chain: Index, slots: Index, start: Index, limit: Index, suffices: Suffices) -> Index:
    """The first sufficient step of ``chain`` below ``limit`` (n,), which stands for none.

    The search goes out from ``start`` (n,) in steps that double, and then halves what is left.
    """
    low, high = np.full(len(slots), -1), limit.copy()  # insufficient; sufficient, or none
    probe, stride = start.copy(), 1
    while (left := np.flatnonzero(high - low > 1)).size:
        at = probe[left]
        holds = suffices(slots[left], chain[at])
        high[left] = np.where(holds, at, high[left])
        low[left] = np.where(holds, low[left], at)
        ahead = np.where(holds, at - stride, at + stride)
        halved = (low[left] + high[left]) // 2
        bracketed = (low[left] >= 0) & (high[left] < limit[left])
        inside = (ahead > low[left]) & (ahead < high[left])
        probe[left] = np.where(bracketed | ~inside, halved, ahead)
        stride *= 2
    return high
