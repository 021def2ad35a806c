"""As printed: a scan of the finished piece against its design."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from .. import VERSION
from ..core.errors import SceneError
from ..core.parameters import nested, param, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Body, Scene, Vector
from .closest import closest
from .design import Design, design_of
from .deviation import picture_of, spread
from .found import Found, LayerTable, Sides, grown, layers_of
from .judge import Registration
from .load import METRES, Scan, Sizes, Unit, load_scan
from .printed_figures import Measured, figures_of, remarks
from .printed_result import AsPrinted
from .register import register
from .settle import Sample, lever_of

_ALIKE = 1.6  # as large or as small as a scan may be beside its design without a question
_FITS = 1.35  # how close in size another unit must bring it to be taken
_FEWEST = 1000  # points to measure layers from


@dataclass(frozen=True, slots=True, kw_only=True)
class Placement:
    """Where the scan's own origin stands in the scene, and how it is turned."""

    x: float = param(0.0, "m", -1e3, 1e3, "Along X")
    y: float = param(0.0, "m", -1e3, 1e3, "Along Y")
    z: float = param(0.0, "m", -1e3, 1e3, "Up")
    turn_x: float = param(0.0, "deg", -360.0, 360.0, "About X, first")
    turn_y: float = param(0.0, "deg", -360.0, 360.0, "About Y, second")
    turn_z: float = param(0.0, "deg", -360.0, 360.0, "About Z, last")

    @property
    def matrix(self) -> Vector:
        """The pose (4, 4)."""
        pose = np.eye(4)
        angles = [self.turn_x, self.turn_y, self.turn_z]
        pose[:3, :3] = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
        pose[:3, 3] = self.x, self.y, self.z
        return pose


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """How a scan of a finished piece is compared with its design."""

    file: str = param("", help="PLY, OBJ or STL of the scanned piece")
    unit: Unit = param(  # noqa: RUF009
        "guess", help="Unit of the file's numbers; “guess” goes by the size of the design"
    )
    body: str = param("", help="Name of the design among the bodies; empty where there is one")
    start: Literal["found", "as placed"] = param(
        "found", help="Look for the pose everywhere, or begin from where the scan was placed"
    )
    placed: Placement = nested(Placement, "Where the scan was placed by hand")  # noqa: RUF009
    fit_scale: bool = param(False, help="Let the scan grow or shrink to fit, and say by how much")
    tolerance: float = param(1e-3, "m", 1e-6, 0.1, "Deviation that is still right")
    near: float = param(5e-3, "m", 1e-4, 0.1, "Points farther from the design are strays")
    overlap: float = param(0.5, "", 0.01, 1.0, "Least share of the scan that must be near")


def compare(
    scene: Scene, record: Comparison, *, seed: int = 0, progress: Progress = SILENT
) -> AsPrinted:
    """The scan in ``record.file`` against a body of the scene that stands upright as printed.

    The scan is laid onto the design (see `register`), its distance along the design's normal is
    spread over the design's surface (see `spread`), and layers and wall are measured on
    both alike (see `layers_of`). A wall that is off by more than half its thickness cannot
    be told from its other side.

    Raises FileError for a file that cannot be read, SceneError where there is no such body, the
    unit is another one, or the scan does not lie on the design; Cancelled when ``progress`` is
    asked to stop.
    """
    progress(0.0, "Reading the scan")
    body = _body(scene, record)
    if not record.file:
        raise SceneError("There is no scan to compare with; choose a PLY, OBJ or STL file.")
    size = float(np.ptp(body.mesh.vertices, axis=0).max()) if len(body.mesh.vertices) else 0.1
    sizes = Sizes(min(0.015, size / 10), max(1.5, 3 * size), size, "a piece of this size")
    scan = load_scan(Path(record.file), record.unit, sizes=sizes)
    return compared(scan, body, record, seed=seed, progress=part(progress, 0.1, 1.0))


def compared(
    scan: Scan, body: Body, record: Comparison, *, seed: int = 0, progress: Progress = SILENT
) -> AsPrinted:
    """A scan in memory against a design; otherwise as `compare`."""
    started = time.perf_counter()
    progress(0.0, "Measuring the design")
    design = design_of(body, seed)
    points, notes = _sized(scan, design, record.unit)
    sample = Sample(points, _normals(points, scan.faces) if len(scan.faces) else None)
    pose = register(
        sample,
        design.target,
        start=record.placed.matrix if record.start == "as placed" else None,
        fit_scale=record.fit_scale,
        pitch=design.pitch,
        near=record.near,
        seed=seed,
        progress=part(progress, 0.1, 0.5),
    )
    _require_overlap(pose, scan, design, record)
    moved = points @ pose.matrix[:3, :3].T + pose.matrix[:3, 3]
    feet = closest(moved, design.target, record.near, part(progress, 0.5, 0.8, "Deviation: "))
    progress(0.8, "Spreading the deviation over the design")
    deviation = spread(feet, design.target, record.near)
    progress(0.9, "Measuring the layers")
    wall = design.unroll(moved[deviation.belongs], feet.face[deviation.belongs])
    found = _found(wall, design, pose.scale)
    value = feet.distance[deviation.belongs]
    measured = Measured(design, pose, deviation, found, len(points))
    outside, inside = (_picture(wall, value, design, side) for side in (1, -1))
    progress(1.0, "Done")
    return AsPrinted(
        vertices=body.mesh.vertices,
        deviation=deviation.vertices,
        area=deviation.area,
        outside=outside,
        inside=inside,
        matrix=pose.matrix,
        layers=found.layers if found else LayerTable.empty(),
        design_layers=design.found.layers if design.found else LayerTable.empty(),
        meta={
            "quantity": "Deviation",
            "unit": "m",
            "scan": scan.name,
            "design": body.name,
            "figures": figures_of(measured, record.tolerance),
            "pose": _pose_table(pose),
            "parameters": to_table(record),
            "seed": seed,
            "version": VERSION,
            "seconds": time.perf_counter() - started,
            "notes": notes + remarks(measured, record.near),
        },
    )


def _body(scene: Scene, record: Comparison) -> Body:
    """The design among the scene's bodies."""
    bodies = {body.name: body for body in scene.bodies}
    names = ", ".join(f"“{name}”" for name in bodies)
    if not bodies:
        raise SceneError("There is no design to compare with; choose the wall that was printed.")
    if not record.body:
        if len(bodies) > 1:
            raise SceneError(f"Several bodies may be the design; set body to one of {names}.")
        return next(iter(bodies.values()))
    if record.body not in bodies:
        raise SceneError(f"There is no body “{record.body}” to compare with; there are: {names}.")
    return bodies[record.body]


def _sized(scan: Scan, design: Design, unit: str) -> tuple[Vector, list[str]]:
    """The scan's points in m, in the unit that was asked for, or that the design suggests."""
    notes = list(scan.notes)
    ratio = lever_of(scan.points) / design.size
    if 1 / _ALIKE < ratio < _ALIKE:
        return scan.points, notes
    taken = [scan.unit] if scan.unit else list(METRES)
    options = [(METRES[name] / METRES[one], name) for one in taken for name in METRES]
    factor, right = min(options, key=lambda option: abs(np.log(ratio * option[0])))
    fits = abs(np.log(ratio * factor)) < np.log(_FITS)
    size = f"{ratio:.3g} times larger" if ratio > 1 else f"{1 / ratio:.3g} times smaller"
    if fits and unit != "guess":
        raise SceneError(
            f"With its numbers in {unit}, the scan “{scan.name}” is {size} than “{design.name}”; "
            f"set the unit to {right}."
        )
    if fits:
        notes.append(
            f"Beside “{design.name}” the scan was {size}: its lengths were multiplied by "
            f"{factor:.4g} to be in another unit."
        )
        return scan.points * factor, notes
    if ratio > 1:
        raise SceneError(
            f"The scan “{scan.name}” is {size} than “{design.name}”, and in no unit alike; check "
            "that nothing but this piece was scanned."
        )
    return scan.points, notes  # of a part of the piece; whether it fits will be seen


def _normals(points: Vector, faces: NDArray[np.int32]) -> Vector:
    """Unit normals (N, 3) of a mesh's vertices, by the area of the faces about them."""
    a, b, c = points[faces].transpose(1, 0, 2)
    cross = np.cross(b - a, c - a)
    total = np.stack(
        [np.bincount(faces.ravel(), np.repeat(one, 3), len(points)) for one in cross.T], axis=1
    )
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-300)


def _require_overlap(pose: Registration, scan: Scan, design: Design, record: Comparison) -> None:
    if pose.overlap >= record.overlap:
        return
    said = (
        f"Only {100 * pose.overlap:.0f} % of the scan “{scan.name}” lies within "
        f"{record.near * 1e3:.3g} mm of “{design.name}”"
    )
    if record.start == "as placed":
        raise SceneError(f"{said} from where it was placed; place it closer, or let it be found.")
    raise SceneError(
        f"{said}, however it is turned; check the unit and that it is this piece, or place it by "
        "hand."
    )


def _found(wall: Sides, design: Design, scale: float) -> Found | None:
    """Layers and widths in the scan's own size, None without a wall or enough of it."""
    if design.around is None or np.count_nonzero(wall.side) < _FEWEST:
        return None
    return grown(layers_of(wall), 1 / scale)


def _picture(wall: Sides, value: Vector, design: Design, side: int) -> Vector:
    """The deviation (N,) of a side unrolled, empty where it was not seen."""
    some = wall.side == side
    if np.count_nonzero(some) < _FEWEST:
        return np.zeros((0, 0))
    return picture_of(wall.turn[some], wall.z[some], value[some], design.girth)


def _pose_table(pose: Registration) -> dict[str, Any]:
    """The pose for a file; what is loose has no deviation."""
    return {
        "matrix": pose.matrix.tolist(),
        "scale": pose.scale,
        "pivot": pose.pivot.tolist(),
        "turn_deviation": np.degrees(pose.turn_deviation).tolist(),
        "shift_deviation": [v if np.isfinite(v) else None for v in pose.shift_deviation.tolist()],
        "covariance": pose.covariance.tolist(),
        "loose": pose.loose.tolist(),
        "iterations": pose.iterations,
        "settled": pose.settled,
    }
