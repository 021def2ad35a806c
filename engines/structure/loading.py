"""What loads a structure: a record, the load cases it makes, and what they add up to."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..core.errors import ParameterError, SceneError
from ..core.parameters import fields_of, param
from ..core.scene import Vector
from .frame import Frame
from .loads import GRAVITY, Action, Loads
from .model import Model
from .tributary import Tributary, tributary_of
from .wind import WINDS, wind_pressures

RINGS = "rings"
_DOWN = np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True, slots=True, kw_only=True)
class Loading:
    """Characteristic loads of a structure; a load of 0 makes no load case."""

    self_weight: bool = param(True, help="Weigh the members themselves")
    area_load: float = param(
        5000.0, "N/m²", 0.0, 1e6, "Vertical load on the surface, as on the thesis's roofs"
    )
    area_from: Literal["plan", "surface"] = param(
        "plan", help="The load counts per area in plan, as snow does, or per area of the surface"
    )
    area_action: Literal["imposed", "snow", "permanent"] = param(
        "imposed", help="What the load on the surface is, for partial and combination factors"
    )
    cladding: float = param(
        0.0, "N/m²", 0.0, 1e5, "Permanent weight of glass or roofing, per area of the surface"
    )
    floor_load: float = param(
        0.0, "N/m²", 0.0, 1e5, "Load on the floors that the rings of a façade carry at their edge"
    )
    floor_depth: float = param(
        4.0, "m", 0.0, 100.0, "Strip of floor on a ring: half the way from the façade to the core"
    )
    wind: float = param(
        0.0, "N/m²", 0.0, 1e5, "Pressure of the wind; the thesis's façades take 2500"
    )
    wind_from: Literal["four", "x", "y"] = param(
        "four", help="Winds along ±X and ±Y, each its own case, or only those along one axis"
    )
    wind_method: Literal["drag", "normal", "walls"] = param(
        "drag",
        help="On windward faces along the wind or their normals, or walls after EN 1991-1-4",
    )


ROOF_LOADING = Loading()
FACADE_LOADING = Loading(area_load=0.0, wind=2500.0)


def loads_of(model: Model, record: Loading, tributary: Tributary | None = None) -> Loads:
    """The load cases that ``record`` puts on ``model``; ``tributary`` where it is known already.

    In order, those that are not zero: “self-weight”, “cladding”, “area load”, “floor load” and a
    case a wind, “wind +x” for one that blows toward +X.

    Raises ParameterError for a negative load or no load at all; SceneError for a load on a surface
    that has no cells, or on floors where no member belongs to the group “rings”.
    """
    _check_loads(record)
    if tributary is None and record.area_load + record.cladding + record.wind > 0:
        if not len(model.cells):
            raise SceneError(
                "The structure has no cells for a load on its surface to act on; set area_load, "
                "cladding and wind to 0, or close cells between its members."
            )
        tributary = tributary_of(model.frame, model.cells)
    names: list[str] = []
    actions: list[Action] = []
    lines: list[Vector] = []

    def add(name: str, action: Action, line: Vector) -> None:
        names.append(name)
        actions.append(action)
        lines.append(line)

    count = len(model.frame.members)
    if record.self_weight:
        add("self-weight", "permanent", np.zeros((count, 2, 3)))
    if tributary is not None:
        surface = np.ones(len(tributary.vectors))
        if record.cladding:
            weight = record.cladding * surface[:, None] * _DOWN
            add("cladding", "permanent", tributary.line_loads(weight))
        if record.area_load:
            share = tributary.slopes if record.area_from == "plan" else surface
            weight = record.area_load * share[:, None] * _DOWN
            add("area load", record.area_action, tributary.line_loads(weight))
    if record.floor_load:
        add("floor load", "imposed", _floor_lines(model, record))
    if tributary is not None and record.wind:
        for name in _winds(record):
            pressures = wind_pressures(tributary, WINDS[name], record.wind, record.wind_method)
            add(f"wind {name}", "wind", tributary.line_loads(pressures))
    if not names:
        raise ParameterError(
            "[structure.loading] loads nothing; tick self_weight or give a load above 0."
        )
    gravity = np.zeros((len(names), 3))
    if record.self_weight:
        gravity[0] = GRAVITY * _DOWN
    nodal = np.zeros((len(names), len(model.frame.nodes), 6))
    return Loads(tuple(names), tuple(actions), gravity, nodal, np.stack(lines))


def resultants(frame: Frame, loads: Loads, mass: Vector | None = None) -> Vector:
    """Force in N and moment about the origin in N·m (C, 6) of each load case.

    ``mass`` (M,) in kg/m, as of the members' `Rigidities`, weighs them; without it they weigh 0.
    """
    ends, lengths = frame.ends(), frame.lengths()
    line = loads.line
    if mass is not None:
        line = line + loads.gravity[:, None, None, :] * mass[:, None, None]
    # A load linear between two ends meets a lever linear between them: L/6 · [2 1; 1 2].
    linear = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    levers = np.einsum("m,vw,mwi->mvi", lengths, linear, ends)
    force = np.einsum("m,cmvi->ci", lengths / 2, line) + loads.nodal[..., :3].sum(axis=1)
    moment = np.cross(levers, line).sum(axis=(1, 2)) + loads.nodal[..., 3:].sum(axis=1)
    moment = moment + np.cross(frame.nodes, loads.nodal[..., :3]).sum(axis=1)
    return np.concatenate([force, moment], axis=1)


def _check_loads(record: Loading) -> None:
    for field in fields_of(Loading):
        value = getattr(record, field.name)
        if field.kind == "float" and not (np.isfinite(value) and value >= 0):
            raise ParameterError(
                f"[structure.loading] {field.name} = {value:g} {field.unit} is no load; give 0 or "
                "more, for loads act downward and winds blow along their names."
            )


def _winds(record: Loading) -> tuple[str, ...]:
    return tuple(name for name in WINDS if record.wind_from in ("four", name[1]))


def _floor_lines(model: Model, record: Loading) -> Vector:
    """Line loads (M, 2, 3) of the strips of floor along the rings."""
    names = model.group_names
    rings = model.groups == (names.index(RINGS) if RINGS in names else -1)
    if not rings.any():
        raise SceneError(
            "There are no rings to carry the floors; set floor_load to 0, or take a façade with "
            "rings."
        )
    strip = np.where(rings, record.floor_load * record.floor_depth, 0.0)
    return np.broadcast_to(strip[:, None, None] * _DOWN, (len(rings), 2, 3))
