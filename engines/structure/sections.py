"""Cross-sections as arrays: many at once, with everything that analysis and checks ask of them.

Shear areas are Timoshenko's, from the strain energy of Jourawski's shear stress: I² ÷ ∫ S²/t ds
(Pilkey 2002, ch. 6; the same as Cowper 1966 with ν = 0), 5/6 of a rectangle. Those of thin-walled
sections are taken on the middle line of the walls without the fillets, which is on the soft side.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..core.errors import ParameterError
from ..core.scene import Vector
from .section_parts import (
    CORNER_AREA,
    CORNER_CENTROID,
    CORNER_INERTIA,
    rounded_area,
    rounded_inertia,
    rounded_plastic,
    two_webs,
)

Shape = Literal["rhs", "chs", "i", "rectangle"]
SHAPES: tuple[Shape, ...] = ("rhs", "chs", "i", "rectangle")

_TERMS = np.arange(1, 60, 2.0)  # of Saint-Venant's series: J to 1e-8


@dataclass(frozen=True, slots=True)
class Sections:
    """S cross-sections; each field (S,). y is the strong axis: the height is measured along z.

    ``name`` (S,) text; ``shape`` (S,) int8, an index into SHAPES; ``height``, ``width``, ``web``
    and ``flange`` (thicknesses of the parts along z and along y), ``radius`` (outer corner of an
    RHS, root of an I) in m, 0 where there is none.

    ``area`` in m²; ``inertia_y``, ``inertia_z`` and ``torsion`` (J of Saint-Venant) in m⁴;
    ``shear_y`` and ``shear_z``: Timoshenko shear areas in m²; ``elastic_y``, ``elastic_z``,
    ``plastic_y``, ``plastic_z``: section moduli and ``torsion_modulus`` (T ÷ τ_max) in m³;
    ``perimeter`` in m.
    """

    name: NDArray[np.str_]
    shape: NDArray[np.int8]
    height: Vector
    width: Vector
    web: Vector
    flange: Vector
    radius: Vector
    area: Vector
    inertia_y: Vector
    inertia_z: Vector
    torsion: Vector
    shear_y: Vector
    shear_z: Vector
    elastic_y: Vector
    elastic_z: Vector
    plastic_y: Vector
    plastic_z: Vector
    torsion_modulus: Vector
    perimeter: Vector

    def __len__(self) -> int:
        return len(self.area)

    def take(self, index: NDArray[np.integer] | NDArray[np.bool_] | slice) -> "Sections":
        """The sections at ``index``, repeated as often as it says."""
        return Sections(*(getattr(self, f.name)[index] for f in fields(self)))

    def named(self, names: Sequence[str]) -> "Sections":
        """The same sections under other names, one for each."""
        return replace(self, name=np.array(names, dtype=np.str_).reshape(len(self)))


def joined_sections(parts: Sequence[Sections]) -> Sections:
    """The sections of all parts, one after the other."""
    return Sections(
        *(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(Sections))
    )


def rectangular_hollow(
    height: ArrayLike, width: ArrayLike, thickness: ArrayLike, radius: ArrayLike | None = None
) -> Sections:
    """Square and rectangular hollow sections of one wall thickness; lengths in m, any shapes.

    ``radius`` is that of the outer corners: 0 sharp, None 1.5 times the thickness as the tables of
    EN 10210-2 have it. That of the inner ones follows: 1.0 times with it, and the outer one less
    the thickness where that is more, as in EN 10219-2.

    Exact but for torsion and its modulus, which are EN 10210-2 Annex B as in its tables: 1 to 3 %
    below finite elements, with sharp corners up to 6 % (50×50×10 mm), the less the thinner.

    Raises ParameterError for the first section that cannot be.
    """
    if radius is None:
        radius = 1.5 * np.asarray(thickness, dtype=np.float64)
    h, b, t, outer = _columns(height, width, thickness, radius)
    rows = zip(h, b, t, strict=True)
    names = [f"{'SHS' if h == b else 'RHS'} {_mm(h)}×{_mm(b)}×{_mm(t)}" for h, b, t in rows]
    good = (h > 0) & (b > 0) & (t > 0) & (outer >= 0) & np.isfinite(h + b + t + outer)
    _check(names, good, "needs a height, width and thickness")
    _check(names, 2 * t < np.minimum(h, b), "has walls that fill it: make them thinner")
    inner = np.maximum(outer - t, np.minimum(outer / 1.5, t))
    room = np.minimum(np.minimum(h, b) / 2 - outer, np.minimum(h, b) / 2 - t - inner)
    _check(names, room > -1e-9, "has corners that are too round: make the radius smaller")

    area = rounded_area(h, b, outer) - rounded_area(h - 2 * t, b - 2 * t, inner)
    inertia_y = rounded_inertia(h, b, outer) - rounded_inertia(h - 2 * t, b - 2 * t, inner)
    inertia_z = rounded_inertia(b, h, outer) - rounded_inertia(b - 2 * t, h - 2 * t, inner)
    middle = (outer + inner) / 2
    around = 2 * (h + b - 2 * t) - 2 * (4 - np.pi) * middle
    enclosed = (h - t) * (b - t) - (4 - np.pi) * middle**2
    lever = 2 * enclosed * t / around
    torsion = t**3 * around / 3 + 2 * lever * enclosed
    return Sections(
        name=np.array(names, dtype=np.str_),
        shape=_shape("rhs", h),
        height=h,
        width=b,
        web=t,
        flange=t,
        radius=outer,
        area=area,
        inertia_y=inertia_y,
        inertia_z=inertia_z,
        torsion=torsion,
        shear_y=two_webs(b - t, h - t, t, t),
        shear_z=two_webs(h - t, b - t, t, t),
        elastic_y=2 * inertia_y / h,
        elastic_z=2 * inertia_z / b,
        plastic_y=rounded_plastic(h, b, outer) - rounded_plastic(h - 2 * t, b - 2 * t, inner),
        plastic_z=rounded_plastic(b, h, outer) - rounded_plastic(b - 2 * t, h - 2 * t, inner),
        torsion_modulus=torsion / (t + lever / t),
        perimeter=2 * (h + b) - 2 * (4 - np.pi) * outer,
    )


def circular_hollow(diameter: ArrayLike, thickness: ArrayLike) -> Sections:
    """Circular hollow sections by outer diameter and wall thickness; lengths in m, any shapes.

    All exact (EN 10210-2 Annex B); shear areas after Cowper (1966). ``height`` and ``width`` are
    the diameter, ``web`` and ``flange`` the thickness.

    Raises ParameterError for the first section that cannot be.
    """
    d, t = _columns(diameter, thickness)
    names = [f"CHS {_mm(d)}×{_mm(t)}" for d, t in zip(d, t, strict=True)]
    _check(names, (d > 0) & (t > 0) & np.isfinite(d + t), "needs a diameter and a thickness")
    _check(names, 2 * t < d, "has walls that fill it: make them thinner")

    inside = d - 2 * t
    area = np.pi / 4 * (d**2 - inside**2)
    inertia = np.pi / 64 * (d**4 - inside**4)
    plastic = (d**3 - inside**3) / 6
    square = (inside / d) ** 2
    shear = area * 6 * (1 + square) ** 2 / (7 * (1 + square) ** 2 + 20 * square)
    return Sections(
        name=np.array(names, dtype=np.str_),
        shape=_shape("chs", d),
        height=d,
        width=d,
        web=t,
        flange=t,
        radius=np.zeros_like(d),
        area=area,
        inertia_y=inertia,
        inertia_z=inertia,
        torsion=2 * inertia,
        shear_y=shear,
        shear_z=shear,
        elastic_y=2 * inertia / d,
        elastic_z=2 * inertia / d,
        plastic_y=plastic,
        plastic_z=plastic,
        torsion_modulus=4 * inertia / d,
        perimeter=np.pi * d,
    )


def i_section(
    height: ArrayLike, width: ArrayLike, web: ArrayLike, flange: ArrayLike, radius: ArrayLike
) -> Sections:
    """Rolled I and H sections with parallel flanges and root radius; lengths in m, any shapes.

    Exact but for torsion, which is the formula behind the tables of EN 10365 (El Darwish and
    Johnston 1965): 2/3 (b − 0.63 t_f) t_f³ + 1/3 (h − 2 t_f) t_w³ + 2 α D⁴ with D the circle
    inscribed where web and flange meet. Its modulus, J ÷ the thicker part, has no notch effect.

    Raises ParameterError for the first section that cannot be.
    """
    h, b, w, f, r = _columns(height, width, web, flange, radius)
    rows = zip(h, b, w, f, strict=True)
    names = [f"I {_mm(h)}×{_mm(b)}×{_mm(w)}×{_mm(f)}" for h, b, w, f in rows]
    good = (h > 0) & (b > 0) & (w > 0) & (f > 0) & (r >= 0) & np.isfinite(h + b + w + f + r)
    _check(names, good, "needs a height, width, web and flange")
    _check(names, (w < b) & (2 * f < h), "has a web or flanges that fill it: make them thinner")
    room = np.minimum((b - w) / 2, h / 2 - f) - r
    _check(names, room > -1e-9, "has roots that are too round: make the radius smaller")

    clear = h - 2 * f
    corner = CORNER_AREA * r**2
    aside, below = w / 2 + CORNER_CENTROID * r, clear / 2 - CORNER_CENTROID * r
    own = 4 * CORNER_INERTIA * r**4
    inertia_y = (b * h**3 - (b - w) * clear**3) / 12 + own + 4 * corner * below**2
    inertia_z = (2 * f * b**3 + clear * w**3) / 12 + own + 4 * corner * aside**2
    inscribed = ((r + w / 2) ** 2 + (r + f) ** 2 - r**2) / (2 * r + f)
    junction = w / f * (0.145 + 0.1 * r / f) * inscribed**4
    torsion = 2 / 3 * (b - 0.63 * f) * f**3 + clear * w**3 / 3 + 2 * junction
    return Sections(
        name=np.array(names, dtype=np.str_),
        shape=_shape("i", h),
        height=h,
        width=b,
        web=w,
        flange=f,
        radius=r,
        area=2 * b * f + clear * w + 4 * corner,
        inertia_y=inertia_y,
        inertia_z=inertia_z,
        torsion=torsion,
        shear_y=5 / 3 * b * f,
        shear_z=two_webs(h - f, b, w / 2, f),
        elastic_y=2 * inertia_y / h,
        elastic_z=2 * inertia_z / b,
        plastic_y=w * clear**2 / 4 + b * f * (h - f) + 4 * corner * below,
        plastic_z=b**2 * f / 2 + clear * w**2 / 4 + 4 * corner * aside,
        torsion_modulus=torsion / np.maximum(w, f),
        perimeter=4 * b + 2 * h - 2 * w - 2 * (4 - np.pi) * r,
    )


def rectangle(height: ArrayLike, width: ArrayLike) -> Sections:
    """Solid rectangles; lengths in m, any shapes.

    Torsion and its modulus by Saint-Venant's series (Timoshenko and Goodier, art. 109).

    Raises ParameterError for the first section that cannot be.
    """
    h, b = _columns(height, width)
    names = [f"{_mm(h)}×{_mm(b)}" for h, b in zip(h, b, strict=True)]
    _check(names, (h > 0) & (b > 0) & np.isfinite(h + b), "needs a height and a width")

    long, short = np.maximum(h, b), np.minimum(h, b)
    decay = np.pi / 2 * (long / short)[:, None] * _TERMS
    edge = (np.tanh(decay) / _TERMS**5).sum(axis=1)
    torsion = long * short**3 / 3 * (1 - 192 / np.pi**5 * short / long * edge)
    falloff = 2 * np.exp(-decay) / (1 + np.exp(-2 * decay))  # 1/cosh, which would overflow
    steepest = short * (1 - 8 / np.pi**2 * (falloff / _TERMS**2).sum(axis=1))
    area = h * b
    nothing = np.zeros_like(h)
    return Sections(
        name=np.array(names, dtype=np.str_),
        shape=_shape("rectangle", h),
        height=h,
        width=b,
        web=nothing,
        flange=nothing,
        radius=nothing,
        area=area,
        inertia_y=b * h**3 / 12,
        inertia_z=h * b**3 / 12,
        torsion=torsion,
        shear_y=5 / 6 * area,
        shear_z=5 / 6 * area,
        elastic_y=b * h**2 / 6,
        elastic_z=h * b**2 / 6,
        plastic_y=b * h**2 / 4,
        plastic_z=h * b**2 / 4,
        torsion_modulus=torsion / steepest,
        perimeter=2 * (h + b),
    )


def _columns(*values: ArrayLike) -> list[Vector]:
    """The values as vectors of one length."""
    arrays = np.broadcast_arrays(*(np.asarray(v, dtype=np.float64) for v in values))
    return [np.array(a.ravel()) for a in arrays]


def _check(names: list[str], good: NDArray[np.bool_], what: str) -> None:
    if not good.all():
        raise ParameterError(f"Section {names[int(np.argmin(good))]} (mm) {what}.")


def _mm(value: float) -> str:
    return f"{1000 * value:.6g}"


def _shape(shape: Shape, like: Vector) -> NDArray[np.int8]:
    return np.full(len(like), SHAPES.index(shape), dtype=np.int8)
