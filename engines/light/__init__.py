"""Light: luminaires, photon tracing, irradiance maps."""

from ..core.analysis import Analysis
from .drawing import draw
from .irradiance import IrradianceMap
from .tracing import PhotonTracing, trace

TRACE_PHOTONS = Analysis("light.trace", PhotonTracing, trace, IrradianceMap, draw)
ANALYSES = (TRACE_PHOTONS,)

__all__ = ["ANALYSES", "TRACE_PHOTONS", "IrradianceMap", "PhotonTracing", "trace"]
