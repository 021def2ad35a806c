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
from ..core.glazing import goes_by_transmittance, highest_transmittance, normal_depth
from ..core.progress import SILENT, Progress
from ..core.scene import Body, Material
from . import bits
from .occlusion import is_pane
from .rays import Fired, Rays
from .soup import Soup

MOST = 32
"""Surfaces of glass that a ray may cross; behind more it is dark."""
TINY = 1e-12
"""The least cosine² in the glass; it is met only where glass refracts as air does."""
LONG = 5e-7
"""Of a ray's way to where it meets something: how far off single precision may find that."""
_RECORD = 7


def transmittances(
    soup: Soup, rays: Rays, among: bits.Bits, progress: Progress = SILENT
) -> NDArray[np.uint16] | None:
    """What the panes let through of each ray ``among`` (N, ceil(D / 8)): (N, D) of bits.FULL.

    A closed body is glass between the surface where the ray enters and that where it leaves; a
    sheet is a pane by itself, whose tint is known from its transmittance alone. 0 where no ray is;
    None without panes.
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
    """What to tell of the panes among bodies: that rays stay straight, whose tint is left out."""
    glass = [(n, body) for n, body in enumerate(soup.bodies) if is_pane(body.material)]
    if not glass:
        return ()
    flat = [body.name for n, body in glass if tint(body.material) > 0 and not soup.closed(n)]
    return (
        "Sun goes straight through clear glass here, less what that reflects and absorbs, which is "
        "lost; how it is bent, gathered and thrown back, photon tracing shows.",
        *(
            f"Glass “{n}” is not closed, so its tint is left out; give it a thickness or a "
            "transmittance."
            for n in flat
        ),
        *(_too_clear(body) for _, body in glass if _is_too_clear(body.material)),
    )


def tint(material: Material) -> float:
    """A pane's tint, as `slab` has it: absorption in 1/m, or less than 0 an optical depth."""
    return -normal_depth(material) if goes_by_transmittance(material) else material.absorption


def _is_too_clear(material: Material) -> bool:
    clear = highest_transmittance(material.ior)
    return goes_by_transmittance(material) and material.transmittance > clear


def _too_clear(body: Body) -> str:
    clear = 100 * highest_transmittance(body.material.ior)
    return (
        f"Glass “{body.name}” lets {clear:.1f} % through at normal incidence, the most that its "
        "index allows; lower the index for a coated one."
    )


def _records(soup: Soup) -> Any:
    """On the device, a triangle's normal, index, `tint`, 1 for a sheet, step in m."""
    mi = runtime.mitsuba()
    materials = enumerate(body.material for body in soup.bodies)
    own = np.array([(m.ior, tint(m), not soup.closed(n)) for n, m in materials])
    outward = soup.normals() * soup.orientation[soup.owner, None]
    records = np.concatenate([outward, own[soup.owner], soup.steps()[:, None]], axis=1)
    return mi.Float(records.astype(np.float32).ravel())


def _crossed(soup: Soup, records: Any, fired: Fired) -> Any:
    """What is left of each ray that is fired, 0..1, once it has crossed all panes."""
    mi = runtime.mitsuba()
    import drjit as dr

    direction = fired.ray.d
    lanes = dr.width(fired.active)

    def under_way(active: Any, origin: Any, behind: Any, s: Any, p: Any, crossed: Any) -> Any:
        return active & (crossed < MOST)

    def cross(
        active: Any, origin: Any, behind: Any, s: Any, p: Any, crossed: Any
    ) -> tuple[Any, ...]:
        hit = soup.scene.ray_intersect_preliminary(mi.Ray3f(origin, direction), active=active)
        met = active & hit.is_valid()
        kept_s, kept_p, step = _kept(records, direction, hit, behind, met)
        onward = dr.fma(direction, hit.t + step, origin)
        return (
            met,
            dr.select(met, onward, origin),
            dr.select(met, step, behind),
            s * kept_s,
            p * kept_p,
            crossed + dr.select(met, mi.UInt32(1), 0),
        )

    state = (
        fired.active,
        fired.ray.o,
        dr.zeros(mi.Float, lanes),
        dr.ones(mi.Float, lanes),
        dr.ones(mi.Float, lanes),
        dr.zeros(mi.UInt32, lanes),
    )
    lost, _, _, s, p, _ = dr.while_loop(state, under_way, cross)
    return dr.select(fired.active & ~lost, (s + p) / 2, 0)


def _kept(records: Any, direction: Any, hit: Any, behind: Any, met: Any) -> tuple[Any, Any, Any]:
    """What s- and p-polarised light keep where rays meet glass, ``behind`` m past the last time;
    and the step off it."""
    mi = runtime.mitsuba()
    import drjit as dr

    first = hit.prim_index * _RECORD
    x, y, z, ior, absorption, sheet, step = (
        dr.gather(mi.Float, records, first + i, met) for i in range(_RECORD)
    )
    along = dr.dot(direction, mi.Vector3f(x, y, z))
    kept_s, kept_p = slab(along, ior, absorption, sheet > 0, behind + hit.t)
    counts = met & ((sheet > 0) | (along > 0))
    step = dr.maximum(step, LONG * hit.t)
    return dr.select(counts, kept_s, 1), dr.select(counts, kept_p, 1), step


def slab(along: Any, ior: Any, absorption: Any, sheet: Any, way: Any) -> tuple[Any, Any]:
    """What s- and p-polarised light keep in a pane, its two surfaces together, on the device.

    ``along`` is the cosine with the pane's normal, ``way`` the straight path through it in m; a
    ``sheet`` has none. An ``absorption`` below 0 is an optical depth straight across instead,
    whatever the way. A solid's two surfaces count where the ray leaves, both at the angle there.
    """
    import drjit as dr

    cosine = dr.minimum(dr.abs(along), 1)
    refracted = dr.sqrt(dr.maximum(1 - (1 - dr.square(cosine)) / dr.square(ior), TINY))
    depth = dr.select(sheet, 0, absorption * way * cosine / refracted)
    depth = dr.select(absorption < 0, -absorption / refracted, depth)
    r_s = dr.square((cosine - ior * refracted) / (cosine + ior * refracted))
    r_p = dr.square((refracted - ior * cosine) / (refracted + ior * cosine))
    return _slab(r_s, depth), _slab(r_p, depth)


def _slab(reflectance: Any, depth: Any) -> Any:
    """What one polarisation keeps in a pane of optical depth ``depth``."""
    import drjit as dr

    kept = dr.exp(-depth)
    return kept * dr.square(1 - reflectance) / (1 - dr.square(kept * reflectance))
