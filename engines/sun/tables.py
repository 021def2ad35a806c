"""The quantities of a sun study, and its hourly table."""

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

QUANTITIES: dict[str, tuple[str, str, str]] = {
    "sun_hours": ("Sun hours", "h", "How long the sun is up and nothing but glass hides it."),
    "direct": ("Direct irradiation", "kWh/m²", "What comes straight from the sun."),
    "diffuse": ("Diffuse irradiation", "kWh/m²", "What comes from the sky and off the ground."),
    "reflected": ("Reflected irradiation", "kWh/m²", "What comes off bodies and receivers."),
    "total": (
        "Irradiation",
        "kWh/m²",
        "From sun, sky and ground, and off bodies where that is followed.",
    ),
    "open": ("Irradiation without buildings", "kWh/m²", "The same in an open field."),
    "shading": ("Shading", "%", "What share of the irradiation in an open field is kept off."),
    "daylight_factor": ("Daylight factor", "%", "Illuminance over that outdoors, overcast."),
    "illuminance": ("Illuminance", "lx", "The mean over the period."),
    "open_illuminance": ("Illuminance without buildings", "lx", "The same in an open field."),
    "daylight_autonomy": ("Daylight autonomy", "%", "Share of the hours that reach the target."),
    "continuous_autonomy": ("Continuous autonomy", "%", "The same, with part of it for part."),
    "udi_low": ("Too dark", "%", "Share of the hours with too little to be useful."),
    "udi_supplementary": ("Dim", "%", "Share of the hours in which lamps help."),
    "udi_useful": ("Useful daylight", "%", "Share of the hours with useful illuminance."),
    "udi_high": ("Too bright", "%", "Share of the hours with more than is useful."),
    "direct_hours": ("Hours of direct sun", "h", "Hours with more than 1000 lx from the sun."),
}
"""Name of a map → its title, its unit, and what it is in a sentence."""

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
    about = {"title": "Means over the sensors", **meta["facts"]}
    plain = folder / "hourly.csv"
    save_csv(plain, columns, about)
    if len(local) <= _LONG:
        return plain.name
    packed = folder / "hourly.csv.gz"
    with written(packed) as draft, gzip.GzipFile(draft, "wb", mtime=0) as stream:
        stream.write(plain.read_bytes())
    plain.unlink()
    return packed.name
