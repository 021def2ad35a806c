"""Answers to one scene after another while a person changes it.

What answers an analysis lives as long as the process and remembers what stays the same between two
scenes: weather, directions, trees of rays. A question is a study as that of a job is; the answer is
the result alone, without pictures and report.
"""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np

from .analysis import Answer
from .errors import ParameterError
from .progress import SILENT, Progress
from .scene import Scene
from .study import load_study

_answers: dict[str, Answer] = {}
"""What answers each analysis, by its name."""
_scenes: dict[str, Scene] = {}
"""The scene that each analysis was last asked about."""


def answer_study(path: Path, out: Path, *, progress: Progress = SILENT) -> None:
    """Answer the first case of the study in ``path`` with a result in the new folder ``out``.

    Raises HeliformError for what is wrong with the study, ParameterError where its analysis does
    not answer live.
    """
    study = load_study(path)
    case = study.cases[0]
    if case.analysis.live is None:
        raise ParameterError(f"{case.analysis.name} does not answer live; run it as a job.")
    name = case.analysis.name
    progress(0.0, name)
    answer = _answers[name] = _answers.get(name) or case.analysis.live()
    scene = _scenes[name] = kept(case.scene, _scenes.get(name, Scene()))
    result = answer(scene, case.parameters)
    out.mkdir(parents=True, exist_ok=True)
    result.save(out)


def kept(scene: Scene, before: Scene) -> Scene:
    """``scene`` with every thing that was the same ``before`` as the very object it was."""
    return Scene(
        _kept(scene.bodies, before.bodies),
        _kept(scene.luminaires, before.luminaires),
        _kept(scene.receivers, before.receivers),
    )


def _kept(things: tuple[Any, ...], before: tuple[Any, ...]) -> tuple[Any, ...]:
    known = {thing.name: thing for thing in before}
    return tuple(known[t.name] if same(t, known.get(t.name)) else t for t in things)


def same(one: Any, other: Any) -> bool:
    """Whether two values are equal, be they arrays, records or rows of them."""
    if type(one) is not type(other):
        return False
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if dataclasses.is_dataclass(one):
        names = [field.name for field in dataclasses.fields(one)]
        return all(same(getattr(one, name), getattr(other, name)) for name in names)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return one == other
