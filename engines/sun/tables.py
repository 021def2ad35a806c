"""The hourly table of a sun study."""

import gzip
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core.files import written
from ..core.scene import Vector
from ..core.table import save_csv
from .weather import seconds

HOURLY: dict[str, tuple[str, str]] = {
    "direct": ("Direct", "W/m²"),
    "diffuse": ("Diffuse", "W/m²"),
    "reflected": ("Reflected", "W/m²"),
    "open": ("Without buildings", "W/m²"),
    "illuminance": ("Illuminance", "lx"),
}
"""Name of an hourly mean → its title and unit."""

_LONG = 5000  # rows, beyond which the table is compressed


def save_hourly(
    folder: Path,
    times: NDArray[np.datetime64],
    hourly: Mapping[str, Vector],
    meta: Mapping[str, Any],
) -> str:
    """Write hourly.csv, or hourly.csv.gz where it is long; returns its name.

    A row an interval: its middle (T,), UTC, by the clock of the ``meta``'s site, and the means (T,)
    over the sensors, named as in `HOURLY`. Raises FileError where it cannot be written.
    """
    local = times.astype("datetime64[s]") + seconds(3600 * meta["site"]["utc_offset"])
    local = np.datetime_as_string(local.astype("datetime64[m]"))
    columns = {"Middle of the interval": np.char.replace(local, "T", " ")}
    columns |= {f"{HOURLY[n][0]} ({HOURLY[n][1]})": values for n, values in hourly.items()}
    about = {"title": "Means over the sensors", **{k: meta[k] for k in ("source", "period")}}
    plain = folder / "hourly.csv"
    save_csv(plain, columns, about)
    if len(local) <= _LONG:
        return plain.name
    packed = folder / "hourly.csv.gz"
    with written(packed) as draft, gzip.GzipFile(draft, "wb", mtime=0) as stream:
        stream.write(plain.read_bytes())
    plain.unlink()
    return packed.name
