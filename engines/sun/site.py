"""Where on earth a model stands, and which way it is turned."""

from dataclasses import dataclass

from ..core.parameters import param


@dataclass(frozen=True, slots=True, kw_only=True)
class Site:
    """A place and the model's orientation; by default the thesis's, on Boston's side of Cambridge."""

    latitude: float = param(42.3603, "deg", -90.0, 90.0, "North of the equator")
    longitude: float = param(-71.0875, "deg", -180.0, 180.0, "East of Greenwich")
    elevation: float = param(10.0, "m", -430.0, 9000.0, "Above sea level")
    utc_offset: float = param(-5.0, "h", -12.0, 14.0, "Standard time less UTC; no daylight saving")
    north: float = param(
        0.0, "deg", -360.0, 360.0, "Azimuth of the model's +Y axis, clockwise from north"
    )
