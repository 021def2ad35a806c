"""From a scan to a printed wall: the sample's relief on a wall, its path and its gate, in one."""

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .. import VERSION
from ..core.colour import Display
from ..core.errors import FileError
from ..core.files import written
from ..core.parameters import from_table, nested, to_table
from ..core.progress import SILENT, Progress, part
from ..core.scene import Scene
from ..glass import unrolled
from ..glass.printed import wall_skin
from ..glass.printing import Print, Printed, print_wall
from ..glass.relief import Relief, check_relief, relieved
from . import drawing
from .reading import ScanReading, read_scan
from .result import Reading

RELIEF = "relief.json"


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanToWall:
    """The layers of a scanned sample, put on a wall and printed."""

    reading: ScanReading = nested(ScanReading, "How the scan is read")  # noqa: RUF009
    print: Print = nested(Print, "The wall and how it is laid down")  # noqa: RUF009
    relief: Relief = nested(Relief, "How the layers lie on the wall")  # noqa: RUF009


@dataclass(frozen=True, slots=True)
class ScannedWall:
    """What was read of the sample, and the wall that has its ``relief``; ``meta`` of both."""

    reading: Reading
    printed: Printed
    relief: Relief
    meta: dict[str, Any]

    def figures(self) -> dict[str, dict[str, Any]]:
        """The numbers of the scan, then those of the print."""
        return self.reading.figures() | self.printed.figures()

    def save(self, folder: Path) -> list[str]:
        """Write the files of both; the solid is the wall with the sample's relief."""
        files = [*self.reading.save(folder), *self.printed.save(folder), RELIEF]
        with written(folder / RELIEF) as draft:
            draft.write_text(json.dumps(to_table(self.relief), indent=2), encoding="utf-8")
        return files

    @classmethod
    def load(cls, folder: Path) -> "ScannedWall":
        """What `save` wrote. Raises FileError where it is missing or damaged."""
        reading, printed = Reading.load(folder), Printed.load(folder)
        try:
            table = json.loads((folder / RELIEF).read_text(encoding="utf-8"))
        except (OSError, ValueError) as failed:
            raise FileError(
                f"“{folder / RELIEF}” cannot be read: {failed}; run it again."
            ) from None
        notes = [*reading.meta["notes"], *printed.meta["notes"]]
        relief = from_table(Relief, table, RELIEF)
        return cls(reading, printed, relief, printed.meta | {"notes": notes})


def scan_to_wall(
    scene: Scene, record: ScanToWall, *, seed: int = 0, progress: Progress = SILENT
) -> ScannedWall:
    """Read the sample, put its relief on the wall as it was found, and print that.

    Layer height, depth and roughness are the sample's, for relief and path alike; the record's
    ``relief`` says the rest. Raises as `read_scan`, `print_wall` and `check_relief` do.
    """
    reading = read_scan(scene, record.reading, seed=seed, progress=part(progress, 0.0, 0.7))
    style = reading.style
    wall = record.print.wall
    wall = replace(wall, bead=replace(wall.bead, height=style.height, style="flat"))
    relief = replace(
        record.relief,
        style="scan",
        height=style.height,
        amplitude=style.depth,
        roughness=style.roughness,
    )
    check_relief(relief, wall.thickness)
    given = replace(record.print, wall=wall)
    printed = print_wall(scene, given, seed=seed, progress=part(progress, 0.7, 0.9))
    progress(0.9, "Putting the relief on")
    smooth, skin = wall_skin(wall)
    printed = replace(printed, mesh=relieved(smooth, skin, relief, style))
    meta = printed.meta | {
        "parameters": to_table(record),
        "version": VERSION,
        "notes": [*reading.meta["notes"], *printed.meta["notes"]],
    }
    progress(1.0, "Done")
    return ScannedWall(reading, printed, relief, meta)


def draw(result: ScannedWall, folder: Path, display: Display) -> list[str]:
    """Write the pictures of the reading and of the gate; returns their names."""
    return [
        *drawing.draw(result.reading, folder, display),
        *unrolled.draw(result.printed, folder, display),
    ]
