"""The suns that surfaces scatter the light of: few, so that each is found often enough by chance.

Shadow rays that go to a thousand suns find each of them a thousandth as often, and an hour's light
needs its own. What matte surfaces return of it changes slowly as the sun goes on, so that over
long periods an hour may share the suns around its own.
"""

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from ..core.scene import Vector
from .sky import Suns
from .suns import merged_suns

MANY = 128
"""Suns that are found one by one."""
APART = 4.0
"""To how many degrees more of them are merged: some 150 in a year."""
_REACH = 1.5
"""How far around an hour's sun those are that it shares, over how far they were merged."""


def scattered_suns(suns: Suns, directions: Vector, light: Vector) -> Suns:
    """The ``suns`` themselves if there are not MANY, else fewer for these hours' scattered light.

    ``directions`` (T, 3) and ``light`` (T,) are those of `merged_suns`. An hour's light is shared
    by the suns up to 6° around, the more the nearer; together they have all of it.
    """
    if len(suns.directions) <= MANY:
        return suns
    few = merged_suns(directions, light, max(APART, float(np.degrees(suns.accuracy))))
    up = np.flatnonzero(directions[:, 2] > 0)
    reach = _REACH * 2 * np.sin(few.accuracy / 2) + 1e-9
    near = KDTree(directions[up]).sparse_distance_matrix(
        KDTree(few.directions), reach, output_type="ndarray"
    )
    share = 1 - np.square(near["v"] / reach)
    share /= np.bincount(near["i"], share)[near["i"]]
    shape = len(few.directions), len(directions)
    return Suns(few.directions, csr_array((share, (near["j"], up[near["i"]])), shape), few.accuracy)
