"""Structures to start from: the thesis's three typologies, and any mesh."""

from .loading import FACADE_LOADING, Loading
from .rules import Rules
from .structure import Structure

PRESETS = {
    "roof": Structure(form="roof"),
    "shell": Structure(form="shell", rules=Rules(stability=3.0)),
    "facade": Structure(form="facade", loading=FACADE_LOADING),
}
"""By the names that a panel offers."""

OF_MESH = Structure(form="mesh", loading=Loading(area_load=0.0))
"""The edges of a mesh under their own weight: a mesh may have no faces for loads to act on."""
