"""The members as lines in space, a layer for each section, as DXF."""

from pathlib import Path

import ezdxf
import numpy as np
from ezdxf import units

from ..core.files import written
from .frame import Frame

_COLOURS = {"steel": 5, "timber": 32}  # AutoCAD's index: blue, brown
_RED = 1
_FORBIDDEN = str.maketrans(dict.fromkeys('<>/\\":;?*|=`,', "_"))


def save_dxf(path: Path, frame: Frame, rows: np.ndarray) -> None:
    """Write the axes of M members in m, ``rows`` (M,) as of `sized.MEMBER`.

    A layer is named by material and section; a member that fails is red. Raises FileError where
    the file cannot be written.
    """
    drawing = ezdxf.new("R2010")  # pyright: ignore[reportPrivateImportUsage]
    drawing.units = units.M
    space = drawing.modelspace()
    ends = frame.ends()
    layers = [f"{row['material']} {row['name']}".translate(_FORBIDDEN) for row in rows]
    for name, first in zip(*np.unique(layers, return_index=True), strict=True):
        drawing.layers.add(str(name), color=_COLOURS.get(str(rows["material"][first]), 7))
    for (start, end), layer, failing in zip(ends.tolist(), layers, rows["failing"], strict=True):
        kept = {"layer": layer} | ({"color": _RED} if failing else {})
        space.add_line(start, end, dxfattribs=kept)
    with written(path) as draft:
        drawing.saveas(draft)
