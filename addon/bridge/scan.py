"""Scans and Blender: what is read, and the relief, the patch and the maps that come of it."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ...engines.core.analysis import Analysis
from ...engines.core.scene import Mesh, Scene
from ...engines.scan import Reading, ScanReading
from ...engines.scan.result import FaceReading
from ..properties import parameters, scale_of
from ..staging import Gathered, Objects, Staging
from .meshes import to_blender
from .print_styles import style_object

_FACTS = "heliform_scan"


def _gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    """What the scene says of the scan; its objects are not looked at."""
    record = parameters(context.scene, ScanReading)
    if record.file:
        record = replace(record, file=bpy.path.abspath(record.file))
    return Gathered(Path(record.file).stem or "Sample", Scene(), record)


def _stage(
    scene: bpy.types.Scene,
    objects: Objects,
    result: Reading,
    folder: Path,
    notes: tuple[str, ...] = (),
) -> bool:
    """Keep the relief in the file, and show the surface that was found where the scan has it."""
    scale = scale_of(scene)
    style = style_object(result.style, scale=scale)
    style.use_fake_user = True  # until it is put on something
    pictures = [_height_image(result.style.name, face) for face in result.faces]
    style[_FACTS] = json.dumps(
        {
            "figures": result.figures(),
            "notes": [*result.meta["notes"], *notes],
            "folder": str(folder),
            "images": [picture.name for picture in pictures],
        }
    )
    scene.heliform.relief = style
    for face in result.faces:
        _add_patch(scene, f"{result.style.name} {face.name}", face.patch, scale)
    return False


def _add_patch(scene: bpy.types.Scene, name: str, patch: Mesh, scale: float) -> None:
    """The rebuilt face as an object, in the place of an earlier reading's."""
    obj = scene.objects.get(name)
    mesh = Mesh(patch.vertices / scale, patch.faces, patch.normals)
    if obj is not None and obj.type == "MESH":
        to_blender(mesh, obj.data)
        return
    obj = bpy.data.objects.new(name, to_blender(mesh, name))
    obj.hide_render = True
    scene.collection.objects.link(obj)


def _height_image(name: str, face: FaceReading) -> bpy.types.Image:
    """The unrolled height over the base surface in m, as a float image that is kept in the file."""
    label = f"{name} {face.name} height"
    rows, columns = face.height.shape
    image = bpy.data.images.get(label)
    if image is None or tuple(image.size) != (columns, rows):
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.new(
            label, columns, rows, alpha=False, float_buffer=True, is_data=True
        )
    pixels = np.ones((rows, columns, 4), dtype=np.float32)
    pixels[..., :3] = face.height[..., None]
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    image.use_fake_user = True
    return image


def facts_of(style: bpy.types.Object | None) -> dict[str, Any] | None:
    """Figures, notes, folder and images of the scan that a style is from, or None."""
    return json.loads(style[_FACTS]) if style is not None and _FACTS in style else None


STAGING = Staging(_gather, _stage)
