# SPDX-License-Identifier: GPL-3.0-or-later
"""One line of the atlas."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Case:
    """The test of one equation or scene, and its result.

    `worst` is the largest error found, in `unit`, at `where`; `bound` what it may be. Where the reference gives digits away on
    purpose, `excuse` says why, and `judged` is the error that is then held against the bound. `printed` and `cycles` are the same
    error for the float32 forms, in float32's own ulps, None where there is no such form; inf means that something was not a number.
    """

    family: str
    name: str
    worst: float
    bound: float
    unit: str
    where: str
    printed: float | None = None
    cycles: float | None = None
    judged: float | None = None
    excuse: str = ""
    points: int = 0

    @property
    def passed(self) -> bool:
        """Whether the reference keeps its bound; an error that is not a number never does."""
        held = self.worst if self.judged is None else self.judged
        return math.isfinite(self.worst) and held <= self.bound
