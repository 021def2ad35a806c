"""Printed glass: walls laid down bead by bead, as closed meshes that light can be sent through."""

from ..core.analysis import Form
from .bead import Bead, relief
from .object import TABLE_1, GlassObject, glass_object

FORMS = (Form("glass.object", GlassObject, glass_object, TABLE_1),)
ANALYSES = ()

__all__ = ["ANALYSES", "FORMS", "TABLE_1", "Bead", "GlassObject", "glass_object", "relief"]
