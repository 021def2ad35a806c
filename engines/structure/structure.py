"""A structure as one record: its form, its materials, its loads and the rules it is sized by."""

import math
import time
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from .. import VERSION
from ..core.errors import SceneError
from ..core.parameters import nested, param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Mesh, Scene
from ..core.threads import one_thread
from .assembly import Pattern, pattern_of
from .candidates import Index
from .facade import Facade, facade_model
from .final import final_of
from .form_finding import FormFinding, formed
from .from_mesh import Network, model_from_edges
from .grouping import size_with_few
from .level_set import Nine, is_steel, turn_at, turned
from .loading import Loading, loads_of
from .model import Model
from .roof import Roof, roof_model
from .rules import Rules
from .service import size_stiff
from .shell import Shell, shell_model
from .sized import Sized
from .sizing import Chosen, size_members
from .surface import Net
from .tasks import Task, families_of, task_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """A space frame to be sized: where it runs, of what it is, what loads it, by which rules."""

    form: Literal["roof", "shell", "facade", "mesh"] = param(
        "roof", help="A waffle roof, a shell, a tower's façade, or the edges of the first body"
    )
    roof: Roof = nested(Roof, "The roof")  # noqa: RUF009
    shell: Shell = nested(Shell, "The shell")  # noqa: RUF009
    facade: Facade = nested(Facade, "The façade")  # noqa: RUF009
    network: Network = nested(Network, "How a mesh becomes a structure")  # noqa: RUF009
    net: Net = nested(Net, "How the surface's control points are moved")  # noqa: RUF009
    material: Nine = nested(Nine, "Level set over the surface: above 0 is steel, else timber")  # noqa: RUF009
    turn: Nine = nested(Nine, "How far members are turned about themselves, over the surface")  # noqa: RUF009
    turn_limit: float = param(0.0, "deg", 0.0, 90.0, "Turn at a level of 1")
    form_finding: FormFinding = nested(FormFinding, "Shape that a net finds")  # noqa: RUF009
    loading: Loading = nested(Loading, "Loads")  # noqa: RUF009
    rules: Rules = nested(Rules, "How sections are chosen and checked")  # noqa: RUF009


def size_structure(
    scene: Scene, record: Structure, *, seed: int = 0, progress: Progress = SILENT
) -> Sized:
    """The structure that a record describes, sized and checked; nothing of ``seed`` is used.

    ``scene`` is asked only for the mesh of the “mesh” form. Raises ParameterError, SceneError and
    FileError as `model_of`, `loads_of`, `families_of` and `size_members` do, Cancelled when
    ``progress`` is asked to stop.
    """
    return design(record, scene, seed=seed, progress=progress)


def design(
    record: Structure,
    scene: Scene,
    *,
    start: Sized | None = None,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Sized:
    """As `size_structure`, from the sections of an earlier result where ``start`` is one.

    A start of other members or families is passed over.
    """
    progress(0.0, "Laying out the members")
    return design_model(model_of(record, scene), record, start=start, seed=seed, progress=progress)


def design_model(
    model: Model,
    record: Structure,
    *,
    start: Sized | None = None,
    pattern: Pattern | None = None,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Sized:
    """`design` of a model that is there already; ``pattern`` may be that of its frame."""
    began = time.perf_counter()
    loads = loads_of(model, record.loading)
    steel = is_steel(record.material, model.surface)
    task = task_of(model, loads, steel, families_of(record.rules), record.rules)
    pattern = pattern or pattern_of(model.frame)
    begin, report = _start(task, start), part(progress, 0.05, 0.9)
    chosen = size_task(task, start=begin, pattern=pattern, progress=report)
    progress(0.9, "Checking all of it")
    meta = {"parameters": to_table(record), "seed": seed, "version": VERSION, "notes": []}
    with one_thread():
        result = final_of(model, task, chosen, pattern, meta)
    result.meta["seconds"] = time.perf_counter() - began
    return result


def size_task(task: Task, *, start: Index | None, pattern: Pattern, progress: Progress) -> Chosen:
    """Size as the rules say: with few sizes, stiff enough, or for strength alone."""
    given: dict[str, Any] = {"start": start, "pattern": pattern, "progress": progress}
    stiff = task.rules.service or task.rules.stability > 0
    size = size_stiff if stiff else size_members
    with one_thread():
        if task.rules.sizes:
            return size_with_few(task, task.rules.sizes, size, **given)
        return size(task, **given)


def model_of(record: Structure, scene: Scene) -> Model:
    """The frame that a record describes, its members turned.

    ``scene`` is asked only for the “mesh” form: the edges of its first body are the members.
    Raises SceneError where there is no body, and as the forms do.
    """
    if record.form == "roof":
        model = roof_model(record.roof, record.net)
    elif record.form == "shell":
        model = shell_model(record.shell, record.net)
    elif record.form == "facade":
        model = facade_model(record.facade, record.net)
    elif scene.bodies:
        model = mesh_model(scene.bodies[0].mesh, record.network)
    else:
        raise SceneError("There is no body whose edges could be members; add one.")
    model = formed(model, record.form_finding)
    if record.turn_limit:
        model = turned(model, turn_at(record.turn, model.surface, math.radians(record.turn_limit)))
    return model


def mesh_model(mesh: Mesh, network: Network) -> Model:
    """The model whose members are a mesh's edges. Raises SceneError as `model_from_edges`.

    A face that names a corner again right after it has one corner less; one of two corners is an
    edge alone.
    """
    ends = np.stack([mesh.faces, np.roll(mesh.faces, -1, axis=1)], axis=-1)
    changes = ends[..., 0] != ends[..., 1]
    edges = np.unique(np.sort(ends[changes], axis=1), axis=0)
    cells = [
        face[kept].tolist()
        for face, kept in zip(mesh.faces, changes, strict=True)
        if kept.sum() > 2
    ]
    return model_from_edges(mesh.vertices, edges, cells, network)


def _start(task: Task, start: Sized | None) -> Index | None:
    """The sections (M,) of an earlier result in the task's pool, None where it is of another."""
    families = [one.name for one in task.pool.families]
    if start is None or start.meta["families"] != families:
        return None
    if not np.array_equal(start.model.frame.members, task.frame.members):
        return None
    counts = np.array([len(one.sections) for one in task.pool.families])
    family, section = start.rows["family"], start.rows["section"]
    if (section >= counts[family]).any():
        return None
    return (np.cumsum(counts) - counts)[family] + section
