"""What follows hands, frames and undo: objects that are rebuilt when their handles have moved.

Blender says that a handle moved while it is drawing; the object is rebuilt right after, in a timer.
Where there are no timers, in background, a change of frame rebuilds at once.
"""

from collections.abc import Callable, Iterable

import bpy

from .bridge.handles import name_of

Follow = Callable[[bpy.types.Object, bpy.types.Scene], None]

_followers: dict[str, Follow] = {}
_waiting: set[int] = set()


def follow(form: str, act: Follow) -> None:
    """Have ``act`` called with objects of this form, and their scene, when their handles moved."""
    _followers[form] = act


@bpy.app.handlers.persistent
def _moved(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Note whose handles have moved, and look after them as soon as Blender is done."""
    for update in depsgraph.updates:
        if update.is_updated_transform and isinstance(update.id, bpy.types.Object):
            handle = update.id.original
            if name_of(handle) and handle.parent is not None:
                _waiting.add(handle.parent.session_uid)
    _wake()


def _wake() -> None:
    if _waiting and not bpy.app.timers.is_registered(_look_after):
        bpy.app.timers.register(_look_after, first_interval=0.0)


def _look_after() -> None:
    uids = set(_waiting)
    _waiting.clear()
    for scene in bpy.data.scenes:
        _follow(scene, (obj for obj in scene.objects if obj.session_uid in uids))


def _follow(scene: bpy.types.Scene, objects: Iterable[bpy.types.Object]) -> None:
    for obj in objects:
        act = _followers.get(obj.heliform.form)
        if act is not None:
            act(obj, scene)


@bpy.app.handlers.persistent
def _framed(scene: bpy.types.Scene, *_: object) -> None:
    _follow(scene, list(scene.objects))


@bpy.app.handlers.persistent
def _undone(*_: object) -> None:
    for scene in bpy.data.scenes:
        _waiting.update(obj.session_uid for obj in scene.objects if obj.heliform.form in _followers)
    _wake()


_HANDLERS = (
    (bpy.app.handlers.depsgraph_update_post, _moved),
    (bpy.app.handlers.frame_change_post, _framed),
    (bpy.app.handlers.undo_post, _undone),
    (bpy.app.handlers.redo_post, _undone),
)


def register() -> None:
    """Begin to follow."""
    for handlers, act in _HANDLERS:
        handlers.append(act)


def unregister() -> None:
    """Follow no more."""
    for handlers, act in _HANDLERS:
        handlers.remove(act)
    if bpy.app.timers.is_registered(_look_after):
        bpy.app.timers.unregister(_look_after)
    _waiting.clear()
