"""Results in Blender's images: which images there are, and what they hold.

Beside the false-colour picture of each map of a result lie its values as float images, packed with
it into the .blend: whatever is shown later, another map, another palette, a section, is read from
them.
"""

import json
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ...engines.core.colour import ColourScale
from ...engines.core.errors import SceneError
from ...engines.light import IrradianceMap

CHANNELS = {
    "illuminance": ("illuminance",) * 3,
    "smooth": ("smooth", "smooth_half_width", "smooth_bias"),
    "parts": ("direct", "caustic", "indirect"),
    "interval": ("lower", "upper", "half_width"),
    "area": ("area",) * 3,
    "colour": ("red", "green", "blue"),
}
"""The float images of a result, and which map is in their red, green and blue."""

COLOUR = "colour"
"""The one that is there only where colours were traced."""
PICTURE = "false colour"
KINDS = (*CHANNELS, PICTURE)

META, FIGURES = "heliform_meta", "heliform_figures"
LEGEND, PROBLEM = "heliform_legend", "heliform_problem"
MAPS, PLANE, SECTION = "heliform_maps", "heliform_plane", "heliform_section"
_OWNER, _KIND, _SIDE = "heliform_owner", "heliform_kind", "heliform_side"


def is_result(image: bpy.types.Image | None) -> bool:
    """Whether an image is a false-colour picture of Heliform's."""
    return image is not None and META in image and LEGEND in image


def is_ours(image: bpy.types.Image) -> bool:
    """Whether an image is one of a result's."""
    return _KIND in image


def results_of(scene: bpy.types.Scene) -> list[bpy.types.Image]:
    """The pictures on a scene's receivers, by their names, the front before the back."""
    found = [i for i in bpy.data.images if is_result(i) and _is_in(scene, owner_of(i))]
    return sorted(found, key=lambda i: (owner_of(i).name, side_of(i) == "back"))


def _is_in(scene: bpy.types.Scene, owner: bpy.types.Object | None) -> bool:
    return owner is not None and scene.objects.get(owner.name) == owner


def meta_of(picture: bpy.types.Image) -> dict[str, Any]:
    """What is known of the result in a picture: see `IrradianceMap.meta`."""
    return json.loads(picture[META])


def figures_of(picture: bpy.types.Image) -> dict[str, Any]:
    """The numbers of the result in a picture: see `IrradianceMap.figures`."""
    return json.loads(picture[FIGURES])


def legend_of(picture: bpy.types.Image) -> ColourScale | None:
    """The scale that a picture is coloured with; None where it shows the light's own colour."""
    kept = json.loads(picture[LEGEND])
    return ColourScale(**kept) if "palette" in kept else None


def white_of(picture: bpy.types.Image) -> float:
    """What is white in a picture that shows the light's own colour, in lx."""
    return json.loads(picture[LEGEND])["white"]


def owner_of(picture: bpy.types.Image) -> bpy.types.Object | None:
    """The receiver that a picture lies on, unless that was deleted."""
    return picture.get(_OWNER)


def side_of(picture: bpy.types.Image) -> str:
    """ "front" or "back" where both sides of the receiver gather, else an empty text."""
    return picture.get(_SIDE, "")


def name_of(picture: bpy.types.Image) -> str:
    """The receiver's name, with the side where both gather."""
    owner, side = owner_of(picture), side_of(picture)
    name = owner.name if owner else meta_of(picture)["receiver"]
    return f"{name} ({side})" if side else name


def is_plane(picture: bpy.types.Image) -> bool:
    """Whether a picture is that of a rectangle, across which sections go."""
    return picture[PLANE]


# Images


def image_for(
    receiver: bpy.types.Object, kind: str, side: str, shape: tuple[int, ...]
) -> bpy.types.Image:
    """The receiver's image of that kind, of the right size and name; a new one the first time."""
    rows, columns = shape
    name = " ".join(filter(None, (receiver.name, side, kind)))
    image = find(receiver, kind, side)
    if image is None:
        data = kind != PICTURE
        image = bpy.data.images.new(
            name, columns, rows, alpha=False, float_buffer=data, is_data=data
        )
        image[_OWNER], image[_KIND], image[_SIDE] = receiver, kind, side
    elif image.name != name:
        image.name = name
    if tuple(image.size) != (columns, rows):
        image.scale(columns, rows)
    return image


def find(receiver: bpy.types.Object | None, kind: str, side: str) -> bpy.types.Image | None:
    """By owner rather than name: it survives renaming, and a copied receiver is another one."""
    if receiver is None:
        return None
    return next((i for i in _all_of(receiver) if i.get(_KIND) == kind and side_of(i) == side), None)


def drop_others(receiver: bpy.types.Object, kept: set[tuple[str, str]]) -> None:
    """Remove a receiver's images of an earlier result but those of the (kind, side) ``kept``."""
    for image in _all_of(receiver):
        if (image[_KIND], side_of(image)) not in kept:
            bpy.data.images.remove(image)


def _all_of(receiver: bpy.types.Object) -> list[bpy.types.Image]:
    return [i for i in bpy.data.images if is_ours(i) and i.get(_OWNER) == receiver]


def fill(image: bpy.types.Image, colours: NDArray[np.floating]) -> None:
    """Write (rows, columns, 3) and pack it, so that it is saved with the .blend."""
    pixels = np.ones((*colours.shape[:2], 4), dtype=np.float32)
    pixels[..., :3] = colours
    image.pixels.foreach_set(pixels.ravel())
    image.update()
    image.pack()
    image.update_tag()  # or the view mixes it with what it has drawn before


# Values


def values_of(picture: bpy.types.Image, name: str) -> NDArray[np.float32]:
    """A map of the result in a picture (rows, columns), or its colour (rows, columns, 3).

    Raises SceneError where its images are gone.
    """
    if name == COLOUR:
        return _values(picture, COLOUR)
    kind, index = next((k, maps.index(name)) for k, maps in CHANNELS.items() if name in maps)
    return _values(picture, kind)[..., index]


def staged(picture: bpy.types.Image) -> IrradianceMap:
    """The result that a picture was made of. Raises SceneError where its images are gone."""
    maps = {}
    for kind, names in CHANNELS.items():
        if kind == COLOUR and find(owner_of(picture), kind, side_of(picture)) is None:
            maps |= dict.fromkeys(names, np.zeros_like(maps["area"]))
        else:
            maps |= dict(zip(names, np.moveaxis(_values(picture, kind), -1, 0), strict=True))
    return IrradianceMap(**maps, meta=meta_of(picture))


def _values(picture: bpy.types.Image, kind: str) -> NDArray[np.float32]:
    """A float image as (rows, columns, 3)."""
    image = find(owner_of(picture), kind, side_of(picture))
    if image is None:
        raise SceneError(f"The values behind “{picture.name}” are gone; trace photons again.")
    return pixels_of(image)


def pixels_of(image: bpy.types.Image) -> NDArray[np.float32]:
    """The red, green and blue of an image (rows, columns, 3)."""
    columns, rows = image.size
    pixels = np.empty(rows * columns * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(rows, columns, 4)[..., :3]
