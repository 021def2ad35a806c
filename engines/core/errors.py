"""What goes wrong, in one sentence: what, where, and the remedy.

Every error a user can cause is a `HeliformError`; its text is shown as it stands, in the panel,
in the terminal and in the report. Anything else that escapes is a bug and keeps its traceback.
"""


class HeliformError(Exception):
    """A user's mistake or a missing piece, told in one sentence."""


class ParameterError(HeliformError):
    """A key is unknown, a value is of the wrong type or out of bounds."""


class FileError(HeliformError):
    """A file is missing, damaged, or cannot be written."""


class SceneError(HeliformError):
    """The scene lacks something, or a mesh cannot be what it is said to be."""


class RuntimeMissing(HeliformError):
    """A library that the analysis needs is not there or must not be loaded."""


class WorkerDied(HeliformError):
    """The worker process ended before its job did."""


class Cancelled(Exception):
    """The user asked to stop. Not an error: nothing is reported but that it stopped."""
