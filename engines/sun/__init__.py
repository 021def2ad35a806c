"""Sun and sky: where the sun stands, what the weather lets through, and what it lights."""

from ..core.analysis import Analysis, Form
from ..core.unwrap import unwrap
from .box import Box, box_mesh
from .daylight import Daylight, study_daylight
from .drawing import draw
from .live import LiveSun
from .maps import SunMap, SunMaps
from .radiation import Radiation, study_radiation
from .tables import QUANTITIES

FORMS = (Form("sun.box", Box, box_mesh),)
SUN_RADIATION = Analysis(
    "sun.radiation",
    Radiation,
    study_radiation,
    shows=SunMaps,
    draw=draw,
    unwrap=unwrap,
    live=lambda: LiveSun().radiation,
)
SUN_DAYLIGHT = Analysis(
    "sun.daylight", Daylight, study_daylight, shows=SunMaps, draw=draw, unwrap=unwrap
)
ANALYSES = (SUN_RADIATION, SUN_DAYLIGHT)

__all__ = [
    "ANALYSES",
    "FORMS",
    "QUANTITIES",
    "SUN_DAYLIGHT",
    "SUN_RADIATION",
    "Box",
    "Daylight",
    "LiveSun",
    "Radiation",
    "SunMap",
    "SunMaps",
    "study_daylight",
    "study_radiation",
]
