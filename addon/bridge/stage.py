"""Results as Blender's data: images, a material that shows them, and whole studies as scenes.

Beside the false-colour picture of a result lie its maps as float images, packed with it into the
.blend: whatever is shown later, another map, another palette, a section, is read from them.
"""

import json
from dataclasses import asdict
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.colour import ColourScale, Display, scale_for
from ...engines.core.errors import HeliformError, SceneError
from ...engines.light import IrradianceMap
from ..properties import enum_items, group_for, read

CHANNELS = {
    "illuminance": ("illuminance",) * 3,
    "smooth": ("smooth", "smooth_half_width", "smooth_bias"),
    "parts": ("direct", "caustic", "indirect"),
    "interval": ("lower", "upper", "half_width"),
}
"""The float images of a result, and which map is in their red, green and blue."""

PICTURE = "false colour"
SHOWABLE = ("illuminance", "smooth", "caustic", "direct", "indirect", "half_width")
QUANTITIES = {
    "illuminance": "Illuminance",
    "smooth": "Smoothed illuminance",
    "caustic": "Caustic light",
    "direct": "Direct light",
    "indirect": "Scattered light",
    "half_width": "95 % half-width",
}

_OWNER, _KIND = "heliform_owner", "heliform_kind"
_META, _FIGURES = "heliform_meta", "heliform_figures"
_LEGEND, _PROBLEM = "heliform_legend", "heliform_problem"
SECTION = "heliform_section"


def stage_irradiance(
    receiver: bpy.types.Object, result: IrradianceMap, display: Display
) -> bpy.types.Image:
    """Put a result on its receiver and return the false-colour image; reruns replace in place."""
    for kind, names in CHANNELS.items():
        image = _image(receiver, kind, result.illuminance.shape)
        _fill(image, np.stack([getattr(result, name) for name in names], axis=-1))
    picture = _image(receiver, PICTURE, result.illuminance.shape)
    picture[_META] = json.dumps(result.meta)
    picture[_FIGURES] = json.dumps(result.figures())
    picture.pop(SECTION, None)
    _colour(picture, getattr(result, picture.heliform_map), Display())
    redisplay(picture, display)  # a range set by hand that is none must not lose the result
    _show(receiver, picture)
    return picture


def recolour(picture: bpy.types.Image, display: Display) -> None:
    """Colour a picture anew from its float images.

    Raises ParameterError for a range that is none, SceneError where the float images are gone.
    """
    name = picture.heliform_map
    kind, index = next((k, maps.index(name)) for k, maps in CHANNELS.items() if name in maps)
    _colour(picture, _values(picture, kind)[..., index], display)


def staged(picture: bpy.types.Image) -> IrradianceMap:
    """The result that a picture was made of. Raises SceneError where its images are gone."""
    maps = {}
    for kind, names in CHANNELS.items():
        maps |= dict(zip(names, np.moveaxis(_values(picture, kind), -1, 0), strict=False))
    return IrradianceMap(**maps, meta=meta_of(picture))


def meta_of(picture: bpy.types.Image) -> dict[str, Any]:
    """What is known of the result in a picture: see `IrradianceMap.meta`."""
    return json.loads(picture[_META])


def figures_of(picture: bpy.types.Image) -> dict[str, Any]:
    """The numbers of the result in a picture: see `IrradianceMap.figures`."""
    return json.loads(picture[_FIGURES])


def legend_of(picture: bpy.types.Image) -> ColourScale:
    """The scale that a picture is coloured with."""
    return ColourScale(**json.loads(picture[_LEGEND]))


def owner_of(picture: bpy.types.Image) -> bpy.types.Object | None:
    """The receiver that a picture lies on, unless that was deleted."""
    return picture.get(_OWNER)


def is_result(image: bpy.types.Image | None) -> bool:
    """Whether an image is a false-colour picture of Heliform's."""
    return image is not None and _META in image and _LEGEND in image


def _image(receiver: bpy.types.Object, kind: str, shape: tuple[int, int]) -> bpy.types.Image:
    """The receiver's image of that kind, of the right size and name; a new one the first time."""
    rows, columns = shape
    name = f"{receiver.name} {kind}"
    image = _find(receiver, kind)
    if image is None:
        data = kind != PICTURE
        image = bpy.data.images.new(
            name, columns, rows, alpha=False, float_buffer=data, is_data=data
        )
        image[_OWNER], image[_KIND] = receiver, kind
    elif image.name != name:
        image.name = name
    if tuple(image.size) != (columns, rows):
        image.scale(columns, rows)
    return image


def _find(receiver: bpy.types.Object | None, kind: str) -> bpy.types.Image | None:
    """By owner rather than name: it survives renaming, and a copied receiver is another one."""
    if receiver is None:
        return None
    mine = (i for i in bpy.data.images if i.get(_KIND) == kind and i.get(_OWNER) == receiver)
    return next(mine, None)


def _values(picture: bpy.types.Image, kind: str) -> NDArray[np.float32]:
    """A float image as (rows, columns, 3)."""
    image = _find(owner_of(picture), kind)
    if image is None:
        raise SceneError(f"The values behind “{picture.name}” are gone; trace photons again.")
    columns, rows = image.size
    pixels = np.empty(rows * columns * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(rows, columns, 4)[..., :3]


def _colour(picture: bpy.types.Image, values: NDArray[np.float32], display: Display) -> None:
    quantity = QUANTITIES[picture.heliform_map]
    scale = scale_for(values, display, quantity, meta_of(picture)["unit"])
    _fill(picture, scale.colours(values) / np.float32(255))
    picture[_LEGEND] = json.dumps(asdict(scale))


def _fill(image: bpy.types.Image, colours: NDArray[np.floating]) -> None:
    """Write (rows, columns, 3) and pack it, so that it is saved with the .blend."""
    pixels = np.ones((*colours.shape[:2], 4), dtype=np.float32)
    pixels[..., :3] = colours
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    image.update_tag()  # or the view mixes it with what it has drawn before


def _show(receiver: bpy.types.Object, picture: bpy.types.Image) -> None:
    """Have the receiver show the picture.

    Its own material stays with its mesh, and what a person made of ours stays too.
    """
    if not receiver.material_slots:
        receiver.data.materials.append(None)
    slot = receiver.material_slots[0]
    if slot.material is None or slot.material.get(_OWNER) != receiver:
        slot.link = "OBJECT"
        slot.material = _material(receiver)
    nodes = slot.material.node_tree.nodes
    for kind in (*CHANNELS, PICTURE):
        if kind in nodes:
            nodes[kind].image = _find(receiver, kind)
            nodes.active = nodes[kind]  # the last one, the picture, is what Solid shading takes


def _material(receiver: bpy.types.Object) -> bpy.types.Material:
    """A material that shines in the colours of the picture, with the values at hand beside it."""
    material = bpy.data.materials.new(f"{receiver.name} light")
    material[_OWNER] = receiver
    tree = material.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.location.x = -220
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    for row, kind in enumerate((PICTURE, *CHANNELS)):
        node = tree.nodes.new("ShaderNodeTexImage")
        node.name = node.label = kind
        node.interpolation = "Closest"  # a texel is a mean over its area, not a point to blend
        node.location = (-540, -300 * row)
    tree.links.new(tree.nodes[PICTURE].outputs["Color"], emission.inputs["Color"])
    return material


def show_in_views(context: bpy.types.Context) -> None:
    """Have the 3D views in Solid shading show pictures in the colours of their legend."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                shading = area.spaces.active.shading
                if shading.type == "SOLID":
                    shading.color_type, shading.light = "TEXTURE", "FLAT"


# What is shown


def redisplay(picture: bpy.types.Image | None, display: Display) -> None:
    """Recolour a picture as far as it is one; what is wrong is kept for `problem_of`."""
    if not is_result(picture):
        return
    try:
        recolour(picture, display)
        picture[_PROBLEM] = ""
    except HeliformError as error:
        picture[_PROBLEM] = str(error)


def problem_of(picture: bpy.types.Image) -> str:
    """Why a picture could not be recoloured, or an empty text."""
    return picture.get(_PROBLEM, "")


def _chosen(picture: bpy.types.Image, context: bpy.types.Context) -> None:
    redisplay(picture, read(context.scene.heliform.display, Display))


def _changed() -> None:
    settings = bpy.context.scene.heliform
    redisplay(settings.shown, read(settings.display, Display))


def _map_items() -> list[tuple[str, str, str, int]]:
    helps = (
        "All light that lands, as it was counted",
        "All light that lands, gathered over as many texels as it needs: for the eye",
        "Light that came through glass or off mirrors alone",
        "Light that met nothing on its way from the lamp",
        "Light that a matte surface scattered",
        "Half the width of the 95 % confidence interval: how sure each texel is",
    )
    numbered = enum_items(SHOWABLE)
    return [
        (key, QUANTITIES[key], text, number)
        for (key, _, _, number), text in zip(numbered, helps, strict=True)
    ]


_owner = object()


def _listen() -> None:
    """Recolour when a person changes how results are displayed."""
    bpy.msgbus.clear_by_owner(_owner)
    for field in group_for(Display).__annotations__:
        bpy.msgbus.subscribe_rna(
            key=(group_for(Display), field),
            owner=_owner,
            args=(),
            notify=_changed,
            options={"PERSISTENT"},
        )


def register() -> None:
    """Give images a choice of map, and follow the display settings."""
    bpy.types.Image.heliform_map = bpy.props.EnumProperty(
        name="Map",
        description="Which part of the light is shown",
        items=_map_items(),
        update=_chosen,
    )
    bpy.app.handlers.load_post.append(_reopened)
    for undone in (bpy.app.handlers.undo_post, bpy.app.handlers.redo_post):
        undone.append(_undone)
    _listen()


def unregister() -> None:
    """Take both away."""
    bpy.msgbus.clear_by_owner(_owner)
    for undone in (bpy.app.handlers.undo_post, bpy.app.handlers.redo_post):
        undone.remove(_undone)
    bpy.app.handlers.load_post.remove(_reopened)
    del bpy.types.Image.heliform_map


@bpy.app.handlers.persistent
def _reopened(*_: object) -> None:
    _listen()


@bpy.app.handlers.persistent
def _undone(*_: object) -> None:
    """Undo brings packed files back, but not always the pixels that were loaded from them."""
    for image in bpy.data.images:
        if _KIND in image:
            image.buffers_free()
            image.gl_free()
            image.update_tag()
