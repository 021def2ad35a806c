"""Writing files so that nothing is half-written, under names that every system takes."""

import contextlib
import errno
import hashlib
import re
import secrets
import tokenize
import unicodedata
import zipfile
import zlib
from collections.abc import Iterator
from pathlib import Path

from .errors import FileError

_REMEDIES = {
    errno.ENOENT: "make the folder first, or choose another",
    errno.ENOTDIR: "choose a folder, not a file, to write into",
    errno.EISDIR: "a folder has that name; choose another",
    errno.EACCES: "choose a folder that you may write to, or close the file where it is open",
    errno.EPERM: "choose a folder that you may write to, or close the file where it is open",
    errno.EROFS: "choose a folder that you may write to",
    errno.ENOSPC: "free some space, or choose another folder",
    errno.EDQUOT: "free some space, or choose another folder",
    errno.ENAMETOOLONG: "choose a shorter name",
}

BROKEN = (
    *(OSError, EOFError, ValueError, TypeError, KeyError, AttributeError, RuntimeError),
    *(zipfile.BadZipFile, zlib.error, SyntaxError, tokenize.TokenError),
)
"""What NumPy, zipfile and zlib raise over an archive that is none, or is damaged."""

_LONGEST = 100  # bytes of UTF-8, for Windows allows a whole path only 260 characters
_DIGITS = 6
_FORBIDDEN = re.compile(r'[<>:"/\\|?*]')
_DEVICE = re.compile(
    r"(CON|PRN|AUX|NUL|CONIN\$|CONOUT\$|(COM|LPT)[0-9¹²³])\s*(\..*)?", re.IGNORECASE
)


@contextlib.contextmanager
def written(path: Path | str) -> Iterator[Path]:
    """A temporary path beside ``path``, which takes its place when the block ends well.

    When the block raises, the temporary file goes and what was at ``path`` stays as it was.
    Raises FileError where the system refuses to write there.
    """
    path = Path(path)
    temporary = path.with_name(f".heliform-{secrets.token_hex(6)}{path.suffix[:16]}")
    try:
        temporary.open("xb").close()
        yield temporary
        temporary.replace(path)
    except OSError as error:
        remedy = _REMEDIES.get(error.errno or 0, "free some space, or choose another folder")
        reason = error.strerror or str(error)
        raise FileError(
            f"Cannot write “{path.name}” in the folder “{path.parent}” ({reason}): {remedy}."
        ) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink()


def draft_of(out: Path) -> Path:
    """The folder in which results for ``out`` grow before they are moved there."""
    return out.with_name(f".{out.name}.heliform-draft")


def safe_name(text: str) -> str:
    """``text`` as a file name, without an ending, that Linux, macOS and Windows all take.

    Letters of every script stay. Where something had to be replaced or cut, six hex digits of
    the original's hash follow, so that names that differ stay different: "a/b" and "a:b" become
    a_b-c14cdd and a_b-6783a3. A safe name is its own safe name. Names that differ only in case
    are one file on Windows and macOS; that is not cured here.
    """
    name = "".join(map(_safe, unicodedata.normalize("NFC", text))).strip(" .")
    if _DEVICE.fullmatch(name):
        name = f"_{name}"
    if name == text and 0 < len(name.encode()) <= _LONGEST:
        return name
    name = name.encode()[: _LONGEST - _DIGITS - 1].decode(errors="ignore") or "unnamed"
    return f"{name}-{hashlib.sha256(text.encode(errors='surrogatepass')).hexdigest()[:_DIGITS]}"


def _safe(character: str) -> str:
    unprintable = unicodedata.category(character) in ("Cc", "Cf", "Cs", "Cn", "Co", "Zl", "Zp")
    return "_" if unprintable or _FORBIDDEN.match(character) else character
