"""Running a study: every case, its files, result.json and the report, or nothing at all."""

import json
import shutil
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .. import VERSION
from .errors import FileError
from .files import draft_of, safe_name
from .progress import SILENT, Progress, part
from .report import write_report
from .study import Case, Study, load_study


def run_study(
    path: Path,
    out: Path,
    *,
    quick: bool = False,
    seed: int | None = None,
    settings: Sequence[str] = (),
    progress: Progress = SILENT,
) -> list[str]:
    """Run the study in ``path`` and write its results into the folder ``out``.

    Everything is written beside ``out`` first and moved there at the end, so a run that fails or is
    cancelled leaves ``out`` as it was. Returns the files' names relative to ``out``, the last ones
    result.json and report.html.

    Raises HeliformError for anything that is wrong with the study or the folder, Cancelled when
    ``progress`` is asked to stop.
    """
    study = load_study(path, quick=quick, seed=seed, settings=settings)
    draft = draft_of(out)
    shutil.rmtree(draft, ignore_errors=True)
    try:
        draft.mkdir(parents=True)
    except OSError as failed:
        raise FileError(
            f"The folder “{out}” cannot be written: {failed.strerror}; choose another."
        ) from None
    try:
        files = _run(study, draft, progress)
        _move(draft, out, files)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return files


def _run(study: Study, folder: Path, progress: Progress) -> list[str]:
    started = time.perf_counter()
    summary: dict[str, Any] = {
        "study": study.name,
        "title": study.title,
        "about": study.about,
        "heliform": VERSION,
        "seed": study.seed,
        "quick": study.quick,
        "seconds": 0.0,
        "facts": {},
        "figures": {},
        "files": [],
        "notes": [],
    }
    files = summary["files"]
    pictures: list[str] = []
    for index, case in enumerate(study.cases):
        count = len(study.cases)
        share = part(
            progress, index / count, (index + 1) / count, f"{case.name}: " * bool(case.name)
        )
        _run_case(case, study.seed, folder, share, summary, pictures)
    summary["seconds"] = time.perf_counter() - started
    files += ["result.json", "report.html"]
    text = json.dumps(summary, indent=2, ensure_ascii=False)
    (folder / "result.json").write_text(text, encoding="utf-8")
    write_report(folder, summary, pictures)
    return files


def _run_case(
    case: Case,
    seed: int,
    folder: Path,
    progress: Progress,
    summary: dict[str, Any],
    pictures: list[str],
) -> None:
    result = _computed(case, seed, progress)
    place = folder / safe_name(case.name) if case.name else folder
    place.mkdir(exist_ok=True)
    saved = result.save(place)
    drawn = case.analysis.draw(result, place, case.display)
    stem = f"{place.name}/" if case.name else ""
    summary["files"] += [stem + name for name in [*saved, *drawn]]
    pictures += [stem + name for name in drawn]
    prefix = f"{case.name}." if case.name else ""
    summary["figures"] |= {prefix + name: figure for name, figure in result.figures().items()}
    facts = result.meta.get("facts", {})
    summary["facts"] |= {f"{case.name}: {n}" if case.name else n: t for n, t in facts.items()}
    summary["notes"] += [f"{case.name}: {n}" if case.name else n for n in result.meta["notes"]]


def _computed(case: Case, seed: int, progress: Progress) -> Any:
    given = {"seed": seed, "progress": progress}
    if case.sums is None:
        return case.analysis.run(case.scene, case.parameters, **given)
    assert case.analysis.refine
    return case.analysis.refine(case.scene, case.parameters, **given, sums=case.sums)


def _move(draft: Path, out: Path, files: list[str]) -> None:
    """Bring the finished files to ``out``, over those of an earlier run."""
    try:
        for name in files:
            (out / name).parent.mkdir(parents=True, exist_ok=True)
            (draft / name).replace(out / name)
    except OSError as failed:
        raise FileError(
            f"The folder “{out}” cannot be written: {failed.strerror}; choose another."
        ) from None
