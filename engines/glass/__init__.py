"""Printed glass: walls laid down bead by bead, as closed meshes that light can be sent through."""

from ..core.analysis import Analysis, Form
from . import library_pictures, unrolled
from .bead import Bead
from .candidates import PrintLibrary
from .fourier import Plan
from .library import Library, print_library
from .loft import Loft, Place, Wall, wall_loft
from .object import TABLE_1, GlassObject, glass_object
from .presets import PRESETS
from .printed import wall_mesh, wall_skin
from .printing import Print, Printed, print_wall

FORMS = (
    Form("glass.object", GlassObject, glass_object, TABLE_1),
    Form("glass.wall", Wall, wall_mesh, PRESETS),
)
PRINT_LIBRARY = Analysis(
    "glass.library", PrintLibrary, print_library, shows=Library, draw=library_pictures.draw
)
PRINT_WALL = Analysis("glass.print", Print, print_wall, shows=Printed, draw=unrolled.draw)
ANALYSES = (PRINT_WALL, PRINT_LIBRARY)

__all__ = [
    "ANALYSES",
    "FORMS",
    "PRESETS",
    "PRINT_LIBRARY",
    "PRINT_WALL",
    "TABLE_1",
    "Bead",
    "GlassObject",
    "Library",
    "Loft",
    "Place",
    "Plan",
    "Print",
    "PrintLibrary",
    "Printed",
    "Wall",
    "glass_object",
    "print_library",
    "print_wall",
    "wall_loft",
    "wall_mesh",
    "wall_skin",
]
