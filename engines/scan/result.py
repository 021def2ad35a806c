"""What a scan was read as: the relief to put on walls, and how far it can be trusted."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..core import exr
from ..core.errors import FileError
from ..core.files import written
from ..core.meshes import load_mesh, save_mesh
from ..core.scene import Mesh, Vector
from ..core.table import load_csv, save_csv
from ..glass.profile import Style

Map = NDArray[np.float32]
RELIEF, REPORT, PROFILE = "relief.npz", "scan.json", "profile.csv"
ROUGHNESS, HEIGHTS, PATCH, POINTS = "roughness.csv", "heights.exr", "patch", "fold.exr"
MAPS = ("height", "roughness", "smooth")
FOLDED = ("phase", "median", "error", "profile")
OCTAVE = ("shortest", "longest", "signal", "noise")


@dataclass(frozen=True, slots=True)
class FaceReading:
    """What one face shows; the outer comes first where both were seen.

    ``folded`` has, by the names in FOLDED, the phase in layers, the medians of the raw points and
    their standard error, and the bead through them, (B,) float64 in m. ``octaves`` has, by those in
    OCTAVE, wavelengths and the RMS of surface and noise between them, (K,) in m. The maps
    ``height`` (over base and trend), ``roughness`` (over the bead too) and ``smooth`` (that
    without its noise) are (rows, columns) float32 in m, row 0 at the lowest z, NaN where nothing
    was seen; a cell is ``edge`` m wide. ``density`` (heights, phases) counts the folded points
    between ``lowest`` and ``highest`` m. ``patch`` is the face rebuilt, in the scan's own axes.
    """

    name: str
    folded: dict[str, Vector]
    octaves: dict[str, Vector]
    height: Map
    roughness: Map
    smooth: Map
    edge: float
    density: Map
    lowest: float
    highest: float
    patch: Mesh


@dataclass(frozen=True, slots=True)
class Reading:
    """A scan, read: ``style`` is its relief, ``faces`` what each face shows.

    ``meta`` says the figures (name → value, unit and, where known, uncertainty), parameters, seed,
    version, seconds and notes.
    """

    style: Style
    faces: tuple[FaceReading, ...]
    meta: dict[str, Any]

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the quality report: name → value, unit and, where known, uncertainty."""
        return self.meta["figures"]

    def save(self, folder: Path) -> list[str]:
        """Write the relief, the report, tables, maps and patches; returns the files' names.

        Raises FileError where they cannot be written.
        """
        files = [RELIEF, REPORT]
        self.style.save(folder / RELIEF)
        ranges = [
            {"name": f.name, "edge": f.edge, "lowest": f.lowest, "highest": f.highest}
            for f in self.faces
        ]
        with written(folder / REPORT) as draft:
            text = json.dumps(self.meta | {"faces": ranges}, indent=2, ensure_ascii=False)
            draft.write_text(text + "\n", encoding="utf-8")
        for face in self.faces:
            files += _save_face(face, folder)
        return files

    @classmethod
    def load(cls, folder: Path) -> "Reading":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        try:
            meta = json.loads((folder / REPORT).read_text(encoding="utf-8"))
            ranges = meta.pop("faces")
        except (OSError, ValueError, KeyError) as failed:
            raise FileError(f"“{folder}” holds no reading of a scan; read the scan again.") from (
                failed
            )
        style = Style.load(folder / RELIEF)
        return cls(style, tuple(_load_face(folder, one) for one in ranges), meta)


def named(face: str, file: str) -> str:
    """The name of a face's file; that of the outer face goes without."""
    return file if face == "outer" else f"{face} {file}"


def _save_face(face: FaceReading, folder: Path) -> list[str]:
    files = [named(face.name, f) for f in (PROFILE, ROUGHNESS, HEIGHTS, POINTS, f"{PATCH}.npz")]
    profile, octaves, maps, density, patch = (folder / file for file in files)
    titles = ("Phase (layers)", "Median (m)", "Error (m)", "Profile (m)")
    columns = {t: face.folded[n] for t, n in zip(titles, FOLDED, strict=True)}
    save_csv(profile, columns, {"title": f"One layer of the {face.name} face"})
    titles = ("Shortest wave (m)", "Longest wave (m)", "Roughness RMS (m)", "Noise RMS (m)")
    columns = {t: face.octaves[n] for t, n in zip(titles, OCTAVE, strict=True)}
    save_csv(octaves, columns, {"title": f"Roughness of the {face.name} face by octaves"})
    exr.save(maps, {name: getattr(face, name) for name in MAPS}, {"unit": "m", "cell": face.edge})
    exr.save(density, {"points": face.density}, {"lowest": face.lowest, "highest": face.highest})
    save_mesh(patch, face.patch)
    return files


def _load_face(folder: Path, held: dict[str, Any]) -> FaceReading:
    name = held["name"]
    folded, _ = load_csv(folder / named(name, PROFILE))
    octaves, _ = load_csv(folder / named(name, ROUGHNESS))
    maps, _ = exr.load(folder / named(name, HEIGHTS))
    density, _ = exr.load(folder / named(name, POINTS))
    return FaceReading(
        name=name,
        folded=dict(zip(FOLDED, folded.values(), strict=True)),
        octaves=dict(zip(OCTAVE, octaves.values(), strict=True)),
        **{key: maps[key] for key in MAPS},
        edge=held["edge"],
        density=density["points"],
        lowest=held["lowest"],
        highest=held["highest"],
        patch=load_mesh(folder / named(name, f"{PATCH}.npz")),
    )
