# SPDX-License-Identifier: GPL-3.0-or-later
"""Deciding while sampling goes on: the state of a test of N regions.

Three kinds of claims are made, each with a part of the error level (1 - confidence) of its own (`PARTS`):

- *All regions agree.* The union of "region r is outside the tolerance" is rejected when each of them is, every one at the whole level
  of its part: an intersection-union test (Berger, "Multiparameter hypothesis testing and acceptance sampling", 1982), which pays nothing
  for the number of regions. Families of regions (the image, what the user named, cells) are claimed in this order, each only
  after those before it: with a fixed order every one has the whole level (Maurer, Hothorn and Lehmacher, "Multiple comparisons in drug
  clinical trials and preclinical assays: a priori ordered hypotheses", 1995).
- *This region agrees*, where not all do: Holm's procedure ("A simple sequentially rejective multiple test procedure", 1979) over N.
- *This region differs*: Holm's procedure over N.

The tests on means cannot know of light that no sample has met; `rare` says how large a difference that could hide, and every claim
leaves room for it (rare.py). Where light of an unsupported material may be missing from the reference, a claim of agreement leaves
room for that too, and a region is shown to differ only where the candidate is darker than the reference: more light can only make it
brighter. Nothing is frozen: each look judges anew all that was sampled since the last, and a claim that the data no longer bear is
withdrawn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..film.moments import Moments
from .boundaries import EXPECTED_LOOKS, GROWTH, Boundary, Spending, looks_between
from .claims import FLOOR_SHARE, bound, difference, p_different, p_equivalent, tolerance_ends
from .outcome import Outcome
from .rare import FEWEST

ALL_AGREE, ONE_AGREES, ONE_DIFFERS = PARTS = (0.5, 0.1, 0.4)
"""What each kind of claim has of the error level that attribution leaves."""


def holm(p: np.ndarray, level: float) -> np.ndarray:
    """Which hypotheses with p-values `p` (m,) are rejected (Holm 1979).

    The family-wise error is `level`.
    """
    order = np.argsort(p, kind="stable")
    passed = p[order] <= level / np.arange(p.size, 0, -1)
    count = p.size if passed.all() else int(np.argmin(passed))
    rejected = np.zeros(p.size, bool)
    rejected[order[:count]] = True
    return rejected


@dataclass(frozen=True)
class Look:
    """One look at the data.

    The replicates on each side of the regions that it judged, its share of the error level, the level of its test of one region, and
    what it left undecided. `bound` is the difference up to which all regions agree, by this look and those before.
    """

    replicates: tuple[int, int]
    share: float
    level: float
    undecided: int
    bound: float


@dataclass(frozen=True)
class Withdrawn:
    """A claim that later data did not support.

    The region, what was claimed, and at how many replicates it was made and withdrawn.
    """

    region: int
    outcome: Outcome
    claimed_at: int
    withdrawn_at: int


class SequentialTest:
    """The state of the decision on N regions.

    `held_back` is the share of the error level, 1 - `confidence`, that claims made elsewhere may spend. `families` (N,) numbers the
    families of regions in the order in which they are claimed; without it all are one. `expected` is the number of looks that the level is
    shared among. `floor` (3,) is what a difference is relative to where the reference is darker; the first look fixes it, unless it is set.
    """

    def __init__(
        self,
        count: int,
        tolerance: float,
        confidence: float,
        held_back: float = 0.0,
        families: np.ndarray | None = None,
        expected: int = EXPECTED_LOOKS,
    ) -> None:
        self.tolerance = tolerance
        self.confidence = confidence
        self.level = (1 - confidence) * (1 - held_back)
        self.families = np.zeros(count, int) if families is None else families
        self.floor = np.zeros(3)
        self.looks: list[Look] = []
        self.outcomes = np.full(count, Outcome.UNDECIDED)
        self.decided_at = np.zeros(count, int)
        self.bounds = np.full(count, np.inf)
        self.rare = np.zeros(count)
        # The relative difference that unsupported materials may make, and the bounds without it; whether their light reaches a region, and
        # whether the candidate is shown to be brighter than the reference there.
        self.unsupported, self._without = np.zeros(count), np.full(count, np.inf)
        self._reached, self._brighter = np.zeros((2, count), bool)
        self.withdrawn: list[Withdrawn] = []
        self.expected = expected
        self._spending = Spending(expected)
        self._boundary = Boundary(ALL_AGREE * self.level)
        # The share and the level of the look at each number of replicates.
        self._spent: dict[int, tuple[float, float]] = {}
        # p-values over the look's share, of the claims on single regions, as of the last look at each.
        self._agrees, self._differs = np.full((2, count), np.inf)

    @property
    def undecided(self) -> np.ndarray:
        """Which regions (N,) are not decided yet."""
        return self.outcomes == Outcome.UNDECIDED

    @property
    def within(self) -> np.ndarray:
        """Which regions (N,) are shown to be within the tolerance, if the rest is.

        They need no more samples.
        """
        return self.bounds <= self.tolerance

    @property
    def blocked(self) -> np.ndarray:
        """The regions (N,) that no samples will decide.

        The light of an unsupported material may make the difference there.
        """
        alone = (self._without <= self.tolerance) & ~self.within
        return self.undecided & self._reached & (alone | (self.unsupported >= self.tolerance) | self._brighter)

    @property
    def share_left(self) -> float:
        """The share of the level that no look has spent."""
        return 1.0 - self._spending.spent

    @property
    def level_alone(self) -> float:
        """The level of the last look at which a region would be shown to agree on its own, before all others."""
        return ONE_AGREES * self.level * self.looks[-1].share / self.outcomes.size

    def share_after(self, growth: float) -> float:
        """The share of the level that a look spends once there are `growth` times the replicates."""
        return self._spending.share_of(self._spending.looks + max(1, round(np.log(growth) / np.log(GROWTH))))

    def fix_floor(self, reference: Moments) -> None:
        """Settle the floor from the moments (N, 3) of the first look; later ones change nothing."""
        if not self.looks and not self.floor.any():
            self.floor = find_floor(reference.mean, self.families)

    def look(
        self,
        reference: Moments,
        candidate: Moments,
        last: bool,
        rare: np.ndarray | float = 0.0,
        unsupported: np.ndarray | float = 0.0,
        reached: np.ndarray | bool = False,
        of: np.ndarray | None = None,
    ) -> None:
        """Judge the present data, moments (N, 3) of the region means.

        `rare` (N,) is the relative difference that unseen light may make.
        Light of unsupported materials, which the reference lacks, may make a difference of `unsupported` (N,) in the
        regions `reached` (N,). Only the regions `of` (N,) bool are judged, which have as many replicates each; by default those that
        have most.
        """
        self.fix_floor(reference)
        counts = np.broadcast_to(np.minimum(reference.n, candidate.n), self.bounds.shape)
        now = counts >= min(reference.most, candidate.most) if of is None else of
        if not now.any():
            return
        replicates = int(counts[now].max())
        share, level = self._spend(replicates, last, of is not None)
        rare = np.broadcast_to(np.asarray(rare, float), self.bounds.shape)
        unsupported = np.broadcast_to(np.asarray(unsupported, float), self.bounds.shape)
        self.unsupported = np.where(now, unsupported, self.unsupported)
        self._reached = np.broadcast_to(reached, self.bounds.shape)
        found = bound(candidate, reference, self.floor, level) + rare
        self._without = np.where(now, found, self._without)
        self.bounds = np.where(now, found + unsupported, self.bounds)
        self.rare = np.where(now, rare, self.rare)
        inside = np.maximum(self.tolerance - rare - unsupported, 0.0)[:, None]
        p = p_equivalent(*tolerance_ends(candidate, reference, inside, self.floor)) / share
        self._agrees = np.where(now, np.where(rare + unsupported < self.tolerance, p, np.inf), self._agrees)
        outside = (self.tolerance + np.where(np.isfinite(rare), rare, 0.0))[:, None]
        ends = tolerance_ends(candidate, reference, outside, self.floor)
        p = p_different(*ends, self._reached) / share
        # Few replicates may be equal by chance, and then seem to have no noise.
        known = np.isfinite(rare) & (replicates >= FEWEST)
        self._differs = np.where(now, np.where(known, p, np.inf), self._differs)
        shown = p_different(*ends) / share <= ONE_DIFFERS * self.level / self.outcomes.size
        self._brighter = np.where(now, self._reached & shown & (replicates >= FEWEST), self._brighter)
        gap = difference(candidate, reference, self.floor)
        self._claim(replicates, gap, np.isnan(reference.mean + candidate.mean).any(axis=1))
        most = (reference.most, candidate.most) if of is None else (replicates, replicates)
        self.looks.append(Look(most, share, level, int(self.undecided.sum()), self.overall_bound()))

    def _spend(self, replicates: int, last: bool, one_of_many: bool) -> tuple[float, float]:
        """The share of the look at so many `replicates`, and the level of its test of one region.

        Regions come to a number of replicates at different times, and some pass over looks. As `one_of_many`, a look has the
        place among the looks of its number of replicates: what it may spend does not depend on when it comes.
        """
        if one_of_many:
            for earlier in looks_between(max(self._spent, default=0), replicates):
                self._take(earlier, last=False)
        if replicates not in self._spent or not one_of_many:
            self._take(replicates, last)
        return self._spent[replicates]

    def _take(self, replicates: int, last: bool) -> None:
        share = self._spending.take(last)
        self._spent[replicates] = share, self._boundary.next(replicates, share)

    def overall_bound(self, of: np.ndarray | slice = slice(None)) -> float:
        """The difference up to which all regions are shown to agree; infinite if there is none.

        With `of`, (N,) bool, only these regions count.
        """
        known = self.bounds[of]
        known = known[~np.isnan(known)]
        return float(known.max()) if known.size else np.inf

    def _claim(self, replicates: int, gap: np.ndarray, missing: np.ndarray) -> None:
        """Make and withdraw claims by the present data.

        `gap` (N, 3) are the estimated differences; regions that are `missing` have no pixel left.

        A claim is made when its test passes, and stands while the data support it: the estimate, with room for rare
        light, lies on its side of the tolerance. To let it stand costs nothing, since all looks together have the
        level.
        """
        within = self.within | missing
        # Of the families in their order, all before the first that does not pass as a whole.
        failed = [family for family in np.unique(self.families) if not within[self.families == family].all()]
        passed = self.families < failed[0] if failed else np.ones_like(within)
        agrees = (passed & ~missing) | holm(self._agrees, ONE_AGREES * self.level)
        either = np.abs(gap).max(axis=1)
        agrees |= (self.outcomes == Outcome.EQUIVALENT) & (either + self.rare + self.unsupported <= self.tolerance)
        differs = holm(self._differs, ONE_DIFFERS * self.level)
        counted = np.where(self._reached, (-gap).max(axis=1), either)
        differs |= (self.outcomes == Outcome.DIFFERENT) & (counted - self.rare > self.tolerance)
        outcomes = np.full(self.outcomes.size, Outcome.UNDECIDED)
        outcomes[agrees & ~differs] = Outcome.EQUIVALENT
        outcomes[differs & ~agrees] = Outcome.DIFFERENT
        changed = outcomes != self.outcomes
        for k in np.flatnonzero(changed & ~self.undecided):
            self.withdrawn.append(Withdrawn(int(k), self.outcomes[k], int(self.decided_at[k]), replicates))
        self.outcomes = outcomes
        self.decided_at[changed] = np.where(self.undecided[changed], 0, replicates)


def find_floor(reference: np.ndarray, families: np.ndarray) -> np.ndarray:
    """The floor (3,): a share of the median of regions that are not black, per channel.

    The regions are those of the last family.
    The median is of regions that do not emit, as long as lamps fill less than half of the image. 0 where all is black.
    """
    cells = np.abs(reference[families == families.max()])
    floors = []
    for values in cells.T:
        lit = values[values > 0]
        floors.append(FLOOR_SHARE * float(np.median(lit)) if lit.size else 0.0)
    return np.array(floors)
