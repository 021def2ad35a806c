"""Where on earth a model stands, under which air, and which way it is turned."""

from dataclasses import dataclass

import numpy as np

from ..core.parameters import check_value, fields_of, param
from ..core.scene import Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class Site:
    """A place, its air and the model's orientation; by default the thesis's, in Cambridge.

    ``turbidity`` counts where no weather is given; it is Linke's at air mass 2.
    """

    latitude: float = param(42.3603, "deg", -90.0, 90.0, "North of the equator")
    longitude: float = param(-71.0875, "deg", -180.0, 180.0, "East of Greenwich")
    elevation: float = param(10.0, "m", -430.0, 9000.0, "Above sea level")
    utc_offset: float = param(-5.0, "h", -12.0, 14.0, "Standard time less UTC; no daylight saving")
    north: float = param(
        0.0, "deg", -360.0, 360.0, "Azimuth of the model's +Y axis, clockwise from north"
    )
    turbidity: float = param(
        0.0,
        "",
        0.0,
        20.0,
        "Of cloudless air: 2 very clean, 3 clean, 5 humid, 7 polluted; 0: Boston's by month",
    )


def check_site(site: Site) -> None:
    """Raise ParameterError for a value out of bounds, as a latitude beyond a pole."""
    for field in fields_of(Site):
        check_value(field, getattr(site, field.name), "site")


def place_text(site: Site) -> str:
    """“33.90° S, 151.20° E”."""
    north, east = "NS"[site.latitude < 0], "EW"[site.longitude < 0]
    return f"{abs(site.latitude):.2f}° {north}, {abs(site.longitude):.2f}° {east}"


def to_model(directions: Vector, site: Site) -> Vector:
    """World directions (…, 3), X east, Y north, Z up, in the axes of the site's model."""
    return directions @ _model_axes(site).T


def to_world(directions: Vector, site: Site) -> Vector:
    """Directions (…, 3) in the model's axes as world directions: `to_model` undone."""
    return directions @ _model_axes(site)


def _model_axes(site: Site) -> Vector:
    """The model's axes (3, 3) as rows of world directions; +Y stands at azimuth ``north``."""
    turn = np.radians(site.north)
    sine, cosine = np.sin(turn), np.cos(turn)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])
