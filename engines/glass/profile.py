"""The relief of printed layers as data: a profile, a texture, and the style that holds both."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..core.errors import FileError, ParameterError
from ..core.files import written
from ..core.parameters import canonical
from ..core.scene import Vector
from .bead import Bead, relief

_SAMPLES = 1024
_FEWEST, _MOST = 8, 1 << 16
_WIDEST = 2048  # a float32 counts the samples of no larger one
_FLAT, _STEP = 1e-4, 0.02
_FLATTENED = 4
_NUMBERS = ("height", "depth", "roughness")


@dataclass(frozen=True, slots=True)
class Profile:
    """How far the surface stands out along one layer.

    ``offsets`` (M,) float64 at the phases i/M: 0 in the valley, 1 at the crest. It repeats itself;
    phase 0 is the lower boundary of the layer. Straight between the samples.
    """

    offsets: Vector

    def at(self, phase: ArrayLike) -> Vector:
        """The offset at ``phase``, any real number, 1 a whole layer; of the same shape."""
        phase = np.asarray(phase, dtype=np.float64)
        place = (phase - np.floor(phase)) * len(self.offsets)
        return np.interp(
            place, np.arange(len(self.offsets) + 1), np.append(self.offsets, self.offsets[0])
        )


@dataclass(frozen=True, slots=True)
class Texture:
    """A patch of roughness that repeats itself both ways.

    ``heights`` (H, W) float64, of mean 0 and RMS 1, row i at i/H of the way up, column j at j/W of
    the way along. ``size`` (2,) in m is the patch's: along the arc, and up. Bilinear in between.
    """

    heights: Vector
    size: Vector

    def at(self, along: ArrayLike, up: ArrayLike) -> Vector:
        """The height at so many patches along and up, any real numbers; of their shape."""
        high, wide = self.heights.shape
        column, across = _cell(along, wide)
        row, above = _cell(up, high)
        low = _mixed(self.heights, row, column, across, wide)
        high_row = _mixed(self.heights, (row + 1) % high, column, across, wide)
        return low + above * (high_row - low)


@dataclass(frozen=True, slots=True)
class Style:
    """A relief to put on walls: drawn, built in, or taken from a scanned sample.

    ``profile`` of the outer face and ``inner`` of the inner, of as many samples; ``texture`` or
    None; and the figures of what it came from, in m: ``height`` of a layer, ``depth`` from valley
    to crest, ``roughness`` as RMS.
    """

    name: str
    profile: Profile
    inner: Profile
    texture: Texture | None
    height: float
    depth: float
    roughness: float

    @property
    def digest(self) -> str:
        """Sixteen hex digits that name what the style holds, at the 7 digits of a float32."""
        digest = hashlib.sha256()
        for key, array in _arrays(self).items():
            digest.update(f"{key}{array.shape}".encode())
            digest.update(array.astype("<f4").tobytes())
        numbers = [canonical(getattr(self, key)) for key in _NUMBERS]
        digest.update(f"{self.name}{numbers}".encode())
        return digest.hexdigest()[:16]

    def save(self, path: Path | str) -> None:
        """Write the style as NPZ, read back equal. Raises FileError where it cannot."""
        path = Path(path)
        if path.suffix.lower() != ".npz":
            raise FileError(f"A style is an .npz file; call it “{path.stem}.npz”.")
        numbers = {key: np.float64(getattr(self, key)) for key in _NUMBERS}
        held = {"name": np.array(self.name), **numbers, **_arrays(self)}
        with written(path) as draft, draft.open("wb") as stream:
            np.savez_compressed(stream, allow_pickle=False, **held)

    @staticmethod
    def load(path: Path | str) -> "Style":
        """The style in an NPZ. Raises FileError where it is missing, damaged or something else."""
        path = Path(path)
        if not path.is_file():
            raise FileError(
                f"There is no relief style “{path}”; read a scan and save its relief, or choose "
                "another file."
            )
        try:
            with np.load(path, allow_pickle=False) as held:
                return _style({key: held[key] for key in held.files})
        except Exception as failed:
            raise FileError(
                f"“{path.name}” is no relief style that a scan left ({failed}); choose another "
                "file, or read the scan again."
            ) from failed


def normalised(offsets: ArrayLike) -> tuple[Profile, float]:
    """A profile from ``offsets`` (M,) in any unit over one layer, and its depth in that unit."""
    values = np.asarray(offsets, dtype=np.float64)
    low, depth = values.min(), float(np.ptp(values))
    return Profile((values - low) / (depth or 1.0)), depth


def texture_of(heights: ArrayLike, size: ArrayLike) -> tuple[Texture, float]:
    """A texture from ``heights`` (H, W) in any unit, and their RMS about the mean in that unit."""
    values = np.asarray(heights, dtype=np.float64)
    values = values - values.mean()
    rms = float(np.sqrt((values**2).mean()))
    return Texture(values / (rms or 1.0), np.array(size, dtype=np.float64)), rms


def profile_of(points: ArrayLike, name: str = "The curve") -> tuple[Profile, float, float]:
    """The profile that a line draws over one layer, and the layer's height and depth in m.

    ``points`` (N, 2) in m from one end of the layer to the other: how far out, how far along; in
    either direction. Straight between them. Raises ParameterError, naming it, where the line
    doubles back, is flat, or its ends would leave a step between one layer and the next.
    """
    line = np.asarray(points, dtype=np.float64)
    if len(line) < 2 or not np.isfinite(line).all():
        raise ParameterError(f"{name} has no line to take a profile from; draw one with two ends.")
    if line[0, 1] > line[-1, 1]:
        line = line[::-1]
    out, along = line.T
    height, depth = float(along[-1] - along[0]), float(np.ptp(out))
    if not (np.diff(along) > 0).all():
        raise ParameterError(
            f"{name} doubles back along the layer; draw it so that every height is passed once, "
            "with X for how far it stands out."
        )
    if depth <= _FLAT * height:
        raise ParameterError(f"{name} is a straight line along the layer; bend it outward.")
    step = float(out[-1] - out[0])
    if abs(step) > _STEP * depth:
        raise ParameterError(
            f"{name} ends {abs(step) * 1e3:.3g} mm from where it starts, a step between layers; "
            "let both ends stand out equally far."
        )
    phase = (along - along[0]) / height
    profile, depth = normalised(
        np.interp(np.arange(_SAMPLES) / _SAMPLES, phase, out - step * phase)
    )
    return profile, height, depth


def scalloped(height: float, depth: float) -> Style:
    """The bead of `bead.relief`: an arc of a circle in a layer of ``height``, ``depth`` in m."""
    bead = Bead(height=height, sag=depth)
    offsets, _ = relief(bead, np.arange(_SAMPLES) * (height / _SAMPLES))
    profile, _ = normalised(offsets)
    return Style("Scalloped", profile, profile, None, height, depth, 0.0)


def flat_bead(height: float, depth: float) -> Style:
    """A pressed bead with a flat face and round shoulders, 1 − |2 phase − 1|⁴."""
    across = 2 * np.arange(_SAMPLES) / _SAMPLES - 1
    profile = Profile(1 - across**_FLATTENED)
    return Style("Flat", profile, profile, None, height, depth, 0.0)


STYLES = {"scalloped": scalloped, "flat": flat_bead}
"""The built-in styles, each for a layer height and a depth in m."""


def _cell(place: ArrayLike, count: int) -> tuple[np.ndarray, Vector]:
    """The sample at or before each place, and the share of the way to the next."""
    place = np.asarray(place, dtype=np.float64)
    place = (place - np.floor(place)) * count
    cell = np.minimum(place.astype(np.intp), count - 1)
    return cell, place - cell


def _mixed(
    heights: Vector, row: np.ndarray, column: np.ndarray, across: Vector, wide: int
) -> Vector:
    left, right = heights[row, column], heights[row, (column + 1) % wide]
    return left + across * (right - left)


def _arrays(style: Style) -> dict[str, Vector]:
    arrays = {"profile": style.profile.offsets, "inner": style.inner.offsets}
    if style.texture is not None:
        arrays |= {"texture": style.texture.heights, "size": style.texture.size}
    return arrays


def _style(held: dict[str, np.ndarray]) -> Style:
    """The style in the arrays of a file. Raises ValueError where it is none."""
    lost = {"name", "profile", "inner", *_NUMBERS} - held.keys()
    if lost:
        raise ValueError(f"it has no {min(lost)}")
    numbers = {key: float(held[key]) for key in _NUMBERS}
    if not (0 < numbers["height"] < np.inf and all(0 <= n < np.inf for n in numbers.values())):
        raise ValueError("its sizes are not positive")
    texture = None
    if "texture" in held:
        texture = Texture(held["texture"].astype(np.float64), held["size"].astype(np.float64))
        _check_texture(texture)
    profiles = [Profile(held[key].astype(np.float64)) for key in ("profile", "inner")]
    for profile in profiles:
        _check_profile(profile)
    if len(profiles[0].offsets) != len(profiles[1].offsets):
        raise ValueError("its two profiles differ in their number of samples")
    return Style(str(held["name"]), profiles[0], profiles[1], texture, **numbers)


def _check_profile(profile: Profile) -> None:
    values = profile.offsets
    if values.ndim != 1 or not _FEWEST <= len(values) <= _MOST:
        raise ValueError(f"a profile has {_FEWEST} to {_MOST} samples")
    if not np.isfinite(values).all() or values.min() < -1e-6 or values.max() > 1 + 1e-6:
        raise ValueError("a profile lies between 0 and 1")


def _check_texture(texture: Texture) -> None:
    heights, size = texture.heights, texture.size
    if heights.ndim != 2 or not heights.size or max(heights.shape) > _WIDEST:
        raise ValueError(f"a texture has at most {_WIDEST} × {_WIDEST} samples")
    if size.shape != (2,) or not (np.isfinite(size).all() and (size > 0).all()):
        raise ValueError("a texture has a size along and up")
    if not np.isfinite(heights).all():
        raise ValueError("a texture has a height that is not a number")
