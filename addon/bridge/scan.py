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
_SAMPLE, _FACE = "heliform_sample", "heliform_face"
"""Which scan and which face of it a patch or an image shows, so that another reading finds it."""


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
    sample = result.meta["parameters"]["file"]
    pictures = [_height_image(sample, result.style.name, face) for face in result.faces]
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
        _add_patch(scene, sample, result.style.name, face, scale)
    return False


def _add_patch(
    scene: bpy.types.Scene, sample: str, name: str, face: FaceReading, scale: float
) -> None:
    """The rebuilt face as an object, in the place of what an earlier reading made of the scan."""
    label, patch = f"{name} {face.name}", face.patch
    block = to_blender(Mesh(patch.vertices / scale, patch.faces, patch.normals), label)
    obj = next((o for o in scene.objects if o.type == "MESH" and _shows(o, sample, face)), None)
    if obj is not None:
        before, obj.data = obj.data, block
        if not before.users:
            bpy.data.meshes.remove(before)
        return
    obj = bpy.data.objects.new(label, block)
    obj[_SAMPLE], obj[_FACE] = sample, face.name
    obj.hide_render = True
    scene.collection.objects.link(obj)


def _shows(block: bpy.types.ID, sample: str, face: FaceReading) -> bool:
    return block.get(_SAMPLE) == sample and block.get(_FACE) == face.name


def _height_image(sample: str, name: str, face: FaceReading) -> bpy.types.Image:
    """The unrolled height over the base surface in m, as a float image that is kept in the file."""
    label = f"{name} {face.name} height"
    rows, columns = face.height.shape
    image = next((i for i in bpy.data.images if _shows(i, sample, face)), None)
    if image is None or tuple(image.size) != (columns, rows):
        if image is not None:
            bpy.data.images.remove(image)
        image = bpy.data.images.new(
            label, columns, rows, alpha=False, float_buffer=True, is_data=True
        )
        image[_SAMPLE], image[_FACE] = sample, face.name
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
