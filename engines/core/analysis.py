"""What the rooms offer, found by name.

A room's ``__init__.py`` lists its `Form`s in FORMS and its `Analysis` records in ANALYSES; the
command line, study files, the worker, operators and the explorer find them here as "room.name".
"""

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from .colour import Display
from .errors import ParameterError
from .progress import Progress
from .scene import Mesh, Scene, Vector

_ENGINES = __name__.rsplit(".", 2)[0]
ROOMS = ("glass", "scan", "light", "sun", "structure", "explore", "caustics")


class Run(Protocol):
    """An engine function: scene and record in, result out; deterministic for a given seed."""

    def __call__(self, scene: Scene, record: Any, /, *, seed: int, progress: Progress) -> Any: ...


class Refine(Protocol):
    """An engine function that goes on from what an earlier result kept in the file ``sums``."""

    def __call__(
        self, scene: Scene, record: Any, /, *, seed: int, progress: Progress, sums: Path
    ) -> Any: ...


Answer = Callable[[Scene, Any], Any]
"""Scene and record in, result out, as fast as it can."""


@dataclass(frozen=True, slots=True)
class Form:
    """A shape that a study or a panel can ask for: a record and the function that builds it.

    ``presets`` are named records to start from.
    """

    name: str
    record: type
    build: Callable[[Any], Mesh]
    presets: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Analysis:
    """A name, the record it takes, the function that does it, and the result it gives.

    ``shows`` is the result class: it has ``save(folder) -> list[str]``, ``load(folder)``,
    ``figures()`` and ``meta``, whose notes and, where there are any, facts (name → text) the report
    says. ``draw`` writes a result's pictures and tables into a folder and returns their names.

    ``refine`` goes on from the file ``sums`` of a result's folder; None where that cannot be.
    ``unwrap`` gives a receiver's mesh texture coordinates (F, 3, 2) for a map of so many texels a
    side. ``lamp_files`` are the files that a lamp's photometric file needs beside it. ``live``
    makes what answers for a scene that changes, and remembers from one answer to the next.
    """

    name: str
    record: type
    run: Run
    shows: type
    draw: Callable[[Any, Path, Display], list[str]]
    refine: Refine | None = None
    sums: str = ""
    unwrap: Callable[[Mesh, int], Vector] | None = None
    lamp_files: Callable[[Path], list[Path]] = lambda file: []
    live: Callable[[], Answer] | None = None


def find_form(name: str, where: str) -> Form:
    """The form of that name. Raises ParameterError, naming ``where`` it was asked for."""
    return _find(name, "FORMS", where)


def find_analysis(name: str, where: str) -> Analysis:
    """The analysis of that name. Raises ParameterError, naming ``where`` it was asked for."""
    return _find(name, "ANALYSES", where)


def _find(name: str, listed: str, where: str) -> Any:
    offered = {}
    room = name.partition(".")[0]
    if room in ROOMS:
        try:
            module = importlib.import_module(f"{_ENGINES}.{room}")
        except ModuleNotFoundError as missing:
            if missing.name != f"{_ENGINES}.{room}":
                raise
        else:
            offered = {entry.name: entry for entry in getattr(module, listed, ())}
    if name not in offered:
        known = ", ".join(offered) or "room.name, for example light.trace or glass.object"
        raise ParameterError(f"{where} asks for “{name}”, which there is not; take {known}.")
    return offered[name]
