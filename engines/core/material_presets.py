"""Typical materials by name, each with its source."""

import functools
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import ParameterError
from .parameters import check_keys, from_table, merged, to_table
from .scene import Material

_FILE = Path(__file__).parent / "data" / "materials.toml"
_KEYS = ("name", "group", "material", "source", "confirmed")


@dataclass(frozen=True, slots=True)
class Preset:
    """A typical material: what people call it, which it is among, and where its figures are from.

    ``confirmed`` says whether they were held against that source.
    """

    label: str
    group: str
    material: Material
    source: str
    confirmed: bool

    @property
    def told(self) -> str:
        """Its figure and its source in a sentence."""
        own = self.material
        if own.kind != "dielectric":
            figure = f"returns {100 * own.reflectance:.3g} %"
        elif own.transmittance < 1:
            figure = f"lets {100 * own.transmittance:.3g} % through at normal incidence"
        else:
            figure = f"has the index {own.ior:.4g}"
        doubt = "" if self.confirmed else ", not confirmed"
        return f"{self.label}: typically {figure} ({self.source}{doubt})."


@functools.cache
def material_presets() -> Mapping[str, Preset]:
    """The presets by the names that a study file has for them, in their written order."""
    table = tomllib.loads(_FILE.read_text(encoding="utf-8"))["preset"]
    return {name: _preset(name, entry) for name, entry in table.items()}


def material_of(table: Any, where: str) -> Material:
    """The material of a study's ``table``, laid over the preset that it may name.

    Raises ParameterError for an unknown preset or key, or a value out of bounds.
    """
    if not isinstance(table, Mapping) or "preset" not in table:
        return from_table(Material, table, where)
    name = table["preset"]
    if name not in material_presets():
        known = ", ".join(material_presets())
        raise ParameterError(f"[{where}] preset = {name!r} is not a choice; take one of {known}.")
    own = {key: value for key, value in table.items() if key != "preset"}
    check_keys(own, to_table(Material()), where)
    return from_table(Material, merged(to_table(material_presets()[name].material), own), where)


def _preset(name: str, entry: Mapping[str, Any]) -> Preset:
    check_keys(entry, _KEYS, f"preset.{name}")
    material = from_table(Material, entry["material"], f"preset.{name}.material")
    return Preset(entry["name"], entry["group"], material, entry["source"], entry["confirmed"])
