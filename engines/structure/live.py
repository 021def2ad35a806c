"""Sizing over and over while a record changes: what stays is kept from one time to the next."""

from dataclasses import dataclass, field, replace

import numpy as np

from ..core.progress import SILENT, Progress
from ..core.scene import Scene
from .assembly import Pattern, pattern_of
from .frame import Frame
from .sized import Sized
from .structure import Structure, design_model, model_of


@dataclass(slots=True)
class Live:
    """The last structure that was sized, from which the next begins.

    From a start, a section is held as soon as it turns: that takes a few rounds rather than dozens.
    What comes out may depend on the path that led to it, by some per cent of mass; a result that
    is kept should be sized cold, by `size_structure`.
    """

    last: Sized | None = None
    _pattern: Pattern | None = field(default=None, repr=False)

    def size(self, record: Structure, scene: Scene, *, progress: Progress = SILENT) -> Sized:
        """The structure sized from the last one's sections where the members are the same.

        Raises as `size_structure`; the last one then stays.
        """
        model = model_of(record, scene)
        if self._pattern is None or not self._fits(model.frame):
            self._pattern, self.last = pattern_of(model.frame), None
        if self.last is not None:
            record = replace(record, rules=replace(record.rules, turns=1))
        self.last = design_model(
            model, record, start=self.last, pattern=self._pattern, progress=progress
        )
        return self.last

    def _fits(self, frame: Frame) -> bool:
        """Whether the pattern is that of this frame too."""
        if self.last is None:
            return False
        before = self.last.model.frame
        return np.array_equal(before.members, frame.members) and np.array_equal(
            before.held, frame.held
        )
