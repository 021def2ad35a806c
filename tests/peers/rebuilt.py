"""From a scan to the caustic: walls whose surface is written down, a sample cut from such a print
and scanned, and the same walls rebuilt from what was read.

The truth is the independent generator's (`scan.generator`): its bead and its roughness, wound once
around a turn of `TURN` so that they close, on a base curve r(θ) = radius (1 + a cos kθ) midway in
the wall. It shares no code with the engines. The sample is 73 × 49 mm of a tube, at the height
`cut_at`; relief does not know the base curve it comes from, so that one sample serves all walls.
"""

from dataclasses import dataclass, replace

import numpy as np
from heliform.engines.core.scene import Body, Lamp, Luminaire, Material, Mesh, Scene
from heliform.engines.glass.bead import Bead
from heliform.engines.glass.fourier import Plan
from heliform.engines.glass.printed import Wall, wall_skin
from heliform.engines.glass.profile import Style, normalised
from heliform.engines.glass.relief import Relief, relieved
from heliform.engines.light import PhotonTracing, trace
from heliform.engines.scan import ScanReading, read
from heliform.engines.scan.clean import clean
from heliform.engines.scan.load import Scan, scan_of
from light import scenes
from scan.generator import Piece, Truth, profile, scan

TURN = 640.0  # mm around the outer base surface: four patches of the generator's roughness
LAYERS, ROWS, COLUMNS = 40, 32, 480
LAYER, CORE, SAG = 5.0, 8.0, 1.2  # mm; CORE is the wall without its beads
GAP, LAMP, PLANE, TEXELS = 1e-3, 0.22, 0.8, 256

SMOOTHINGS = {
    "HC Laplacian × 1": ("apply_coord_hc_laplacian_smoothing", {}),
    "Taubin × 10": ("apply_coord_taubin_smoothing", {"stepsmoothnum": 10}),
    "Laplacian × 10": ("apply_coord_laplacian_smoothing", {"stepsmoothnum": 10}),
}


@dataclass(frozen=True)
class Base:
    """A base curve, midway in the wall; mm."""

    name: str
    waves: int = 0
    height: float = 0.0
    radius: float = TURN / (2 * np.pi) - CORE / 2

    def at(self, turn):
        """Places (N, 2) at shares of the length, and the normals out of it."""
        theta = np.linspace(0, 2 * np.pi, 1 << 16)
        r = self.radius * (1 + self.height * np.cos(self.waves * theta))
        points = np.column_stack([r * np.cos(theta), r * np.sin(theta)])
        length = np.append(0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
        theta = np.interp(turn, length / length[-1], theta)
        r = self.radius * (1 + self.height * np.cos(self.waves * theta))
        slope = -self.radius * self.height * self.waves * np.sin(self.waves * theta)
        out = np.column_stack([np.cos(theta), np.sin(theta)])
        across = np.column_stack([-np.sin(theta), np.cos(theta)])
        normal = r[:, None] * out - slope[:, None] * across
        return r[:, None] * out, normal / np.linalg.norm(normal, axis=1)[:, None]


TUBE, ROSETTE = Base("tube"), Base("rosette", 5, 0.06)


def print_of(seed: int, points: int, noise: float = 0.05) -> Piece:
    """The sample and its scan: one layer a turn, so that what it is cut from closes."""
    tilt = -np.degrees(np.arcsin(LAYER / TURN))
    circle = TURN / (2 * np.pi)
    return Piece(seed=seed, points=points, noise=noise, radius=circle, wall=CORE, tilt=tilt)


def cut_at(truth: Truth) -> float:
    """Height in mm of the sample's middle in the wall whose first layer starts at z = 0."""
    return (truth.offset + LAYERS // 2) * LAYER / np.cos(np.radians(truth.piece.tilt))


def true_wall(base: Base, truth: Truth) -> Mesh:
    """The wall itself in m: both faces from the written surface, its exact normals, flat rims."""
    turn = np.arange(COLUMNS) / COLUMNS
    z = np.linspace(0, LAYERS * LAYER, LAYERS * ROWS + 1)
    grid_turn, grid_z = np.meshgrid(turn, z)
    grid = grid_turn.ravel(), grid_z.ravel()
    vertices = np.concatenate([_face(base, truth, *grid, side) for side in (0, 1)])
    normals = np.concatenate([_normals(base, truth, *grid, side) for side in (0, 1)])
    rows, start = len(z), len(z) * COLUMNS
    last = start - COLUMNS
    outer = _quads(np.arange(rows - 1) * COLUMNS, np.arange(1, rows) * COLUMNS)
    inner = outer[:, ::-1] + start
    top = _quads([last], [start + last])
    bottom = _quads([start], [0])
    faces = np.concatenate([outer, inner, top, bottom])
    corners = normals[faces].astype(np.float32)
    corners[-2 * COLUMNS : -COLUMNS] = 0, 0, 1
    corners[-COLUMNS:] = 0, 0, -1
    return _lifted(Mesh(vertices * 1e-3, faces.astype(np.int32), corners))


def _lifted(mesh: Mesh) -> Mesh:
    """A hair above the plane."""
    shift = np.eye(4)
    shift[2, 3] = GAP
    return mesh.moved(shift)


def _quads(lower, upper):
    here = np.arange(COLUMNS)
    ahead = np.roll(here, -1)
    lower, upper = np.asarray(lower)[:, None], np.asarray(upper)[:, None]
    corners = [lower + here, lower + ahead, upper + ahead, upper + here]
    return np.stack(corners, -1).reshape(-1, 4)


def _face(base, truth, turn, z, side):
    lift = truth.lift(turn * TURN, z - cut_at(truth), side)
    places, out = base.at(turn % 1.0)
    shift = (CORE / 2 + lift) * (-1 if side else 1)
    return np.column_stack([places + shift[:, None] * out, z])


def _normals(base, truth, turn, z, side, step=5e-3):
    around = step / TURN
    along = _face(base, truth, turn + around, z, side) - _face(base, truth, turn - around, z, side)
    up = _face(base, truth, turn, z + step, side) - _face(base, truth, turn, z - step, side)
    cross = np.cross(along, up) * (-1 if side else 1)
    return cross / np.linalg.norm(cross, axis=1)[:, None]


# What is known of it: read from the scan, from a smoothed scan, or without a scan


def scan_it(piece: Piece) -> tuple[Scan, Truth]:
    """The scan of the sample, and the truth."""
    vertices, faces, truth = scan(piece)
    return scan_of("sample.ply", vertices, faces, "mm"), truth


def smoothed(scan: Scan, how: str) -> Scan:
    """The cleaned scan after one of SMOOTHINGS, by MeshLab."""
    import pymeshlab

    scan = clean(scan)
    work = pymeshlab.MeshSet()
    work.add_mesh(pymeshlab.Mesh(scan.points * 1e3, scan.faces))
    step, settings = SMOOTHINGS[how]
    getattr(work, step)(**settings)
    return replace(scan, points=work.current_mesh().vertex_matrix() * 1e-3)


def style_of(scan: Scan, repair: bool = True) -> Style:
    """The relief that the scan shows; a smoothed one is clean already."""
    return read(scan, ScanReading(repair=repair), seed=1).style


def true_style(rough: Style, count: int = 1024) -> Style:
    """The written bead, with the roughness of another style: what a perfect fold would give."""
    phase = np.arange(count) / count
    bead, depth = normalised(profile(print_of(0, 1), phase) * 1e-3)
    return replace(
        rough, name="True", profile=bead, inner=bead, height=LAYER * 1e-3, depth=float(depth)
    )


def profile_error(style: Style) -> float:
    """RMS in mm by which the outer profile is off, whatever its mean; the bead is symmetric."""
    count = len(style.profile.offsets)
    found = style.profile.offsets * style.depth * 1e3
    away = found - profile(print_of(0, 1), np.arange(count) / count)
    return float(np.std(away))


def rebuilt_wall(base: Base, style: Style | None, faces: int = 800_000) -> Mesh:
    """The wall as Heliform makes it from its base curve and a style; smooth where there is none.

    The designer knows the curve and the thickness over the crests, the layers are the scan's.
    """
    plan = Plan(radius=base.radius * 1e-3, period_1=max(1, base.waves), amplitude_1=base.height)
    bead = Bead(height=LAYER * 1e-3, sag=SAG * 1e-3)
    wall = Wall(
        plan=plan,
        height=LAYERS * LAYER * 1e-3,
        thickness=(CORE + 2 * SAG) * 1e-3,
        faces=faces,
        bead=bead,
    )
    mesh, skin = wall_skin(wall)
    if style is not None:
        relief = Relief(
            style="scan", height=style.height, amplitude=style.depth, roughness=style.roughness
        )
        mesh = relieved(mesh, skin, relief, style)
    return _lifted(mesh)


# Light


def caustic(mesh: Mesh, landed: int, seed: int) -> np.ndarray:
    """Caustic flux in lm on TEXELS², under the lamp of the demo."""
    receiver = scenes.floor(PLANE, TEXELS)
    world = Scene(
        (Body("Wall", mesh, Material(ior=1.5)),),
        (Luminaire("Lamp", Lamp(), scenes.at(z=LAMP)),),
        (receiver,),
    )
    tracing = PhotonTracing(until="landed", landed=landed, kernel="none")
    found = trace(world, tracing, seed=seed).maps[0]
    return found.caustic.astype(np.float64) * receiver.texel_area


def distance(one: np.ndarray, other: np.ndarray, side: int) -> float:
    """RMS difference of the flux in blocks of ``side`` texels over the RMS of the other's."""
    one, other = _blocks(one, side), _blocks(other, side)
    return float(np.sqrt(np.mean((one - other) ** 2) / np.mean(other**2)))


def _blocks(flux, side):
    count = len(flux) // side
    return flux.reshape(count, side, count, side).sum(axis=(1, 3))


class Comparison:
    """The caustic of a true wall, by two seeds, and how far others are from it."""

    def __init__(self, mesh: Mesh, landed: int) -> None:
        self.landed = landed
        self.runs = [caustic(mesh, landed, seed) for seed in (11, 12)]

    def chance(self, side: int) -> float:
        """The distance of two runs of the truth itself."""
        return distance(*self.runs, side)

    def flux(self, found: np.ndarray) -> float:
        """Share of the true caustic flux."""
        return float(2 * found.sum() / sum(run.sum() for run in self.runs))

    def away(self, found: np.ndarray, side: int) -> float:
        """The distance from the truth, chance included."""
        return float(np.sqrt(np.mean([distance(found, run, side) ** 2 for run in self.runs])))

    def beyond(self, found: np.ndarray, side: int) -> float:
        """The distance from the truth less what chance makes of it."""
        return float(np.sqrt(max(self.away(found, side) ** 2 - self.chance(side) ** 2, 0.0)))
