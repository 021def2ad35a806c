"""Light: luminaires, photon tracing, irradiance maps."""

from ..core.analysis import Analysis
from ..core.unwrap import unwrap
from .drawing import draw
from .ies import files_beside
from .irradiance import SUMS, Irradiance, IrradianceMap
from .tracing import PhotonTracing, trace

TRACE_PHOTONS = Analysis(
    *("light.trace", PhotonTracing, trace, Irradiance, draw),
    refine=trace,
    sums=SUMS,
    unwrap=unwrap,
    lamp_files=files_beside,
)
ANALYSES = (TRACE_PHOTONS,)

__all__ = ["ANALYSES", "TRACE_PHOTONS", "Irradiance", "IrradianceMap", "PhotonTracing", "trace"]
