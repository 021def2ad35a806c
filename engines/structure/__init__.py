"""Space frames: gridshells and façades, analysed, checked and sized member by member."""

from ..core.analysis import Analysis, Form
from . import drawing, ranges
from .drawn import structure_mesh
from .facade import Facade
from .level_set import Nine
from .live import Live
from .loading import Loading
from .model import Model
from .presets import PRESETS
from .ranges import Ranges, RangeSweep, sweep_ranges
from .roof import Roof
from .rules import Rules
from .shell import Shell
from .sized import Sized
from .structure import Structure, design, model_of, size_structure
from .surface import Net

FORMS = (Form("structure.sized", Structure, structure_mesh, PRESETS),)
SIZE_STRUCTURE = Analysis(
    "structure.size", Structure, size_structure, shows=Sized, draw=drawing.draw
)
SWEEP_RANGES = Analysis(
    "structure.ranges", Ranges, sweep_ranges, shows=RangeSweep, draw=ranges.draw
)
ANALYSES = (SIZE_STRUCTURE, SWEEP_RANGES)

__all__ = [
    "ANALYSES",
    "FORMS",
    "PRESETS",
    "SIZE_STRUCTURE",
    "SWEEP_RANGES",
    "Facade",
    "Live",
    "Loading",
    "Model",
    "Net",
    "Nine",
    "RangeSweep",
    "Ranges",
    "Roof",
    "Rules",
    "Shell",
    "Sized",
    "Structure",
    "design",
    "model_of",
    "size_structure",
    "structure_mesh",
    "sweep_ranges",
]
