"""What follows hands, frames and undo: objects that are rebuilt when their handles have moved.

Blender says that a handle moved while it is drawing; the object is rebuilt right after, in a timer,
and, once it has been let go of, again at leisure. In background there are no timers, and a
change of frame rebuilds at once.
"""

from collections.abc import Callable, Iterable

import bpy

from .bridge.handles import name_of

_LOOK = 0.1  # seconds between two looks whether what is dragged was let go of

Follow = Callable[[bpy.types.Object, bpy.types.Scene], None]

_followers: dict[str, tuple[Follow, Follow]] = {}
_waiting: set[int] = set()
_resting: set[int] = set()


def follow(form: str, act: Follow, finish: Follow) -> None:
    """Have ``act`` called with objects of this form, and their scene, when their handles moved.

    ``finish`` is called with those for which `settle` was.
    """
    _followers[form] = act, finish


def settle(obj: bpy.types.Object, pause: float) -> None:
    """Have the object finished once nothing has moved for ``pause`` seconds and nothing is held."""
    _resting.add(obj.session_uid)
    if bpy.app.timers.is_registered(_finish):
        bpy.app.timers.unregister(_finish)
    bpy.app.timers.register(_finish, first_interval=pause)


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
    _take(_waiting, 0)


def _finish() -> float | None:
    if _dragging():
        return _LOOK
    _take(_resting, 1)
    return None


def _dragging() -> bool:
    """Whether something is being moved in a window: where that draws slowly, it pauses."""
    return any(
        operator.bl_idname.startswith("TRANSFORM_OT_")
        for window in bpy.context.window_manager.windows
        for operator in window.modal_operators
    )


def _take(chosen: set[int], which: int) -> None:
    """Call the first or second of their followers for the objects chosen, and forget them."""
    uids = set(chosen)
    chosen.clear()
    for scene in bpy.data.scenes:
        _follow(scene, [obj for obj in scene.objects if obj.session_uid in uids], which)


def _follow(scene: bpy.types.Scene, objects: Iterable[bpy.types.Object], which: int = 0) -> None:
    for obj in objects:
        if obj.heliform.form in _followers:
            _followers[obj.heliform.form][which](obj, scene)


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
    for timer in (_look_after, _finish):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    _waiting.clear()
    _resting.clear()
