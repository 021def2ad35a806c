"""Images of data as OpenEXR, with what is known of them in the header.

In memory row 0 is at v = 0, the bottom; an EXR file's first scanline is its top. Rows are flipped
on the way in and out, so that the picture stands upright in every viewer.
"""

import errno
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from .errors import FileError
from .files import written

_ALL = "heliform"  # the attribute that holds all of meta; "heliform.key" repeats its scalars


def save(
    path: Path | str, channels: Mapping[str, NDArray[np.float32]], meta: Mapping[str, Any]
) -> None:
    """Write ``channels``, each (H, W) with row 0 at the bottom, losslessly as float32.

    A channel's name may have layers, "caustic.Y". ``meta`` is anything that JSON can say; its
    scalars also stand as attributes of their own, for other programs to show.

    Raises FileError where the file cannot be written.
    """
    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        _ALL: json.dumps(meta, ensure_ascii=False),
    }
    for key, value in meta.items():
        if isinstance(value, (str, int, float)):
            header[f"{_ALL}.{key}"] = value if isinstance(value, float) else str(value)
    pixels = {
        name: np.ascontiguousarray(values[::-1], dtype=np.float32)
        for name, values in channels.items()
    }
    with written(path) as temporary, OpenEXR.File(header, pixels) as file:
        try:
            file.write(str(temporary))
        except RuntimeError as error:  # what OpenEXR makes of a system's refusal
            raise OSError(errno.EIO, "OpenEXR could not write all of it") from error


def load(path: Path | str) -> tuple[dict[str, NDArray[np.float32]], dict[str, Any]]:
    """Channels, each (H, W) float32 with row 0 at the bottom, and meta, equal to what was saved.

    A file of another program loads with an empty meta. Raises FileError where the file is missing
    or damaged.
    """
    path = Path(path)
    if not path.is_file():
        raise FileError(f"There is no image “{path.name}” in the folder “{path.parent}”.")
    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            meta = json.loads(file.header().get(_ALL, "{}"))
            channels = {
                name: channel.pixels[::-1].astype(np.float32)
                for name, channel in file.channels().items()
            }
    except (RuntimeError, ValueError, TypeError) as error:
        raise FileError(
            f"“{path}” is damaged or not an OpenEXR image; make it again or take another copy."
        ) from error
    return channels, meta
