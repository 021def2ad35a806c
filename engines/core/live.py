"""Answers to one scene after another while a person changes it.

What answers an analysis lives as long as the process and remembers what stays the same between two
scenes: weather, directions, trees of rays. A question is a study as that of a job is; the answer is
the result alone, without pictures and report.
"""

from pathlib import Path

from .analysis import Answer
from .errors import ParameterError
from .progress import SILENT, Progress
from .study import load_study

_answers: dict[str, Answer] = {}
"""What answers each analysis, by its name."""


def answer_study(path: Path, out: Path, *, progress: Progress = SILENT) -> None:
    """Answer the first case of the study in ``path`` with a result in the new folder ``out``.

    Raises HeliformError for what is wrong with the study, ParameterError where its analysis does
    not answer live.
    """
    study = load_study(path)
    case = study.cases[0]
    if case.analysis.live is None:
        raise ParameterError(f"{case.analysis.name} does not answer live; run it as a job.")
    answer = _answers.get(case.analysis.name) or case.analysis.live()
    _answers[case.analysis.name] = answer
    progress(0.0, case.analysis.name)
    result = answer(case.scene, case.parameters)
    out.mkdir(parents=True, exist_ok=True)
    result.save(out)
