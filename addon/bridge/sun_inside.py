"""See Inside: bodies as their edges, so that maps within a closed one can be seen."""

import bpy

_KEPT = "heliform_display"


def follow(scene: bpy.types.Scene) -> None:
    """Draw all bodies as their edges while the scene's switch is on, else as they were before.

    What they were lies with each, so undo and saved files have both.
    """
    for obj in scene.objects:
        if scene.heliform.see_inside and obj.heliform.role == "BODY" and _KEPT not in obj:
            obj[_KEPT] = obj.display_type
            obj.display_type = "WIRE"
        elif not scene.heliform.see_inside and _KEPT in obj:
            obj.display_type = obj.pop(_KEPT)
