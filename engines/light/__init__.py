"""Light: luminaires, photon tracing, irradiance maps."""

from ..core.analysis import Analysis
from .irradiance import IrradianceMap
from .tracing import PhotonTracing, trace

TRACE_PHOTONS = Analysis("light.trace", PhotonTracing, trace, shows=IrradianceMap)
ANALYSES = (TRACE_PHOTONS,)

__all__ = ["ANALYSES", "TRACE_PHOTONS", "IrradianceMap", "PhotonTracing", "trace"]
