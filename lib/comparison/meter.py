# SPDX-License-Identifier: GPL-3.0-or-later
"""Time, limits and progress of one comparison."""

from __future__ import annotations

import math

from ..film.rendering import Rendering
from ..film.windows import Windows
from ..progress import Progress
from ..settings.comparison import CompareOptions
from .run import Stop, TimedRun
from .sides import Replicates

# A call that goes on beyond this many times the budget is cut short, and its image is not kept; the first FEWEST images are finished.
PATIENCE, FEWEST = 1.05, 2
# The part of the time that effects of departures may take in all once regions differ.
ASIDE_AT_MOST = 0.25


class Meter(TimedRun):
    """What a comparison has spent and what it may spend.

    A share `aside` of the time is kept for finding causes.
    """

    def __init__(self, options: CompareOptions, progress: Progress, aside: float) -> None:
        super().__init__(options.time, progress)
        self.seconds_aside = None if options.time is None else aside * options.time
        self.spent_aside = 0.0
        self.keeps_aside = True
        """Whether what is set aside is kept from sampling."""
        self._options = options
        self._rendered = 0
        self._is_counted = False
        self._mark = 0.0, 0

    @property
    def is_overdrawn(self) -> bool:
        """Whether more time was spent on causes than was set aside.

        From then on, when sampling ends depends on what was seen.
        """
        return self.seconds_aside is not None and self.spent_aside > self.seconds_aside

    def has_time_aside(self, last: bool) -> bool:
        """Whether effects of departures may go on.

        They may in the time set aside, and beyond it unless this look is the `last` or the time is over.
        """
        if self.seconds_aside is None or self._options.time is None:
            return True
        is_over = last or self.elapsed >= self._options.time
        return self.spent_aside < (self.seconds_aside if is_over else ASIDE_AT_MOST * self._options.time)

    def mark(self, replicates: int) -> None:
        """Note that the cost of a replicate changes from here on.

        There are `replicates` on both sides.
        """
        self._mark = self.elapsed - self.spent_aside, replicates

    @property
    def since_mark(self) -> float:
        """The seconds of sampling since the last mark."""
        return self.elapsed - self.spent_aside - self._mark[0]

    @property
    def sampling_left(self) -> float:
        """The seconds that sampling may still take; infinite without a limit.

        What is set aside counts as spent from the start as long as it is kept: how much of it is used depends on what was rendered. What
        is spent beyond it does shorten the sampling, and `is_overdrawn` says so.
        """
        if self._options.time is None:
            return math.inf
        kept = self.seconds_aside or 0.0 if self.keeps_aside else 0.0
        sampling = self.elapsed - self.spent_aside
        return self._options.time - max(kept, self.spent_aside) - sampling

    def render_counted(
        self, renderer: Replicates, replicate: int, samples: int, windows: Windows | None
    ) -> tuple[Rendering, float]:
        """Render one replicate that counts towards the limits; return it and its seconds.

        Raises Cancelled also where it outruns the time.
        """
        self._is_counted = True
        try:
            found = self.render(renderer, replicate, samples, windows)
        finally:
            self._is_counted = False
        self._rendered += 1
        return found

    def is_ending(self) -> bool:
        """Whether the call under way is to end.

        It ends where the user wants it, or where it counts and outruns the time.
        """
        return super().is_ending() or (self._is_counted and self.is_over)

    @property
    def is_over(self) -> bool:
        """Whether the time is overdrawn so far that a call is cut short."""
        late = self._options.time is not None and self.elapsed > PATIENCE * self._options.time
        return late and self._rendered >= 2 * FEWEST

    def render_aside(self, renderer: Replicates, replicate: int, samples: int) -> Rendering:
        """One replicate on the time set aside."""
        before = self.elapsed
        rendering, _ = self.render(renderer, replicate, samples)
        self.spent_aside += self.elapsed - before
        return rendering

    def why_stop(self, replicates: int, goal: int, most: int | None) -> Stop | None:
        """Why sampling ends with `replicates` on both sides, or None if it goes on.

        There may be at `most` so many. Of whole images this never depends on what was rendered. Time ends it when
        less is left than `goal` replicates will take, the number at which there is something to gain.
        """
        if self.progress.is_cancelled:
            return Stop.CANCELLED
        if most is not None and replicates >= most:
            return Stop.REPLICATES
        if self.is_over:
            return Stop.TIME
        if replicates < 2:
            return None
        a_replicate = self.since_mark / max(replicates - self._mark[1], 1)
        return Stop.TIME if a_replicate * (goal - replicates) > self.sampling_left else None

    def report(self, fraction: float) -> None:
        """Tell the share of the time, or of the replicates, that is spent."""
        done = (self._rendered + fraction) / (2 * self._options.replicates) if self._options.replicates else 0.0
        self.progress.report(min(max(self.share_spent, done), 1.0))
