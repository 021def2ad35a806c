"""Finding the first sufficient section of each slot, with as few checks as can be."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .candidates import Index, Menu

Sufficient = Callable[[Index, Index], NDArray[np.bool_]]
"""``sufficient(slots (R,), sections (R,)) -> (R,)``: whether a section of the pool suffices there."""

NONE = -1


def first_sufficient(menu: Menu, slots: Index, current: Index, sufficient: Sufficient) -> Index:
    """The first section of ``menu`` that suffices for each of ``slots`` (n,); NONE where none does.

    ``current`` (n,) are the sections that they have now, NONE at the start: the search begins
    there, since few change from one round to the next. On each chain the first sufficient section
    is found by doubling and halving steps, on the understanding that what is larger suffices too;
    whatever is returned was checked itself. Returns indices into the pool.
    """
    place_of = np.full(menu.order.max() + 1, NONE)
    place_of[menu.order] = np.arange(len(menu.order))
    known = (current >= 0) & (current <= menu.order.max())
    place = np.where(known, place_of[np.where(known, current, 0)], NONE)

    chain_of = np.zeros(len(menu.order), dtype=np.intp)
    for number, chain in enumerate(menu.chains):
        chain_of[chain] = number
    own = np.where(place >= 0, chain_of[place], NONE)

    best = np.full(len(slots), len(menu.order))
    for number, chain in enumerate(menu.chains):
        here = np.flatnonzero(own == number)
        start = np.searchsorted(chain, place[here])
        found = _along(chain, slots[here], start, np.full(len(here), len(chain)), menu, sufficient)
        best[here] = np.where(found < len(chain), chain[np.minimum(found, len(chain) - 1)], best[here])
    for number, chain in enumerate(menu.chains):
        # Only what is preferred to the best so far is worth a look.
        limit = np.searchsorted(chain, best)
        here = np.flatnonzero((own != number) & (limit > 0))
        limit = limit[here]
        found = _along(chain, slots[here], limit - 1, limit, menu, sufficient)
        better = found < limit
        best[here[better]] = chain[found[better]]
    return np.where(best < len(menu.order), menu.order[np.minimum(best, len(menu.order) - 1)], NONE)


def _along(
    chain: Index, slots: Index, start: Index, limit: Index, menu: Menu, sufficient: Sufficient
) -> Index:
    """The first sufficient place along ``chain`` below ``limit`` (n,), which stands for none.

    The search goes out from ``start`` (n,) in steps that double, and then halves what is left.
    """
    low, high = np.full(len(slots), -1), limit.copy()  # insufficient, and sufficient or none
    probe, step = start.copy(), np.ones(len(slots), dtype=np.intp)
    while (open_ := np.flatnonzero(high - low > 1)).size:
        at = probe[open_]
        holds = sufficient(slots[open_], menu.order[chain[at]])
        high[open_[holds]] = at[holds]
        low[open_[~holds]] = at[~holds]
        bounded = (low[open_] >= 0) & (high[open_] < limit[open_])
        ahead = np.where(holds, at - step[open_], at + step[open_])
        halved = (low[open_] + high[open_]) // 2
        outside = (ahead <= low[open_]) | (ahead >= high[open_])
        probe[open_] = np.where(bounded | outside, halved, ahead)
        step[open_] *= 2
    return high
