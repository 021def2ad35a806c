"""Relief on any wall, as arrays: what the live modifier “Print Layers” does, for batches and data.

The two agree to 1 µm. Phases, textures and sides are told in the same words in both, so that a
change here is made in addon/bridge/print_graph.py too.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from ..core.errors import ParameterError
from ..core.normals import corner_normals
from ..core.parameters import param
from ..core.scene import Mesh, Vector
from .profile import STYLES, Style
from .skin import Skin

CREASE = np.radians(60.0)
"""The relief is shaded smooth where its faces turn by less, in radians."""

SHIFTS = (np.float32(0.6180339887), np.float32(0.7548776662))
"""How far along and up a patch of roughness moves from one seed to the next: the golden ratio and
the plastic number [Roberts 2018], so that no two seeds of 0 to 1000 come near one another."""

OPPOSITE = 0.5
"""How far, of a patch, the inner face's roughness is from the outer's: one not the other's echo."""

_WHERE = "glass.relief"
_PEAKS = 3.0  # a normal height exceeds this many times its RMS once in 370


@dataclass(frozen=True, slots=True, kw_only=True)
class Relief:
    """What the layers of a print leave on a wall."""

    style: Literal["scalloped", "flat", "scan"] = param(
        "scalloped", help="Cross-section of a layer: round, pressed flat, or from a file"
    )
    file: str = param("", help="Style that a scan or a drawn curve was saved as (.npz)")
    height: float = param(5.0e-3, "m", 5e-4, 2e-2, "Layer height")
    amplitude: float = param(1.2e-3, "m", 0.0, 5e-3, "How deep the relief is, valley to crest")
    crest: float = param(
        1.0, "", 0.0, 1.0, "Where the wall's own surface lies: 1 at the crests, 0 in the valleys"
    )
    spiral: bool = param(True, help="Layers rise steadily around, or are stacked level")
    roughness: float = param(0.0, "m", 0.0, 1e-3, "Roughness over the layers, RMS")
    seed: int = param(0, "", 0, 1000, "Which part of the roughness lies where")
    sides: Literal["outer", "inner", "both"] = param("both", help="Faces of the wall that have it")
    base: float = param(0.0, "m", -10.0, 10.0, "Height at which the first layer starts")


def chosen_style(relief: Relief) -> Style:
    """The style that a record names, built in or loaded.

    Raises ParameterError where a file is needed and not named, FileError where it is no style.
    """
    if relief.style in STYLES:
        return STYLES[relief.style](relief.height, relief.amplitude)
    if not relief.file:
        raise ParameterError(
            f"[{_WHERE}] The style “{relief.style}” needs a file; read a scan and save its relief, "
            f"then name it, or take {' or '.join(STYLES)}."
        )
    return Style.load(Path(relief.file))


def check_relief(relief: Relief, thickness: float | None = None) -> None:
    """Raise ParameterError where a relief does not fit its layer, or a wall ``thickness`` in m.

    A bead is at most half as deep as it is high: beyond, its round side would hang over the next.
    """
    depth = relief.amplitude
    if depth > relief.height / 2:
        raise ParameterError(
            f"[{_WHERE}] The relief is {_mm(depth)} deep, more than half its layer of "
            f"{_mm(relief.height)}; lower the amplitude to {_mm(relief.height / 2)} or less."
        )
    faces = 2 if relief.sides == "both" else 1
    taken = faces * (relief.crest * depth + _PEAKS * relief.roughness)
    if thickness is not None and taken >= thickness:
        raise ParameterError(
            f"[{_WHERE}] The relief takes {_mm(taken)} of a wall of {_mm(thickness)}, so that "
            f"nothing is left; lower the amplitude or take a wall above {_mm(taken)}."
        )


def relieve(
    vertices: Vector, skin: Skin, relief: Relief, style: Style, mask: Vector | None = None
) -> Vector:
    """The vertices (V, 3) of a smooth wall with the relief on it, in m.

    Each moves along its horizontal normal by amplitude · (profile(phase) − crest) + roughness ·
    texture(arc, z), outward on the outer face and inward on the inner, times ``mask`` (V,). The
    phase is (z − base) ÷ height, less a turn for each time around in a spiral. The texture goes a
    whole number of times around.
    """
    z = vertices[:, 2] - relief.base
    inner = skin.side < 0
    phase = z / relief.height - (skin.turn if relief.spiral else 0.0)
    stands = np.where(inner, style.inner.at(phase), style.profile.at(phase))
    offset = relief.amplitude * (stands - relief.crest)
    if style.texture is not None and relief.roughness > 0:
        around = max(1.0, np.floor(skin.girth / style.texture.size[0] + 0.5))
        along, up = shifts(relief.seed)
        along += skin.turn * around + OPPOSITE * inner
        offset += relief.roughness * style.texture.at(along, up + z / style.texture.size[1])
    on_outer, on_inner = relief.sides != "inner", relief.sides != "outer"
    offset *= skin.side * np.where(inner, on_inner, on_outer)
    if mask is not None:
        offset *= mask
    moved = vertices.copy()
    moved[:, :2] += offset[:, None] * skin.normal
    return moved


def relieved(
    mesh: Mesh, skin: Skin, relief: Relief, style: Style, mask: Vector | None = None
) -> Mesh:
    """The mesh of a smooth wall with the relief on it, shaded smooth but for creases of 60°."""
    bare = Mesh(relieve(mesh.vertices, skin, relief, style, mask), mesh.faces)
    return Mesh(bare.vertices, bare.faces, corner_normals(bare, CREASE))


def shifts(seed: int) -> tuple[float, float]:
    """How far the texture is moved along and up, in patches; to the last bit of a float32."""
    along, up = (np.float32(seed) * shift for shift in SHIFTS)
    return float(along - np.floor(along)), float(up - np.floor(up))


def _mm(metres: float) -> str:
    return f"{metres * 1e3:.4g} mm"
