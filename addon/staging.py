"""What an analysis takes of Blender's scene, and what becomes of its result there: one a room."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import bpy

from ..engines.core.analysis import Analysis
from ..engines.core.colour import Display
from ..engines.core.scene import Scene

Objects = Mapping[str, bpy.types.Object]


@dataclass(frozen=True, slots=True)
class Gathered:
    """What a job is given: the engines' scene, the parameters, and whose result it will be.

    ``objects`` are those that the result belongs to, by the names that they have in the study;
    where there are some, the result needs one of them to be there still. ``notes`` say what was
    done to gather them, which is an undo step of its own, ``remarks`` what a reader must know of
    what was taken. ``display`` is how its pictures are coloured, as the scene's results where None.
    """

    name: str
    scene: Scene
    parameters: Any
    objects: Objects = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    display: Display | None = None


class Stage(Protocol):
    """Puts a result into a scene: whether it is the first there, so that views should show it.

    ``objects`` are those of `Gathered` that are still there, ``folder`` is where the result's files
    lie and ``notes`` are added to those that it has.
    """

    def __call__(
        self,
        scene: bpy.types.Scene,
        objects: Objects,
        result: Any,
        folder: Path,
        /,
        notes: tuple[str, ...] = (),
    ) -> bool: ...


@dataclass(frozen=True, slots=True)
class Staging:
    """How an analysis and Blender meet.

    ``gather`` raises HeliformError where the scene does not have what it takes. ``add`` adds what
    the parameters of a study describe, where they are no settings of a scene; it raises too.
    """

    gather: Callable[[bpy.types.Context, Analysis], Gathered]
    stage: Stage
    add: Callable[[bpy.types.Scene, Any], None] | None = None
