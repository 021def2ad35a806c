"""Members of a sized structure in Blender: their solids, their values as pictures, their checks."""

import json
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.colour import NO_VALUE, ColourScale, Palette
from ...engines.core.scene import Mesh
from ...engines.structure.drawn import (
    bent,
    drawn_sections,
    exaggeration,
    values_along,
)
from ...engines.structure.fins import deformed, member_solids
from ...engines.structure.joints import Joint, node_normals
from ...engines.structure.member_texture import image_of, layout_of
from ...engines.structure.sized import Sized
from . import layers, results
from .layers import Layer, Mark
from .meshes import to_blender

MAPS = {
    "utilisation": ("Utilisation", "How much of its resistance each member uses; red fails", ""),
    "stress": ("Stress", "Greatest elastic normal stress along the members", "MPa"),
    "displacement": ("Displacement", "How far members move in the worst combination", "mm"),
    "material": ("Material", "Steel or timber", ""),
    "height": ("Section height", "How tall the sections are", "cm"),
    "class": ("Section class", "EN 1993-1-1's class of the cross-section", ""),
}
"""What members can be coloured by, with a name, a sentence and the unit that it is shown in."""

CHANNELS = {
    "use": ("utilisation", "stress", "displacement"),
    "make": ("material", "height", "class"),
}
"""The float images, and what is in their red, green and blue."""

STATIONS, CROSSES = 5, 3
"""Values along a member, and the cross-sections that its solid has."""
_FAILING, _STEEL, _TIMBER = (214, 39, 40), (70, 130, 190), (222, 166, 74)
_UV, _MEMBER = "Heliform", "member"
_DISPLACED = "Displaced"
_FACTS, _ROWS, _CHECKS, _PLACES = (
    *("heliform_structure", "heliform_members", "heliform_checks", "heliform_places"),
)
_ROW = np.dtype(
    [("group", "i4"), ("section", "i4"), ("grade", "i4"), ("start", "i4"), ("end", "i4")]
    + [(name, "f4") for name in ("length", "mass", "utilisation")]
)
"""What is kept of a member; sections and grades by their place in the facts' lists."""


def stage_members(obj: bpy.types.Object, sized: Sized, joint: Joint, scale: float) -> None:
    """Make the object the sized structure: solids, values and what is said of each member."""
    _draw_solids(obj, sized, joint, scale)
    _keep_values(obj, sized)
    _keep_facts(obj, sized, scale)


# Solids


def _draw_solids(obj: bpy.types.Object, sized: Sized, joint: Joint, scale: float) -> None:
    """Each member with its place in the pictures, and, as a shape key, where it is displaced to."""
    frame, layout = sized.model.frame, layout_of(len(sized.rows), STATIONS)
    normals = node_normals(frame, sized.model.cells)
    fins = member_solids(frame, drawn_sections(sized), joint, CROSSES, layout, normals)
    key = obj.data.shape_keys and obj.data.shape_keys.key_blocks.get(_DISPLACED)
    amount = key.value if key else 0.0
    if obj.data.shape_keys and len(obj.data.vertices) != len(fins.mesh.vertices):
        obj.shape_key_clear()
    block = to_blender(Mesh(fins.mesh.vertices / scale, fins.mesh.faces), obj.data)
    uv = block.uv_layers.get(_UV) or block.uv_layers.new(name=_UV, do_init=False)
    uv.uv.foreach_set("vector", fins.texture.astype(np.float32).ravel())
    member = block.attributes.get(_MEMBER) or block.attributes.new(_MEMBER, "INT", "FACE")
    member.data.foreach_set("value", fins.member)
    moved = deformed(fins, frame, *bent(sized, CROSSES), exaggeration(sized))
    keys = block.shape_keys.key_blocks if block.shape_keys else {}
    for name, places in (("Basis", fins.mesh.vertices), (_DISPLACED, moved)):
        found = keys.get(name) or obj.shape_key_add(name=name, from_mix=False)
        found.points.foreach_set("co", (places / scale).astype(np.float32).ravel())
    block.shape_keys.key_blocks[_DISPLACED].value = amount
    block.update()


def displaced_key(obj: bpy.types.Object) -> bpy.types.ShapeKey | None:
    """The shape key that shows the structure displaced."""
    keys = obj.data.shape_keys if obj.type == "MESH" else None
    return keys.key_blocks.get(_DISPLACED) if keys else None


def member_of_face(obj: bpy.types.Object, face: int) -> int | None:
    """The member that a face of the object's own mesh belongs to."""
    stored = obj.data.attributes.get(_MEMBER)
    return stored.data[face].value if stored and face < len(stored.data) else None


# Values


def _keep_values(obj: bpy.types.Object, sized: Sized) -> None:
    """The values of every map as float images."""
    shape = (len(sized.rows), STATIONS)
    layout = layout_of(*shape)
    values = {
        name: image_of(np.broadcast_to(value, shape), layout)
        for name, value in values_along(sized, STATIONS).items()
    }
    for kind, names in CHANNELS.items():
        stacked = np.stack([values[name] for name in names], axis=-1)
        results.fill(results.image_for(obj, kind, "", stacked.shape[:2]), stacked)


def paint_map(obj: bpy.types.Object, name: str, palette: Palette) -> None:
    """Colour the members by a map of MAPS; what fails is red in that of utilisation."""
    kind = next(kind for kind, names in CHANNELS.items() if name in names)
    image = results.find(obj, kind, "")
    facts = facts_of(obj)
    if image is None or facts is None:
        return
    values = results.pixels_of(image)[..., CHANNELS[kind].index(name)]
    colours, layer = _coloured(obj, name, values, palette, facts)
    layers.paint_texels(obj, "structure", tuple(CHANNELS), colours / np.float32(255), layer)


def _coloured(
    obj: bpy.types.Object,
    name: str,
    values: NDArray[np.float32],
    palette: Palette,
    facts: dict[str, Any],
) -> tuple[NDArray[np.integer], Layer]:
    title, _, unit = MAPS[name]
    footing = _footing(facts)
    if name == "material":
        colours = np.where((values > 0.5)[..., None], _STEEL, _TIMBER)
        swatches = [("Steel", _STEEL), ("Timber", _TIMBER)]
        return colours, Layer(title, None, footing, _marks(obj), swatches)
    if name == "utilisation":
        limit = facts["limit"]
        scale = ColourScale(0.0, 1.0, False, palette, title, unit)
        failing = values > limit * (1 + 1e-6)
        colours = np.where(failing[..., None], _FAILING, scale.colours(values))
        count = int(facts["figures"]["failing"]["value"])
        swatches = [(f"{count} fail", _FAILING)] * bool(count)
        return colours, Layer(title, scale, footing, _marks(obj), swatches)
    if name == "class":
        scale = ColourScale(0.0, 4.0, False, palette, title, unit)
        colours = scale.colours(np.arange(5.0))
        colours[0] = NO_VALUE
        there = np.unique(values).astype(int).tolist()
        swatches = [
            (f"Class {n}" if n else "Not classed", tuple(colours[n].tolist())) for n in there
        ]
        return colours[values.astype(int)], Layer(title, None, footing, _marks(obj), swatches)
    high = float(np.nanmax(values)) or 1.0
    scale = ColourScale.automatic(np.array([high]), False, palette, title, unit)
    return scale.colours(values), Layer(title, scale, footing, _marks(obj))


def _footing(facts: dict[str, Any]) -> list[str]:
    figures = facts["figures"]
    mass, energy = (figures[n]["value"] for n in ("mass", "embodied_energy"))
    said = [f"{_round(mass / 1e3)} t, {_round(energy)} GJ"]
    if not figures["converged"]["value"]:
        said.append("not converged")
    return said


def _round(value: float) -> str:
    """Three digits or more, and no exponent."""
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


# What is said of members


def _keep_facts(obj: bpy.types.Object, sized: Sized, scale: float) -> None:
    rows, model, meta = sized.rows, sized.model, sized.meta
    kept = np.zeros(len(rows), _ROW)
    names, kept["section"] = np.unique(rows["name"], return_inverse=True)
    grades, kept["grade"] = np.unique(rows["grade"], return_inverse=True)
    kept["start"], kept["end"] = model.frame.members.T
    for name in ("group", "length", "mass", "utilisation"):
        kept[name] = rows[name]
    middles = model.frame.ends().mean(axis=1) / scale
    for name, array in (
        (_ROWS, kept),
        (_CHECKS, sized.checked.utilisation.astype(np.float32)),
        (_PLACES, middles.astype(np.float32)),
    ):
        obj[name] = np.frombuffer(array.tobytes(), np.int32).tolist()
    facts = {
        "figures": sized.figures(),
        "notes": meta["notes"],
        "combinations": meta["combinations"],
        "checks": list(sized.checked.names),
        "groups": list(model.group_names),
        "sections": names.tolist(),
        "grades": grades.tolist(),
        "limit": meta["parameters"]["rules"]["utilisation"],
        "exaggeration": exaggeration(sized),
        "folder": "",
    }
    obj[_FACTS] = json.dumps(facts)


def note_folder(obj: bpy.types.Object, folder: str, notes: tuple[str, ...]) -> None:
    """Keep where the result's files are."""
    facts = facts_of(obj)
    assert facts is not None
    facts["notes"] += notes
    obj[_FACTS] = json.dumps(facts | {"folder": folder})


def facts_of(obj: bpy.types.Object | None) -> dict[str, Any] | None:
    """Figures, notes, combinations and lists of names of the object's structure, or None."""
    return json.loads(obj[_FACTS]) if obj is not None and _FACTS in obj else None


def member_facts(obj: bpy.types.Object, member: int) -> dict[str, Any] | None:
    """What is said of a member: group, nodes, section, grade, length in m, mass in kg, its checks.

    ``checks`` is a list of names with utilisations, the greatest first; None without such a member.
    """
    facts = facts_of(obj)
    rows = _kept(obj, _ROWS, _ROW)
    if facts is None or not 0 <= member < len(rows):
        return None
    row = rows[member]
    used = _kept(obj, _CHECKS, np.dtype(np.float32)).reshape(-1, len(rows))[:, member]
    checks = [(facts["checks"][i], float(used[i])) for i in np.argsort(-used) if used[i] > 0]
    return {
        "group": facts["groups"][row["group"]],
        "nodes": (int(row["start"]), int(row["end"])),
        "section": facts["sections"][row["section"]],
        "grade": facts["grades"][row["grade"]],
        "length": float(row["length"]),
        "mass": float(row["mass"]),
        "utilisation": float(row["utilisation"]),
        "checks": checks,
    }


def worst_member(obj: bpy.types.Object) -> int | None:
    """The member that uses most of its resistance."""
    rows = _kept(obj, _ROWS, _ROW)
    return int(rows["utilisation"].argmax()) if len(rows) else None


def _kept(obj: bpy.types.Object, name: str, dtype: np.dtype) -> NDArray[Any]:
    """An array that the object carries, as whole numbers that its bytes make; empty without."""
    numbers = np.array(obj[name].to_list() if name in obj else [], dtype=np.int32)
    return np.frombuffer(numbers.tobytes(), dtype)


def _marks(obj: bpy.types.Object) -> list[Mark]:
    """The picked member, pointed out."""
    picked = obj.heliform.member
    known = member_facts(obj, picked)
    if known is None:
        return []
    x, y, z = _kept(obj, _PLACES, np.dtype(np.float32)).reshape(-1, 3)[picked].tolist()
    said = f"Member {picked}: {known['section']}, {100 * known['utilisation']:.0f} %"
    return [Mark((x, y, z), said)]
