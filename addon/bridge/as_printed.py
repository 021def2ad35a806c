"""A scan of a finished piece and its design in Blender: what is compared, and how far it is off."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ...engines.core.analysis import Analysis
from ...engines.core.colour import ColourScale
from ...engines.core.errors import SceneError
from ...engines.core.scene import Body, Material, Scene, Vector
from ...engines.scan import AsPrinted, Comparison
from ..properties import parameters, scale_of
from ..staging import Gathered, Objects, Staging
from . import layers
from .layers import Layer, Mark
from .meshes import places_of
from .read import read_mesh

_FACTS = "heliform_as_printed"
_DESIGN = "heliform_design"
"""The design of which an object is the evaluated mesh."""
_PEAK = 99.5  # percentile of the deviation that the colours reach to
_LEAST = 1e-2  # mm, that they reach to at least


def _gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    """The active mesh as the design, as it is seen with its modifiers."""
    obj = context.object
    if obj is None or obj.type != "MESH" or obj.heliform.role != "BODY":
        raise SceneError("Select the wall or body that was printed; it is the design.")
    mesh = read_mesh(obj, context.evaluated_depsgraph_get(), scale_of(context.scene))
    record = replace(parameters(context.scene, Comparison), body="")
    if record.file:
        record = replace(record, file=bpy.path.abspath(record.file))
    return Gathered(
        obj.name, Scene((Body(obj.name, mesh, Material()),), (), ()), record, {obj.name: obj}
    )


def _stage(
    scene: bpy.types.Scene,
    there: Objects,
    result: AsPrinted,
    folder: Path,
    /,
    notes: tuple[str, ...] = (),
) -> bool:
    """Colour the design by how far the piece stands off, in mm, the farthest place marked."""
    (obj,) = there.values()
    if len(obj.data.vertices) != len(result.deviation):
        obj = _as_seen(scene, obj, len(result.deviation))
    obj.heliform.gate = False
    values = 1e3 * result.deviation
    layers.paint(obj, values, _layer(values, places_of(obj.data), result))
    obj[_FACTS] = json.dumps(
        {
            "figures": result.figures(),
            "notes": [*result.meta["notes"], *notes],
            "folder": str(folder),
        }
    )
    layers.show_in_views(bpy.context)
    return False


def _as_seen(scene: bpy.types.Scene, obj: bpy.types.Object, count: int) -> bpy.types.Object:
    """An object with the design's evaluated mesh, where that has other vertices than its own."""
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    block = bpy.data.meshes.new_from_object(evaluated)
    if len(block.vertices) != count:
        bpy.data.meshes.remove(block)
        raise SceneError(f"“{obj.name}” was changed while it was compared; compare again.")
    found = next((o for o in scene.objects if o.type == "MESH" and o.get(_DESIGN) == obj), None)
    if found is None:
        found = bpy.data.objects.new(f"{obj.name} as printed", block)
        found[_DESIGN] = obj
        scene.collection.objects.link(found)
    else:
        before, found.data = found.data, block
        if not before.users:
            bpy.data.meshes.remove(before)
    found.matrix_world = obj.matrix_world
    return found


def _layer(values: Vector, places: Vector, result: AsPrinted) -> Layer:
    known = np.abs(values[np.isfinite(values)])
    most = max(float(np.percentile(known, _PEAK)) if known.size else 0.0, _LEAST)
    figures = result.figures()
    scale = ColourScale(-most, most, False, "viridis", "Deviation, outward", "mm")
    marks = []
    if known.size:
        worst = int(np.nanargmax(np.abs(values)))
        x, y, z = places[worst].tolist()
        marks = [Mark((x, y, z), f"{values[worst]:+.2f} mm")]
    footing = [
        f"RMS {1e3 * figures['deviation_rms']['value']:.2g} mm",
        f"{100 * figures['within_tolerance']['value']:.0f} % within tolerance",
        f"{100 * figures['coverage']['value']:.0f} % seen",
    ]
    return Layer("Deviation, outward", scale, footing, marks)


def facts_of(obj: bpy.types.Object | None) -> dict[str, Any] | None:
    """Figures, notes and folder of the last comparison with this design, or None."""
    return json.loads(obj[_FACTS]) if obj is not None and _FACTS in obj else None


STAGING = Staging(_gather, _stage)
