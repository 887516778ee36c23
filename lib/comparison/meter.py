# SPDX-License-Identifier: GPL-3.0-or-later
"""Time, limits and progress of one comparison."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

from ..errors import EtalonError
from ..film.rendering import Rendering
from ..film.windows import Windows
from .options import CompareOptions
from .sides import Renderer

# The part of the time that effects of departures may take in all once regions differ.
ASIDE_AT_MOST = 0.25


class Meter:
    """What a comparison has spent, what it may spend, and what the user is told meanwhile."""

    def __init__(
        self, options: CompareOptions, progress: Callable[[float], None], cancelled: Callable[[], bool], aside: float
    ) -> None:
        self._start = time.monotonic()
        self.seconds_aside = None if options.time is None else aside * options.time
        self.spent_aside = 0.0
        self._options = options
        self._progress = progress
        self._cancelled = cancelled
        self._rendered = 0
        self._mark = 0.0, 0
        self.round_seconds = math.nan

    @property
    def is_overdrawn(self) -> bool:
        """Whether more than was set aside is spent aside: from then on, when sampling ends depends on what was seen."""
        return self.seconds_aside is not None and self.spent_aside > self.seconds_aside

    def has_time_aside(self, last: bool) -> bool:
        """Whether effects of departures may go on: in the time set aside, and beyond it unless this look is the `last`."""
        if self.seconds_aside is None:
            return True
        most = self.seconds_aside if last else ASIDE_AT_MOST * self._options.time
        return self.spent_aside < most and (last or self.elapsed < self._options.time)

    @property
    def elapsed(self) -> float:
        """Seconds since the comparison began."""
        return time.monotonic() - self._start

    def mark(self, replicates: int) -> None:
        """From here on, with `replicates` on both sides, a replicate costs something else than before."""
        self._mark = self.elapsed - self.spent_aside, replicates

    def render(
        self, renderer: Renderer, replicate: int, samples: int, windows: Windows | None = None
    ) -> Rendering | None:
        """One replicate that counts towards the limits, or None if it was cancelled."""
        if not self._rendered:
            self.mark(0)
        rendering = self.pilot(renderer, replicate, samples, windows)
        self._rendered += rendering is not None
        return rendering

    def pilot(
        self, renderer: Renderer, replicate: int, samples: int, windows: Windows | None = None
    ) -> Rendering | None:
        """One replicate, or None if it was cancelled."""
        try:
            rendering = renderer.render(replicate, samples, self._report, self._cancelled, windows)
        except EtalonError:
            if self._cancelled():
                return None
            raise
        # What a cancelled renderer hands over may be half an image.
        return None if self._cancelled() else rendering

    def aside(self, renderer: Renderer, replicate: int, samples: int) -> Rendering | None:
        """One replicate on the time set aside, or None if it was cancelled."""
        before = self.elapsed
        rendering = self.pilot(renderer, replicate, samples)
        self.spent_aside += self.elapsed - before
        return rendering

    def why_stop(self, replicates: int, goal: int) -> str:
        """Why sampling ends with `replicates` on both sides, or '' if it goes on.

        Of whole images this never depends on what was rendered. Time ends it when less is left than `goal` replicates will take,
        the number at which there is something to gain.
        """
        if self._cancelled():
            return "cancelled"
        if self._options.replicates is not None and replicates >= self._options.replicates:
            return "replicates"
        # What is set aside counts as spent from the start: how much of it is used depends on what was rendered. What is spent beyond
        # it does shorten the sampling, and `is_overdrawn` says so.
        sampling = self.elapsed - self.spent_aside
        begin, before = self._mark
        self.round_seconds = (sampling - begin) / max(replicates - before, 1)
        if self._options.time is None or replicates < 2:
            return ""
        left = self._options.time - max(self.seconds_aside, self.spent_aside) - sampling
        return "time" if self.round_seconds * (goal - replicates) > left else ""

    def _report(self, fraction: float) -> None:
        spent = self.elapsed / self._options.time if self._options.time else 0.0
        done = (self._rendered + fraction) / (2 * self._options.replicates) if self._options.replicates else 0.0
        self._progress(min(max(spent, done), 1.0))
