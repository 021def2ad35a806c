"""Scans: from a scanned sample of a print to the relief that its layers leave on any wall."""

from ..core.analysis import Analysis
from . import printed_drawing, to_wall
from .as_printed import Comparison, compare
from .drawing import draw
from .load import Scan, load_scan
from .printed_result import AsPrinted
from .reading import ScanReading, read, read_scan
from .result import Reading

READ_SCAN = Analysis("scan.read", ScanReading, read_scan, Reading, draw)
SCAN_TO_WALL = Analysis(
    "scan.to_wall", to_wall.ScanToWall, to_wall.scan_to_wall, to_wall.ScannedWall, to_wall.draw
)
COMPARE_PRINT = Analysis("scan.compare", Comparison, compare, AsPrinted, printed_drawing.draw)
ANALYSES = (READ_SCAN, SCAN_TO_WALL, COMPARE_PRINT)
FORMS = ()

__all__ = [
    "ANALYSES",
    "COMPARE_PRINT",
    "FORMS",
    "READ_SCAN",
    "SCAN_TO_WALL",
    "AsPrinted",
    "Comparison",
    "Reading",
    "Scan",
    "ScanReading",
    "load_scan",
    "read",
    "read_scan",
]
