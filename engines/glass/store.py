"""The store of a library in the making: rows as they come, to go on from after a stop."""

import contextlib
import os
import sys
import time
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..core.errors import FileError
from ..core.files import BROKEN, written
from .judging import Rows

_PERIOD = 5.0  # seconds between two writings
_KEPT = 7 * 86400.0  # seconds that the cache folder keeps a store after its last writing


def store_path(asked: str, name: str) -> Path:
    """The file ``asked`` for, or one of that ``name`` in the user's cache folder."""
    if asked:
        return Path(asked)
    home = Path.home()
    caches = {"win32": home / "AppData" / "Local", "darwin": home / "Library" / "Caches"}
    usual = os.environ.get("LOCALAPPDATA" if sys.platform == "win32" else "XDG_CACHE_HOME")
    folder = Path(usual) if usual else caches.get(sys.platform, home / ".cache")
    return folder / "heliform" / f"{name}.npz"


def clear_old(folder: Path) -> None:
    """Remove the stores in the cache ``folder`` that were not written to for a week."""
    oldest = time.time() - _KEPT
    for path in folder.glob("library-*.npz"):
        with contextlib.suppress(OSError):
            if path.stat().st_mtime < oldest:
                path.unlink()


class Store:
    """Rows of a library by their index, and which of them are done, kept in the file ``path``.

    ``inputs`` names what the rows are made from. Raises FileError where the file cannot be written,
    or is there and no store of the same inputs: nothing is overwritten.
    """

    def __init__(self, path: Path, inputs: str, count: int, kind: np.dtype[np.void]) -> None:
        self._path, self._inputs = path, inputs
        self.rows: Rows = np.zeros(count, kind)
        self.done: NDArray[np.bool_] = np.zeros(count, np.bool_)
        self._written = time.monotonic()
        if path.exists():
            self._resume()
        else:
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
            except OSError as failed:
                raise FileError(
                    f"The folder “{path.parent}” cannot be made: {failed.strerror}; choose another "
                    "store_file."
                ) from None

    @property
    def left(self) -> NDArray[np.intp]:
        """The indices that are not done."""
        return np.flatnonzero(~self.done)

    def put(self, indices: NDArray[np.intp], rows: Rows) -> None:
        """Take in rows; every few seconds the file is brought up to date."""
        self.rows[indices] = rows
        self.done[indices] = True
        if time.monotonic() - self._written > _PERIOD:
            self.keep()

    def keep(self) -> None:
        """Bring the file up to date, whole or not at all."""
        with written(self._path) as draft, draft.open("wb") as stream:
            np.savez(
                stream,
                allow_pickle=False,
                inputs=np.array(self._inputs),
                rows=self.rows,
                done=self.done,
            )
        self._written = time.monotonic()

    def _resume(self) -> None:
        try:
            with np.load(self._path, allow_pickle=False) as kept:
                same = str(kept["inputs"]) == self._inputs
                rows, done = kept["rows"], kept["done"]
        except BROKEN as wrong:
            raise FileError(
                f"“{self._path}” is not a store of a print library ({wrong}); remove it, or choose "
                "another store_file."
            ) from None
        if not (same and rows.dtype == self.rows.dtype and rows.shape == self.rows.shape):
            raise FileError(
                f"“{self._path}” holds the rows of another print library; remove it, or choose "
                "another store_file."
            )
        self.rows, self.done = rows, done
