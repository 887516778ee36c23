# SPDX-License-Identifier: GPL-3.0-or-later
"""Why regions differ: the smallest set of named departures with which the reference agrees with the candidate.

What a set S of departures does to a region is known from pairs of replicates that share their scrambling (common random
numbers: Glasserman and Yao, "Some guidelines and guarantees for common random numbers", 1992), with S and without: their mean
difference d(S) has little noise of its own. The pairs are fresh, so E + d(S) is a sum of independent means, and "the candidate
agrees with the reference that departs by S" is tested against it just as agreement with the reference itself is.

The level is kept by holding back a part of it, ATTRIBUTION_SHARE, before anything is seen; sequential.py has the rest. Of
that part each set has a share fixed by its size alone (`set_share`), all of them together at most 1, and looks and regions within a set's
share are paid for as in sequential.py. So whichever sets are tried, the chance of any false claim, of agreement or of a cause, is at most
1 - confidence.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np

from ..departures.catalogue import Departure
from ..film.moments import Moments
from ..film.regions import RegionMoments
from .claims import p_different, p_equivalent, tolerance_ends
from .outcome import Outcome
from .sequential import SequentialTest, holm, look_share

ATTRIBUTION_SHARE = 0.1
# Pairs of replicates behind each effect at first, enough for a variance; a set that may do gets half as many as the candidate has replicates.
PAIRS = 8
# At most so many sets of a size are rendered at one look, the most promising first.
SETS_PER_LOOK = 4
# Departures that change no region by this part of the tolerance are in no larger set.
ACTING = 0.05
# A set is dropped for a larger one when a region is outside the tolerance with it at this level. It decides what is tried, not what is claimed.
DROP_LEVEL = 1e-3

Names = frozenset[str]
Effects = Callable[[Names, int], np.ndarray | None]


def set_share(size: int, count: int) -> float:
    """The share of the level that one set of `size` out of `count` departures may spend.

    Single ones have 2/5 of it together, pairs and triples 1/5 each, and each greater size its part of the last 1/5.
    """
    of_size = {1: 0.4, 2: 0.2, 3: 0.2}.get(size) or 0.2 / (count - 3)
    return of_size / comb(count, size)


@dataclass(frozen=True)
class Explanation:
    """What attribution found of N regions and M departures.

    `chosen` are the fewest names with which every region that was not EQUIVALENT agrees, if `complete` says that there are such; else all that
    explain some region. `causes` (N) are the names that explain each region, the fewest again, empty where nothing does.
    `effect` (M, N, 3) is what each departure alone adds to the reference, relative to it, and `share` (M, N) what part that is
    of the difference in the channel furthest off; both NaN where the departure was not rendered. `rest` (N, 3) is the relative
    difference that remains with `chosen`. At least `PAIRS` pairs of replicates of `samples` per pixel stand behind each effect, in
    `seconds` altogether.
    """

    departures: tuple[Departure, ...]
    chosen: tuple[str, ...]
    complete: bool
    causes: tuple[tuple[str, ...], ...]
    effect: np.ndarray
    share: np.ndarray
    rest: np.ndarray
    samples: int
    seconds: float


class Attribution:
    """The search, look by look. `effects` gives the differences of a set's pairs, (count, N, 3) or fewer; None where there are none."""

    def __init__(self, departures: Sequence[Departure], test: SequentialTest, level: float) -> None:
        self.departures = tuple(departures)
        self.complete = self.hopeless = False
        self._names = tuple(d.name for d in self.departures)
        self._test, self._level = test, level
        self._looks = 0
        self._pairs: dict[Names, np.ndarray] = {}
        self._evidence: dict[Names, np.ndarray] = {}

    @property
    def _wanted(self) -> np.ndarray:
        """The regions (N,) that need an explanation."""
        return self._test.outcomes != Outcome.EQUIVALENT

    def look(self, reference: RegionMoments, candidate: RegionMoments, effects: Effects, last: bool) -> None:
        """Judge the sets tried so far on what there is, and try larger ones where all smaller ones are ruled out."""
        if not (self._test.outcomes == Outcome.DIFFERENT).any() or self.complete:
            return
        self._looks += 1
        share = look_share(self._looks, last)
        sides = reference.moments, candidate.moments
        for size in range(1, len(self._names) + 1):
            all_tried = self._try(size, sides, effects)
            open_ = [names for names in self._of_size(size) if not self._ruled_out(names, sides)]
            for names in self._of_size(size):
                self._weigh(names, names in open_, sides, share, effects)
            self.complete = any(self.explained(names)[self._wanted].all() for names in open_)
            if self.complete or open_ or not all_tried:
                return
        self.hopeless = True

    def _weigh(self, names: Names, open_: bool, sides: tuple[Moments, Moments], share: float, effects: Effects) -> None:
        """Take the evidence of this look for a set.

        It is weighed on the first PAIRS, or on all that are due if it may do for the whole image: two numbers of pairs, neither of
        which depends on what was seen, and either p-value counts double.
        """
        if open_:
            more = effects(names, max(PAIRS, sides[1].most // 2))
            self._pairs[names] = self._pairs[names] if more is None else more
        # A set that takes what agreed out of the tolerance is no explanation of the rest; not to claim one is always allowed.
        if (self._outside(names, sides) & ~self._wanted).any():
            self._evidence.pop(names, None)
            return
        p = 2.0 * p_equivalent(*self._ends(sides, self._moments(names, None if open_ else PAIRS)))
        self._evidence[names] = np.minimum(self._evidence.get(names, np.inf), p / share)

    def explained(self, names: Names) -> np.ndarray:
        """The regions (N,) of which agreement with the departures `names` is claimed."""
        if names not in self._evidence:
            return np.zeros(self._test.outcomes.size, bool)
        return holm(self._evidence[names], self._level * set_share(len(names), len(self._names)))

    def conclude(
        self, reference: RegionMoments, candidate: RegionMoments, samples: int, seconds: float
    ) -> Explanation | None:
        """What was found; None where nothing had to be explained or nothing was rendered."""
        if not self._pairs:
            return None
        wanted = self._wanted
        # Of equal merit is the set with the least left over; NaN, of regions with no pixel left, counts as much.
        e, gap = reference.moments.mean, candidate.moments.mean - reference.moments.mean
        scale = np.maximum(np.abs(e), self._test.floor)
        merit = {}
        for names in self._pairs:
            left = np.abs(gap - self._moments(names).mean)[wanted] / scale[wanted]
            merit[names] = (
                -int(self.explained(names)[wanted].sum()),
                len(names),
                float(np.nan_to_num(left, nan=1e3).sum()),
            )
        best = min(merit, key=merit.get)
        causes = tuple(self._causes(k, best) if wanted[k] else () for k in range(wanted.size))
        # Where no set does for all, each region's own causes count.
        chosen = best if self.complete else frozenset().union(*causes)
        with np.errstate(divide="ignore", invalid="ignore"):
            worst = np.argmax(np.nan_to_num(np.abs(gap / scale), nan=-1.0), axis=1)[:, None]
            effect = np.full((len(self._names), *gap.shape), np.nan)
            share = np.full(effect.shape[:2], np.nan)
            for k, name in enumerate(self._names):
                if frozenset([name]) in self._pairs:
                    d = self._moments(frozenset([name])).mean
                    effect[k] = d / scale
                    share[k] = (np.take_along_axis(d, worst, 1) / np.take_along_axis(gap, worst, 1))[:, 0]
            rest = (gap - (self._moments(chosen).mean if chosen else 0.0)) / scale
        return Explanation(
            self.departures,
            self._ordered(chosen),
            self.complete,
            causes,
            effect,
            share,
            rest,
            samples,
            seconds,
        )

    def _causes(self, region: int, chosen: Names) -> tuple[str, ...]:
        """The fewest departures that explain a region; among those the ones that explain the image."""
        sets = [names for names in self._pairs if self.explained(names)[region]]
        if not sets:
            return ()
        return self._ordered(min(sets, key=lambda names: (len(names), not names <= chosen, sorted(names))))

    def _ordered(self, names: Names) -> tuple[str, ...]:
        return tuple(name for name in self._names if name in names)

    def _of_size(self, size: int) -> list[Names]:
        return [names for names in self._pairs if len(names) == size]

    def _moments(self, names: Names, most: int | None = None) -> Moments:
        """Of the effect of `names`, as rendered (`most` pairs) or, where it was not, as the sum of what each does alone."""
        pairs = self._pairs.get(names)
        if pairs is None:
            alone = [self._pairs[frozenset([name])] for name in names]
            pairs = sum(one[: min(map(len, alone))] for one in alone)
        pairs = pairs[:most]
        mean = pairs.mean(axis=0)
        return Moments(len(pairs), mean, ((pairs - mean) ** 2).sum(axis=0))

    def _ends(self, sides: tuple[Moments, Moments], shift: Moments) -> tuple:
        return tolerance_ends(sides[1], sides[0], self._test.tolerance, self._test.floor, shift)

    def _outside(self, names: Names, sides: tuple[Moments, Moments]) -> np.ndarray:
        """The regions (N,) that are outside the tolerance with `names`, as far as what to try next is concerned."""
        p = p_different(*self._ends(sides, self._moments(names)))
        return p * p.size <= DROP_LEVEL

    def _ruled_out(self, names: Names, sides: tuple[Moments, Moments]) -> bool:
        """Whether any region is outside with `names`."""
        return bool(self._outside(names, sides).any())

    def _try(self, size: int, sides: tuple[Moments, Moments], effects: Effects) -> bool:
        """Render the effects of sets of one size: all single ones, of the others those whose sum may do; whether none is left."""
        names = self._names if size == 1 else self._acting(sides[0])
        sets = [frozenset(chosen) for chosen in combinations(names, size)]
        sets = [names for names in sets if names not in self._pairs]
        most = len(sets)
        if size > 1:
            sets = [names for names in sets if not self._ruled_out(names, sides)]
            sets = sorted(sets, key=lambda names: self._left(names, sides))
            most = SETS_PER_LOOK
        for names in sets[:most]:
            pairs = effects(names, PAIRS)
            if pairs is None:
                return False
            self._pairs[names] = pairs
        return len(sets) <= most

    def _acting(self, reference: Moments) -> list[str]:
        """The names whose effect alone is known and may matter."""
        allowed = self._test.tolerance * np.maximum(np.abs(reference.mean), self._test.floor)
        alone = [(name, self._pairs.get(frozenset([name]))) for name in self._names]
        return [name for name, d in alone if d is not None and (np.abs(d.mean(axis=0)) > ACTING * allowed).any()]

    def _left(self, names: Names, sides: tuple[Moments, Moments]) -> float:
        """The mean relative difference that would be left over with `names`."""
        e, c = sides[0].mean, sides[1].mean
        left = np.abs(c - e - self._moments(names).mean) / np.maximum(np.abs(e), max(self._test.floor, 1e-300))
        return float(np.nan_to_num(left[self._wanted]).sum())
