"""How each analysis and Blender's scene meet, found by the analysis's name."""

from ..engines import light
from ..engines.core.analysis import Analysis
from .bridge import light as light_bridge
from .staging import Staging

_STAGINGS = {light.TRACE_PHOTONS.name: light_bridge.STAGING}


def staging_of(analysis: Analysis) -> Staging | None:
    """How the analysis meets the scene, or None where its result is for files alone."""
    return _STAGINGS.get(analysis.name)
