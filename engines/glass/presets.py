"""Walls to start from: the thesis's three objects as printed walls, and some of other kinds."""

from .fourier import Plan
from .loft import Wall

TABLE_1_WALLS = {
    "tube": Wall(width=0.217, depth=0.217, height=0.209, faces=263_783),
    "three_bulges": Wall(
        plan=Plan(radius=0.13, period_1=3, amplitude_1=0.1036),
        width=0.262,
        depth=0.283,
        height=0.201,
        faces=244_668,
    ),
    "four_bulges": Wall(
        plan=Plan(radius=0.11, period_1=4, amplitude_1=0.0838),
        width=0.231,
        depth=0.245,
        height=0.201,
        faces=237_827,
    ),
}
"""The objects of the thesis's Table 1, as in `object.TABLE_1`, by a base curve midway in the wall.

Amplitudes are those whose outer face comes closest to the lobes of `GlassObject` (0.16 mm).
"""

PRESETS = {
    **TABLE_1_WALLS,
    "rosette": Wall(
        plan=Plan(radius=0.11, period_1=5, amplitude_1=0.06, period_2=10, amplitude_2=0.012)
    ),
    "pebble": Wall(
        plan=Plan(
            radius=0.11, period_1=2, amplitude_1=0.1, period_2=3, amplitude_2=0.06, phase_2=40.0
        )
    ),
    "twisted": Wall(plan=Plan(radius=0.11, period_1=5, amplitude_1=0.07), twist=45.0),
    "tapered": Wall(plan=Plan(radius=0.12, period_1=6, amplitude_1=0.05), scale=0.75),
    "blended": Wall(
        plan=Plan(radius=0.115, period_1=3, amplitude_1=0.09),
        to_top=True,
        top=Plan(radius=0.1, period_1=6, amplitude_1=0.05),
    ),
    "sharpened": Wall(plan=Plan(radius=0.11, period_1=4, amplitude_1=0.06, offset=0.008)),
}
"""`TABLE_1_WALLS`, and walls of two waves, twisted, tapered, lofted between plans and offset."""
