"""A wall with the relief of a scan, as a study gives it."""

from pathlib import Path

import bpy

from ..engines.core.analysis import Analysis
from ..engines.core.errors import SceneError
from ..engines.core.parameters import from_table
from ..engines.glass.printing import Print
from ..engines.scan.to_wall import ScannedWall
from . import printing
from .bridge import scan
from .staging import Gathered, Objects, Staging


def _gather(context: bpy.types.Context, analysis: Analysis) -> Gathered:
    raise SceneError("In Blender, read the scan and put it on a wall; the study does both at once.")


def _stage(
    scene: bpy.types.Scene,
    there: Objects,
    result: ScannedWall,
    folder: Path,
    /,
    notes: tuple[str, ...] = (),
) -> bool:
    """What was read of the sample, and the wall that has its relief."""
    scan.STAGING.stage(scene, there, result.reading, folder)
    record = from_table(Print, result.printed.meta["parameters"], "parameters")
    printing.add_printed(scene, record, result.relief, result.reading.style)
    return False


SCANNED_WALL = Staging(_gather, _stage)
