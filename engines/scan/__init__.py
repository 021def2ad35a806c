"""Scans: from a scanned sample of a print to the relief that its layers leave on any wall."""

from ..core.analysis import Analysis
from .drawing import draw
from .load import Scan, load_scan
from .reading import ScanReading, read, read_scan
from .result import Reading

READ_SCAN = Analysis("scan.read", ScanReading, read_scan, Reading, draw)
ANALYSES = (READ_SCAN,)
FORMS = ()

__all__ = [
    "ANALYSES",
    "FORMS",
    "READ_SCAN",
    "Reading",
    "Scan",
    "ScanReading",
    "load_scan",
    "read",
    "read_scan",
]
