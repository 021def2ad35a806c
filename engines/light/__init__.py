"""Light: luminaires, photon tracing, irradiance maps."""

from ..core.analysis import Analysis
from .drawing import draw
from .irradiance import Irradiance, IrradianceMap
from .tracing import PhotonTracing, trace

TRACE_PHOTONS = Analysis("light.trace", PhotonTracing, trace, Irradiance, draw)
ANALYSES = (TRACE_PHOTONS,)

__all__ = ["ANALYSES", "TRACE_PHOTONS", "Irradiance", "IrradianceMap", "PhotonTracing", "trace"]
