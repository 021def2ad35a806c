"""How an engine says where it is, and learns that it should stop."""

from collections.abc import Callable

Progress = Callable[[float, str], None]
"""``progress(fraction, text)``: fraction in 0..1, text for a person.

Engines call it between steps and batches. It raises `Cancelled` when the user asked to stop; an
engine lets that pass through.
"""


def SILENT(fraction: float, text: str) -> None:
    """Report to nobody, never cancel."""


def part(progress: Progress, start: float, stop: float, prefix: str = "") -> Progress:
    """A progress for one step of several: its 0..1 becomes ``start``..``stop`` of the whole."""

    def report(fraction: float, text: str) -> None:
        progress(start + (stop - start) * min(max(fraction, 0.0), 1.0), prefix + text)

    return report
