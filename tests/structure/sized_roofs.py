"""Tasks of sizing for tests: small roofs, and a simply supported beam."""

from dataclasses import replace

import numpy as np
from heliform.engines.structure.frame import Frame
from heliform.engines.structure.level_set import Nine, is_steel
from heliform.engines.structure.loading import Loading, loads_of
from heliform.engines.structure.loads import Loads
from heliform.engines.structure.model import Model
from heliform.engines.structure.roof import Roof, roof_model
from heliform.engines.structure.rules import Rules
from heliform.engines.structure.structure import Structure
from heliform.engines.structure.tasks import Task, families_of, task_of

TIMBER = Nine(**{f"c{i}{j}": -1.0 for i in range(3) for j in range(3)})
SMALL = Roof(spacing=2.5)


def roof(material: Nine | None = None, **rules) -> Structure:
    """A waffle roof of 216 ribs and four columns."""
    return Structure(roof=SMALL, material=material or Nine(), rules=Rules(**rules))


def roof_task(material: Nine | None = None, **rules) -> Task:
    """What is to be sized of it."""
    record = roof(material, **rules)
    model = roof_model(record.roof, record.net)
    loads = loads_of(model, Loading())
    steel = is_steel(record.material, model.surface)
    return task_of(model, loads, steel, families_of(record.rules), record.rules)


def beam_task(load: float, length: float, **rules) -> Task:
    """A weightless simply supported beam along X of steel under ``load`` in N/m downward."""
    held = np.array([[1, 1, 1, 1, 0, 0], [0, 1, 1, 0, 0, 0]], dtype=bool)
    nodes = np.array([[0.0, 0.0, 0.0], [length, 0.0, 0.0]])
    frame = Frame(nodes, np.array([[0, 1]], np.int32), np.array([[0.0, 0.0, 1.0]]), held)
    empty = np.full((0, 4), -1, np.int32)
    model = Model(frame, empty, np.full((1, 2), 0.5), np.zeros(1, np.int32), ("beam",))
    line = np.zeros((1, 1, 2, 3))
    line[..., 2] = -load
    loads = Loads(("load",), ("imposed",), np.zeros((1, 3)), np.zeros((1, 2, 6)), line)
    chosen = replace(Rules(), **rules)
    return task_of(model, loads, np.array([True]), families_of(chosen), chosen)


def mass_of(task: Task, sections: np.ndarray) -> float:
    """The members' mass in kg."""
    per_metre = (task.pool.sections.area * task.pool.density())[sections]
    return float(per_metre @ task.frame.lengths())
