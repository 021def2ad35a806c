"""How each analysis and Blender's scene meet, found by the analysis's name."""

from ..engines import glass, light, scan, structure, sun
from ..engines.core.analysis import Analysis
from .bridge import as_printed
from .bridge import light as light_bridge
from .bridge import scan as scan_bridge
from .bridge import sun as sun_bridge
from .printed import PRINT_STAGING, SCANNED_STAGING
from .staging import Staging
from .structures import STRUCTURE_STAGING

_STAGINGS = {
    glass.PRINT_WALL.name: PRINT_STAGING,
    light.TRACE_PHOTONS.name: light_bridge.STAGING,
    scan.READ_SCAN.name: scan_bridge.STAGING,
    scan.SCAN_TO_WALL.name: SCANNED_STAGING,
    scan.COMPARE_PRINT.name: as_printed.STAGING,
    structure.SIZE_STRUCTURE.name: STRUCTURE_STAGING,
    sun.SUN_RADIATION.name: sun_bridge.STAGING,
    sun.SUN_DAYLIGHT.name: sun_bridge.STAGING,
}


def staging_of(analysis: Analysis) -> Staging | None:
    """How the analysis meets the scene, or None where its result is for files alone."""
    return _STAGINGS.get(analysis.name)
