"""What every study of sun and sky asks: where it stands, and what shines there."""

from dataclasses import dataclass

from ..core.parameters import nested, param
from .site import Site


@dataclass(frozen=True, slots=True, kw_only=True)
class Outdoors:
    """Where the model stands, its weather, and how suns and ground are taken."""

    site: Site = nested(Site, "Where the model stands and which way it is turned")  # noqa: RUF009
    weather_file: str = param("", help="EPW, TMY3, NSRDB or PVGIS; empty: a cloudless year")
    accuracy: float = param(
        1.0, "deg", 0.0, 30.0, "Suns this near to one another are traced as one; 0: every sun"
    )
    ground_reflectance: float = param(
        0.2, "", 0.0, 1.0, "Share of light that the open ground returns"
    )
    open: bool = param(True, help="Also what there would be without any building")
