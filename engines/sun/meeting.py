"""Where a ray of daylight meets a surface, and what its panes let through."""

from dataclasses import dataclass
from typing import Any

from ..core import runtime
from . import panes
from .surroundings import CLEAR, RECORD, Surroundings

LONGEST = 256
"""Surfaces, panes among them, that a ray may meet on its way."""


@dataclass(frozen=True, slots=True)
class Meeting:
    """What rays meet next, on the device, a ray a lane.

    ``met``: whether there is anything; ``distance`` in m. ``along``: the cosine between the ray and
    the ``normal``. ``opaque``: whether it is no pane; then ``returned`` is the share of light that
    comes back and ``mirrored`` the share of that as off a mirror. ``leaves``: whether it is a pane
    that the ray leaves there, which is where it counts, and ``diffuses``: whether that is ground;
    ``s`` and ``p`` are what light polarised either way keeps, 1 elsewhere. ``step``: how far in m
    off the surface the ray goes on.
    """

    met: Any
    distance: Any
    normal: Any
    along: Any
    opaque: Any
    returned: Any
    mirrored: Any
    leaves: Any
    diffuses: Any
    s: Any
    p: Any
    step: Any


def meet(around: Surroundings, origin: Any, direction: Any, behind: Any, active: Any) -> Meeting:
    """What rays meet that are ``behind`` m past the last surface of glass."""
    mi = runtime.mitsuba()
    import drjit as dr

    ray = mi.Ray3f(origin, direction)
    hit = around.soup.scene.ray_intersect_preliminary(ray, coherent=False, active=active)
    met = active & hit.is_valid()
    record = dr.gather(
        mi.ArrayXf, around.records, hit.prim_index, met, shape=(RECORD, dr.width(hit.t))
    )
    normal = mi.Vector3f(record[0], record[1], record[2])
    along = dr.dot(direction, normal)
    pane = met & (record[3] > 0)
    sheet = record[6] > 0
    leaves = pane & (sheet | (along > 0))
    s, p = panes.slab(along, record[4], record[5], sheet, behind + hit.t)
    return Meeting(
        met=met,
        distance=hit.t,
        normal=normal,
        along=along,
        opaque=met & ~pane,
        returned=record[4],
        mirrored=record[5],
        leaves=leaves,
        diffuses=leaves & (record[3] > CLEAR),
        s=dr.select(leaves, s, 1),
        p=dr.select(leaves, p, 1),
        step=dr.maximum(record[7], panes.LONG * hit.t),
    )
