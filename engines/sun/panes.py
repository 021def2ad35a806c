"""Sun through panes: what a straight ray keeps of its light in the clear glass that it crosses.

At each plane-parallel pane s- and p-polarised light keep ½ Σ a (1 − R)² ÷ (1 − a² R²), all
reflections within the pane included [Born & Wolf, 1.6]: R by Fresnel's equations at the angle of
incidence, a = exp(−absorption × the refracted way through the glass). The two polarisations are
carried through all panes of a ray, which is exact where these are parallel; light reflected from
one pane to another is left out (some 1 % in double glazing). The ray stays straight: how curved or
wedged glass bends and gathers the sun, photon tracing shows.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import runtime
from ..core.progress import SILENT, Progress
from . import bits
from .rays import Fired, Rays
from .soup import CLOSE, Soup

MOST = 32
"""Surfaces of glass that a ray may cross; behind more it is dark."""


def transmittances(
    soup: Soup, rays: Rays, among: bits.Bits, progress: Progress = SILENT
) -> NDArray[np.uint16] | None:
    """What the panes let through of each ray ``among`` (N, ceil(D / 8)): (N, D) of bits.FULL.

    A closed body is glass between the surface where the ray enters and that where it leaves; a
    sheet is a pane by itself, whose tint is not known and left out. 0 where no ray is; None without
    panes.
    """
    if soup.scene is None:
        return None
    out = np.empty((len(rays.origins), len(rays.directions)), np.uint16)
    records = _records(soup)
    for rows in rays.batches(progress):
        kept = np.asarray(_crossed(soup, records, Fired(rays, rows, among)))
        out[rows] = np.rint(kept * bits.FULL).reshape(-1, out.shape[1])
    return out


def told(soup: Soup) -> tuple[str, ...]:
    """What to tell of the panes: that rays stay straight, and whose tint is left out."""
    if not soup.bodies:
        return ()
    flat = [
        body.name
        for number, body in enumerate(soup.bodies)
        if body.material.absorption > 0 and not soup.closed(number)
    ]
    return (
        "Sun goes straight through clear glass here, less what that reflects and absorbs; how it "
        "is bent and gathered, photon tracing shows.",
        *(
            f"Glass “{n}” is not closed, so its tint is left out; give it a thickness."
            for n in flat
        ),
    )


def _records(soup: Soup) -> Any:
    """On the device, six floats a triangle: its normal, index, absorption in 1/m, 1 for a sheet."""
    mi = runtime.mitsuba()
    materials = enumerate(body.material for body in soup.bodies)
    own = np.array([(m.ior, m.absorption, not soup.closed(n)) for n, m in materials])
    outward = soup.normals() * soup.orientation[soup.owner, None]
    records = np.concatenate([outward, own[soup.owner]], axis=1)
    return mi.Float(records.astype(np.float32).ravel())


def _crossed(soup: Soup, records: Any, fired: Fired) -> Any:
    """What is left of each ray that is fired, 0..1, once it has crossed all panes."""
    mi = runtime.mitsuba()
    import drjit as dr

    step = dr.opaque(mi.Float, CLOSE * soup.reach)
    direction = fired.ray.d

    def look(
        active: Any, origin: Any, within: Any, s: Any, p: Any, crossings: Any
    ) -> tuple[Any, ...]:
        hit = soup.scene.ray_intersect_preliminary(mi.Ray3f(origin, direction), active=active)
        met = active & hit.is_valid()
        normal, ior, absorption, sheet = _looked_up(records, hit.prim_index, met)
        along = dr.dot(direction, normal)
        cosine = dr.minimum(dr.abs(along), 1)
        refracted = dr.sqrt(1 - (1 - dr.square(cosine)) / dr.square(ior))
        # Of two parallel surfaces the one where the ray leaves counts for both.
        pane, leaving = sheet > 0.5, along > 0
        through = (within + hit.t) * cosine / refracted
        depth = dr.select(pane, 0, absorption * through)
        counts = met & (pane | leaving)
        r_s = dr.square((cosine - ior * refracted) / (cosine + ior * refracted))
        r_p = dr.square((refracted - ior * cosine) / (refracted + ior * cosine))
        s = dr.select(counts, s * _slab(r_s, depth), s)
        p = dr.select(counts, p * _slab(r_p, depth), p)
        forward = hit.t + step
        origin = dr.select(met, dr.fma(direction, forward, origin), origin)
        return met, origin, dr.select(met, step, within), s, p, crossings + dr.select(met, 1, 0)

    def under_way(active: Any, *state: Any) -> Any:
        return active & (state[-1] < MOST)

    one = dr.ones(mi.Float, dr.width(fired.active))
    state = (fired.active, mi.Point3f(fired.ray.o), dr.zeros(mi.Float), one, mi.Float(one), 0)
    state = (*state[:-1], dr.zeros(mi.UInt32, dr.width(one)))
    lost, _, _, s, p, _ = dr.while_loop(state, under_way, look)
    return dr.select(fired.active & ~lost, (s + p) / 2, 0)


def _looked_up(records: Any, triangle: Any, met: Any) -> tuple[Any, Any, Any, Any]:
    mi = runtime.mitsuba()
    import drjit as dr

    first = triangle * 6
    values = [dr.gather(mi.Float, records, first + i, met) for i in range(6)]
    ior = dr.select(met, values[3], 1.5)
    return mi.Vector3f(*values[:3]), ior, values[4], values[5]


def _slab(reflectance: Any, depth: Any) -> Any:
    """What one polarisation keeps in a pane of optical depth ``depth``."""
    import drjit as dr

    kept = dr.exp(-depth)
    return kept * dr.square(1 - reflectance) / (1 - dr.square(kept * reflectance))
