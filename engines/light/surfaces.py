"""What a photon does where it meets a surface.

Every choice is made by chance with its own probability, so a photon's weight stays. Directions are
unit vectors; a `Polarisation` travels along where the Fresnel terms are exact, else (). The records
are plain dataclasses because Dr.Jit's loops and selects reach into those.
"""

from dataclasses import dataclass
from typing import Any

from ..core import runtime

mi = runtime.mitsuba()
import drjit as dr  # noqa: E402  (loads LLVM: only after the runtime has chosen which)

Float, Bool = mi.Float, mi.Bool


@dataclass
class Meeting:
    """A photon at a surface: ``smooth`` is the interpolated outward normal, ``flat`` the face's.

    ``outside`` tells the side that it comes from. Both normals agree about it. ``ior`` is the
    index on the inner side over that on the outer one; ``roughness`` the GGX width α, or () where
    nothing is rough.
    """

    direction: Any
    smooth: Any
    flat: Any
    outside: Any
    ior: Any
    reflectance: Any
    specularity: Any
    roughness: Any
    random: Any
    active: Any
    light: Any

    def chance(self) -> Any:
        """An even random number in 0..1."""
        return self.random.next_float32(self.active)


@dataclass
class Outcome:
    """Where the photon goes on, if ``through`` the surface, ``absorbed``, or made ``matte``."""

    direction: Any
    through: Any
    absorbed: Any
    matte: Any
    light: Any


@dataclass
class Polarisation:
    """Stokes parameters over intensity, (q, u, w), in the frame of ``axis`` across the ray.

    q = |E₁|² − |E₂|², u = 2 Re E₁E₂*, w = 2 Im E₁E₂* with axis 1 = ``axis``, 2 = ray × ``axis``.
    """

    axis: Any
    q: Any
    u: Any
    w: Any


def rough_scene(meeting: Meeting) -> bool:
    """Whether any surface of the scene has facets."""
    return not isinstance(meeting.roughness, tuple)


def unpolarised(direction: Any) -> Polarisation:
    """Natural light along ``direction``."""
    frame = mi.Frame3f(direction)
    zero = dr.zeros(Float, dr.width(direction))
    return Polarisation(frame.s, zero, zero, zero)


def dielectric(meeting: Meeting) -> Outcome:
    """Reflect or refract by Fresnel's equations, on a facet of the surface where it is rough.

    Where the smooth normal would send the photon to the wrong side of the face, the face's own
    normal decides. What a rough surface hides from itself is absorbed.
    """
    chance = meeting.chance()
    fresnel = _exact if meeting.light else _averaged
    facet, rough = _facet(meeting)
    direction, through, light = fresnel(meeting, facet, chance)
    beyond = (dr.dot(direction, meeting.flat) < 0) == meeting.outside
    wrong = (beyond != through) & ~rough
    redone = fresnel(meeting, meeting.flat, chance)
    direction, through, light = dr.select(wrong, redone, (direction, through, light))
    hidden = Bool(False)
    if rough_scene(meeting):
        hidden = rough & ((beyond != through) | _hidden(meeting, direction, facet))
    return Outcome(direction, through & ~hidden, hidden, Bool(False), light)


def _facet(meeting: Meeting) -> tuple[Any, Any]:
    """The outward normal of the facet that a photon meets, and whether the surface has facets.

    Facets are drawn as they are seen from the photon's side [Heitz & d'Eon 2014, GGX].
    """
    if not rough_scene(meeting):
        return meeting.smooth, Bool(False)
    rough = meeting.roughness > 0
    side = dr.select(meeting.outside, meeting.smooth, -meeting.smooth)
    frame = mi.Frame3f(side)
    point = mi.Point2f(meeting.chance(), meeting.chance())
    facet, _ = _facets(meeting).sample(frame.to_local(-meeting.direction), point)
    facet = frame.to_world(facet)
    outward = dr.select(meeting.outside, facet, -facet)
    return dr.select(rough, outward, meeting.smooth), rough


def _facets(meeting: Meeting) -> Any:
    return mi.MicrofacetDistribution(mi.MicrofacetType.GGX, dr.maximum(meeting.roughness, 1e-4))


def _hidden(meeting: Meeting, direction: Any, facet: Any) -> Any:
    """Whether other facets are in the way out: by chance, with Smith's probability."""
    frame = mi.Frame3f(meeting.smooth)
    seen = _facets(meeting).smith_g1(frame.to_local(direction), frame.to_local(facet))
    return meeting.chance() >= seen


def _averaged(meeting: Meeting, normal: Any, chance: Any) -> tuple[Any, Any, Any]:
    """The Fresnel reflectance averaged over both polarisations, at each surface anew."""
    cos_in = -dr.dot(meeting.direction, normal)
    reflectance, cos_out, _, eta = mi.fresnel(cos_in, meeting.ior)
    through = chance >= reflectance
    reflected = meeting.direction + 2 * cos_in * normal
    refracted = eta * meeting.direction + (cos_in * eta + cos_out) * normal
    return dr.normalize(dr.select(through, refracted, reflected)), through, ()


def _exact(meeting: Meeting, normal: Any, chance: Any) -> tuple[Any, Any, Polarisation]:
    """Fresnel's amplitudes on the Stokes vector [Born & Wolf, Principles of Optics, §1.5]."""
    light = _turned(meeting.light, meeting.direction, normal)
    inward = dr.select(meeting.outside, normal, -normal)
    cos_i = -dr.dot(meeting.direction, inward)
    eta = dr.select(meeting.outside, meeting.ior, dr.rcp(meeting.ior))
    sin2 = (1 - cos_i * cos_i) / (eta * eta)
    total = sin2 >= 1
    cos_t = dr.sqrt(dr.abs(1 - sin2))
    # Real amplitudes below the critical angle; above it both have modulus 1 and differ in phase:
    # r_s = exp(-2i a), r_p = exp(-2i b), tan a = η q / cos θ, tan b = q / (η cos θ), q = cos_t.
    r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t)
    r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t)
    power_s = dr.select(total, 1, r_s * r_s)
    power_p = dr.select(total, 1, r_p * r_p)
    phase = 2 * (dr.atan2(cos_t, eta * cos_i) - dr.atan2(eta * cos_t, cos_i))
    sin_phase, cos_phase = dr.sincos(phase)
    cross_re = dr.select(total, cos_phase, r_s * r_p)
    cross_im = dr.select(total, sin_phase, 0)
    mean, half = (power_s + power_p) / 2, (power_s - power_p) / 2
    reflectance = mean + half * light.q
    through = chance >= reflectance
    scale = dr.rcp(dr.select(through, 1 - reflectance, reflectance))
    passed = dr.sqrt((1 - power_s) * (1 - power_p))
    q = dr.select(through, (1 - mean) * light.q - half, mean * light.q + half) * scale
    u = dr.select(through, passed * light.u, cross_re * light.u - cross_im * light.w) * scale
    w = dr.select(through, passed * light.w, cross_im * light.u + cross_re * light.w) * scale
    refracted = meeting.direction / eta + (cos_i / eta - cos_t) * inward
    reflected = meeting.direction + 2 * cos_i * inward
    direction = dr.normalize(dr.select(through, refracted, reflected))
    return direction, through, Polarisation(light.axis, q, u, w)


def mirror(meeting: Meeting) -> Outcome:
    """Reflect, on a facet where it is rough, or absorb the share that a mirror does not return."""
    facet, rough = _facet(meeting)
    direction, light = _shine(meeting, facet, rough)
    absorbed = meeting.chance() >= meeting.reflectance
    if rough_scene(meeting):
        below = (dr.dot(direction, meeting.flat) > 0) != meeting.outside
        absorbed |= rough & (below | _hidden(meeting, direction, facet))
    return Outcome(direction, Bool(False), absorbed, Bool(False), light)


def diffuse(meeting: Meeting) -> Outcome:
    """Scatter by Lambert's law, or absorb."""
    above = dr.select(meeting.outside, meeting.flat, -meeting.flat)
    point = mi.Point2f(meeting.chance(), meeting.chance())
    direction = mi.Frame3f(above).to_world(mi.warp.square_to_cosine_hemisphere(point))
    light = unpolarised(direction) if meeting.light else ()
    absorbed = meeting.chance() >= meeting.reflectance
    return Outcome(direction, Bool(False), absorbed, Bool(True), light)


def plastic(meeting: Meeting) -> Outcome:
    """Radiance's smooth plastic: ``specularity`` shines, the rest meets a matte surface."""
    gloss = meeting.chance() < meeting.specularity
    direction, light = _shine(meeting, meeting.smooth, Bool(False))
    shone = Outcome(direction, Bool(False), Bool(False), Bool(False), light)
    return dr.select(gloss, shone, diffuse(meeting))


def absorber(meeting: Meeting) -> Outcome:
    """Take every photon."""
    return Outcome(meeting.direction, Bool(False), Bool(True), Bool(False), meeting.light)


SCATTER = {
    "dielectric": dielectric,
    "mirror": mirror,
    "diffuse": diffuse,
    "plastic": plastic,
    "absorber": absorber,
}


def _shine(meeting: Meeting, normal: Any, rough: Any) -> tuple[Any, Any]:
    """The direction mirrored by ``normal``.

    Where that would dive below a face that is not rough, the face's own mirror image.
    """
    direction = meeting.direction

    def mirrored(normal: Any) -> Any:
        return direction - 2 * dr.dot(direction, normal) * normal

    shone = mirrored(normal)
    dives = ((dr.dot(shone, meeting.flat) > 0) != meeting.outside) & ~rough
    shone = dr.select(dives, mirrored(meeting.flat), shone)
    if not meeting.light:
        return shone, ()
    # A perfect conductor: r_s = −1, r_p = 1.
    light = _turned(meeting.light, direction, normal)
    return shone, Polarisation(light.axis, light.q, -light.u, -light.w)


def _turned(light: Polarisation, direction: Any, normal: Any) -> Polarisation:
    """The same light in the frame whose first axis stands on the plane of incidence."""
    across = dr.cross(direction, normal)
    length = dr.norm(across)
    axis = dr.select(length > 1e-6, across / length, light.axis)
    cos = dr.dot(light.axis, axis)
    sin = dr.dot(dr.cross(direction, light.axis), axis)
    cos2, sin2 = cos * cos - sin * sin, 2 * sin * cos
    return Polarisation(
        axis, light.q * cos2 + light.u * sin2, light.u * cos2 - light.q * sin2, light.w
    )
