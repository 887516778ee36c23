# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders against the clock.

Comparisons, cost measurements and audits have this in common.
"""

from __future__ import annotations

import time
from enum import Enum

from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import Progress
from .sides import Replicates


class Stop(Enum):
    """Why a run ended; the values stand in the JSON files."""

    DECIDED = "decided"
    TIME = "time"
    REPLICATES = "replicates"
    SAMPLES = "samples"
    NOTHING = "nothing to measure"
    LOST = "lost pixels"
    CANCELLED = "cancelled"


class TimedRun:
    """A run that began when it was made, with `budget` seconds to spend (None: no limit)."""

    def __init__(self, budget: float | None, progress: Progress) -> None:
        self.budget = budget
        self.progress = progress
        self._begin = time.monotonic()

    @property
    def elapsed(self) -> float:
        """Seconds since the run began."""
        return time.monotonic() - self._begin

    @property
    def left(self) -> float:
        """Seconds until the budget is spent, negative after that."""
        return float("inf") if self.budget is None else self.budget - self.elapsed

    @property
    def share_spent(self) -> float:
        """The share of the budget that is spent, at most 1; 0 without a budget."""
        return min(self.elapsed / self.budget, 1.0) if self.budget else 0.0

    def share(self, part: float) -> float:
        """Seconds of that `part` of the budget, infinite without one."""
        return float("inf") if self.budget is None else part * self.budget

    def render(
        self, renderer: Replicates, replicate: int, samples: int, windows: Windows | None = None
    ) -> tuple[Rendering, float]:
        """Render one replicate; return it and the seconds of the whole call.

        Where it was begun before the call, those that it took. Raises Cancelled when the run is to end.
        """
        start = time.monotonic()
        rendering = renderer.render(replicate, samples, Progress(self.report, self.is_ending), windows)
        self.progress.check()
        return rendering, max(time.monotonic() - start, rendering.seconds)

    def is_ending(self) -> bool:
        """Whether the call under way is to end."""
        return self.progress.is_cancelled

    def report(self, fraction: float) -> None:
        """Tell how far the run is while a renderer has done `fraction` of its image."""
        self.progress.report(self.share_spent)
