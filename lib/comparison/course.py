# SPDX-License-Identifier: GPL-3.0-or-later
"""The course of a run: which part of the image is rendered, and how much of it at once."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ..film.regions import Regions
from ..film.windows import Windows
from ..settings.comparison import CompareOptions
from ..verdict.boundaries import next_look
from ..verdict.sequential import SequentialTest
from .attainable import Attainable, find_standing
from .focus import Part, choose_regions, part_of, weigh_round
from .meter import Meter
from .pace import Pace
from .run import Stop
from .sides import Side

# What is laid down does not depend on time.
NO_PACE = Pace()


class Course:
    """The part that is rendered now, of the `regions` of both `sides`.

    `fixed` is the share of a round's time that does not depend on pixels. `drawn` counts the replicates rendered, by weight, and `work`
    those by weight and share of the image. It `is_split` once a part was rendered: when that is done depends on what was seen.
    """

    def __init__(
        self,
        regions: Regions,
        sides: tuple[Side, Side],
        test: SequentialTest,
        meter: Meter,
        options: CompareOptions,
        fixed: float,
    ) -> None:
        self.part = Part(None, None, 0, next_look(0))
        self.drawn, self.work, self.is_split = 0, 0.0, False
        self._regions, self._sides, self._test = regions, sides, test
        self._meter, self._options = meter, options
        self._pace, self._rounds = Pace(fixed), 0
        self._attainable = Attainable(regions)
        # Regions (K,) that cannot be sampled on: they have lost pixels that were rendered more often, or less, than they.
        self._lost = np.zeros(len(regions), bool)
        # Where the number of replicates is laid down, what is still open of the regions that never ceased to be.
        self._kept: np.ndarray | None = None
        self._excluded = np.zeros(regions.shape, bool)
        meter.mark(0)

    @property
    def windows(self) -> Windows | None:
        """Where is rendered; None for the whole image."""
        return self.part.windows

    @property
    def replicates(self) -> int:
        """How many replicates the regions of the part have on both sides."""
        counts = self._sides[1].regions.moments.n
        return int(np.max(np.broadcast_to(counts, self._lost.shape)[self._of], initial=0))

    @property
    def is_at_look(self) -> bool:
        """Whether its regions are to be looked at now, or none is left."""
        return self.replicates == self.part.target or (self.part.of is not None and not self.part.of.any())

    @property
    def is_planned(self) -> bool:
        """Whether time decides where sampling goes on, not a number of replicates that was laid down."""
        return self._options.replicates is None

    @property
    def _of(self) -> np.ndarray | slice:
        return slice(None) if self.part.of is None else self.part.of

    def weigh(self) -> int:
        """How many replicates of both sides the next round renders at once."""
        if self.part.windows is None or self._options.samples is not None:
            return 1
        most = self._options.replicates
        return weigh_round(self.part.windows, self.replicates, self._samples, self.part.target, most)

    def count(self, weight: int) -> None:
        """Take note of a round of that weight."""
        self.drawn += weight
        self.work += weight * self.part.share
        self._rounds += 1

    def exclude(self, pixels: np.ndarray) -> None:
        """Leave `pixels` (height, width) out of all regions of the part.

        Other regions that show them keep them, in the replicates they have, and are sampled no more. So do regions of which not
        all pixels were rendered equally often: what a pixel has added to them is not known.
        """
        new = pixels & ~self._excluded
        if new.any():
            self._excluded = self._excluded | new
            touched = np.diff(self._regions.weights[:, np.flatnonzero(new)].indptr) > 0
            apart = np.zeros_like(touched) if self.part.of is None else ~self.part.of
            for side in self._sides:
                apart |= side.rendered_apart(new)
            if (touched & apart).any():
                self._lost = self._lost | (touched & apart)
                self.part = replace(self.part, of=~self._lost if self.part.of is None else self.part.of & ~self._lost)
        for side in self._sides:
            side.exclude(pixels, self.part.of)

    def go_on(self, open_: np.ndarray) -> Stop | None:
        """Choose what to render until the next look, of the regions (K,) that are `open_`; or say why nothing is."""
        if not open_.any():
            return Stop.DECIDED
        if not (open_ & ~self._lost).any():
            return Stop.LOST
        self._learn()
        replicates = self.replicates
        was_whole = self.part.windows is None
        part = self._planned(open_ & ~self._lost) if self.is_planned else self._laid_down(open_ & ~self._lost)
        if part is None and self.is_split:
            return Stop.TIME
        self.part = part or Part(None, None, replicates, next_look(replicates))
        self.is_split |= not self.part.is_all
        if was_whole and self.part.windows is not None:
            self._meter.progress.begin("rendering what is open")
        self._meter.mark(self.part.replicates)
        return None

    def seconds_to_double(self, open_: np.ndarray) -> float:
        """What it takes to double the replicates of the regions (K,) that are `open_`, or of all where none is."""
        self._learn()
        counts = np.broadcast_to(self._sides[1].regions.moments.n, self._lost.shape)
        return self._pace.whole * self._attainable.work(np.where(open_, counts, 0) if open_.any() else counts)

    @property
    def _samples(self) -> int:
        return max(side.film.samples for side in self._sides)

    def _learn(self) -> None:
        """Take note of how long the part took so far."""
        done = self.replicates - self.part.replicates
        self._pace.learn(self._meter.since_mark, self.part.share, done, self._rounds)
        self._rounds = 0

    def _laid_down(self, open_: np.ndarray) -> Part:
        """What is open of all that was sampled so far."""
        self._kept = open_ if self._kept is None else self._kept & open_
        if self._kept.any():
            return self._part_of(self._kept, NO_PACE)  # the same part, however long calls take
        return replace(self.part, replicates=self.replicates, target=next_look(self.replicates))

    def _planned(self, open_: np.ndarray) -> Part | None:
        """What the time that is left is best spent on; None where it is too short for anything."""
        left = self._meter.sampling_left
        now = find_standing(self._test, *(side.regions.moments for side in self._sides))
        chosen = choose_regions(self._test, self._attainable, now, open_, self._pace, left, self.is_split)
        while chosen.any():
            part = self._part_of(chosen, self._pace)
            if part.windows is None and not self.is_split:
                return part
            replicates, weight = part.target - part.replicates, 1
            if part.windows is not None:
                weight = weigh_round(part.windows, part.replicates, self._samples, part.target)
            if self._pace.seconds(part.share * replicates, math.ceil(replicates / weight)) <= left:
                return part
            chosen = chosen & (now.bounds > np.median(now.bounds[chosen]))
        return None

    def _part_of(self, wanted: np.ndarray, pace: Pace) -> Part:
        counts = np.broadcast_to(self._sides[1].regions.moments.n, self._lost.shape)
        return part_of(self._regions, wanted, counts, self._lost, self._samples, pace)
