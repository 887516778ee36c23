# SPDX-License-Identifier: GPL-3.0-or-later
"""The search for the smallest set of departures that explains the differences.

With these departures the reference agrees with the candidate.
The effect of a set S of departures on a region is known from pairs of replicates that share their scrambling (common
random numbers: Glasserman and Yao, "Some guidelines and guarantees for common random numbers", 1992), with S and
without: their mean difference d(S) has little noise of its own. The pairs are fresh, so E + d(S) is a sum of
independent means, and "the candidate agrees with the reference that departs by S" is tested against it just as
agreement with the reference itself is.

The level of all claims about causes, ATTRIBUTION_SHARE of 1 - confidence, is reserved before anything is seen;
sequential.py has the rest. Half of it is spent by explanations (causes.py says what these are), half by the
simultaneous intervals of shares, from which partial causes, small shares and contradictions are read. In each half a
set has a part fixed by its size alone (`set_share`), all of them together at most 1; looks are paid for by `Spending`,
regions by Holm (agreement) or Bonferroni (shares), channels by Bonferroni.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence, Set
from itertools import combinations
from math import comb

import numpy as np
from scipy import sparse

from ..departures.catalogue import Departure
from ..film.light_passes import INDIRECT, LightPass
from ..film.moments import Moments
from ..film.regions import RegionMoments
from ..relative import difference_scale
from .boundaries import Spending
from .causes import BAND, Shares, is_off
from .claims import p_different, p_equivalent, tolerance_ends
from .outcome import Outcome
from .sequential import SequentialTest, holm
from .shares import CHANNELS, Sides, p_share_between, share, share_interval

ATTRIBUTION_SHARE = 0.2
# Pairs of replicates behind each effect at first, enough for a variance; a set that may do gets half as many as the candidate has replicates.
PAIRS = 8
# At most so many sets of a size are rendered at one look, the most promising first.
SETS_PER_LOOK = 4
# Departures that change no region by this part of the tolerance are in no larger set.
ACTING = 0.05
# Where departures take away more than all but this part of a region's light, agreement is judged relative to this part: relative to what
# is left of it, a region that they darken altogether would have to be known without noise.
LEAST_LEFT = 0.1
# A set is dropped for a larger one when a region is outside the tolerance with it at this level, or its share is not 1. It decides what is
# tried, not what is claimed.
DROP_LEVEL = 1e-3

Names = frozenset[str]
Effects = Callable[[Names, int], np.ndarray | None]


def set_share(size: int, count: int) -> float:
    """The share of the level that one set of `size` out of `count` departures may spend.

    Single ones have 2/5 of it together, pairs and triples 1/5 each, and each greater size its part of the last 1/5.
    """
    of_size = {1: 0.4, 2: 0.2, 3: 0.2}.get(size) or 0.2 / (count - 3)
    return of_size / comb(count, size)


def acting_on(departures: Sequence[Departure], differing: Set[LightPass]) -> tuple[str, ...]:
    """The names of the departures that can act on the `differing` light passes.

    All of them where none differs.
    Nearly all act on indirect light, since it is scattered by lobes of any kind. So where other passes differ, these
    decide.
    """
    clear = differing - INDIRECT or differing
    return tuple(d.name for d in departures if not clear or d.passes & clear)


class Attribution:
    """The search, look by look.

    `effects` gives the differences of a set's pairs, (count, N, 3) or fewer; None where there are none.
    `inside` gives (N, N), dense or sparse: of each region (row), 1 for the regions that lie in it; by default each only
    in itself.
    """

    def __init__(
        self,
        departures: Sequence[Departure],
        test: SequentialTest,
        level: float,
        inside: Callable[[], np.ndarray | sparse.csr_array] | None = None,
    ) -> None:
        self.departures = tuple(departures)
        self.names = tuple(d.name for d in self.departures)
        self.complete = self.hopeless = False
        self.pairs: dict[Names, np.ndarray] = {}
        self.test = test
        self._level = level / 2.0
        self._inside = inside
        self.spending = Spending(test.expected)
        self._spent, self._seen = 1.0, 0
        self._agreement: dict[Names, np.ndarray] = {}
        self._between: dict[Names, np.ndarray] = {}
        # The names to try at this look, in their order.
        self._tried = self.names

    @property
    def put_off(self) -> frozenset[str]:
        """The names that were not tried.

        They act on no light pass that differs, and other departures explain what does differ.
        """
        return frozenset(self.names).difference(self._tried, *self.pairs)

    @property
    def wanted(self) -> np.ndarray:
        """The regions (N,) that need an explanation."""
        return self.test.outcomes != Outcome.EQUIVALENT

    @property
    def different(self) -> np.ndarray:
        """The regions (N,) that are shown to differ."""
        return self.test.outcomes == Outcome.DIFFERENT

    def look(
        self,
        reference: RegionMoments,
        candidate: RegionMoments,
        effects: Effects,
        last: bool,
        differing: Set[LightPass] = frozenset(),
    ) -> None:
        """Judge the sets tried so far on the present data, and try larger ones if needed.

        Larger sets are tried where all smaller ones are ruled out.
        Departures that can act on the light passes that are `differing` are tried first, the others where no set of
        these may do.
        """
        if not self.different.any() or self.complete:
            return
        self._spent, self._seen = self.spending.take(last), candidate.moments.most
        sides = self.sides(reference, candidate)
        first = acting_on(self.departures, differing)
        is_ruled_out = True
        for names in filter(None, dict.fromkeys((first, self.names))):
            self._tried = names
            is_ruled_out = self._look_among(sides, effects)
            if self.complete or not (is_ruled_out or last):
                return
        self.hopeless = is_ruled_out

    def _look_among(self, sides: Sides, effects: Effects) -> bool:
        """Judge and try sets of the names that are tried now; whether all of them are ruled out."""
        for size in range(1, len(self._tried) + 1):
            all_tried = self._try(size, sides, effects)
            open_ = [names for names in self._of_size(size) if not self.is_ruled_out(names, sides)]
            for names in self._of_size(size):
                self._weigh(names, names in open_, sides, effects)
            self.complete = any(self.explained(names, sides)[self.wanted].all() for names in open_)
            if self.complete or open_ or not all_tried:
                return False
        return True

    def sides(self, reference: RegionMoments, candidate: RegionMoments) -> Sides:
        """Both sides' moments, with what differences are relative to."""
        scale = difference_scale(reference.moments.mean, self.test.floor)
        return Sides(reference.moments, candidate.moments, scale)

    def _weigh(self, names: Names, open_: bool, sides: Sides, effects: Effects) -> None:
        """Take the evidence of this look for a set.

        It is weighed on the first PAIRS, or on all that are due if it may do for the whole image: two numbers of pairs, neither of
        which depends on what was seen, and either p-value counts double.
        """
        if open_:
            more = effects(names, max(PAIRS, sides.candidate.most // 2))
            self.pairs[names] = self.pairs[names] if more is None else more
        # A set that takes what agreed out of the tolerance is no explanation of the rest; not to claim one is always allowed.
        if (self._outside(names, sides) & ~self.wanted).any():
            self._agreement.pop(names, None)
            return
        effect = self.moments(names, None if open_ else PAIRS)
        agreement = 2.0 * p_equivalent(*self._ends(sides, effect)) / self._spent
        between = 2.0 * p_share_between(sides, effect, *BAND) / self._spent
        self._agreement[names] = np.minimum(self._agreement.get(names, np.inf), agreement)
        self._between[names] = np.minimum(self._between.get(names, np.inf), between)

    def explained(self, names: Names, sides: Sides) -> np.ndarray:
        """The regions (N,) that the departures `names` are claimed to explain.

        Of a region that is not shown to differ there is no share to speak of: there, agreement is all that is claimed. Half of the level
        is for agreement (Holm over the regions), half for shares (Bonferroni, since which of them are asked for depends on the data).
        """
        if names not in self._agreement:
            return np.zeros(self.test.outcomes.size, bool)
        level = self.level_of(names)
        claimed = holm(self._agreement[names], level)
        claimed &= ~self.different | (self._between[names] <= level / self.test.outcomes.size)
        off = self.shares(names, sides).off & self.different
        return claimed & ~self.contains(off) if claimed.any() else claimed

    def contains(self, marked: np.ndarray) -> np.ndarray:
        """The regions (N,) in which one of those `marked` (N,) lies, itself among them."""
        if self._inside is None or not marked.any():
            return marked
        return (self._inside() @ marked.astype(float)) > 0

    def level_of(self, names: Names) -> float:
        """What a set may spend on claims of agreement, and as much again on claims of its share."""
        return 0.5 * self._level * set_share(len(names), len(self.names))

    def shares(self, names: Names, sides: Sides) -> Shares:
        """The shares of a set, with their intervals."""
        # What came after the last look belongs to the next.
        spent = self._spent if sides.candidate.most == self._seen else self.spending.share_of(self.spending.looks + 1)
        tail = self._level * spent * set_share(len(names), len(self.names)) / (2 * CHANNELS * self.test.outcomes.size)
        effect, alone = self.moments(names), 0.5 * (1.0 - self.test.confidence)
        return Shares(
            share(sides, effect),
            *share_interval(sides, effect, tail),
            np.stack(share_interval(sides, effect, alone)),
        )

    def moments(self, names: Names, most: int | None = None) -> Moments:
        """The moments of the effect of `names`, as rendered (`most` pairs).

        Where it was not rendered, those of the sum of what each departure does alone.
        """
        pairs = self.pairs.get(names)
        if pairs is None:
            alone = [self.pairs[frozenset([name])] for name in names]
            pairs = np.sum([one[: min(map(len, alone))] for one in alone], axis=0)
        pairs = pairs[:most]
        mean = pairs.mean(axis=0)
        return Moments(len(pairs), mean, ((pairs - mean) ** 2).sum(axis=0))

    def is_ruled_out(self, names: Names, sides: Sides) -> bool:
        """Whether `names` fail in any region.

        They fail where it is outside the tolerance with them, or where it differs and their share is not 1.
        """
        tail = DROP_LEVEL / (2 * CHANNELS * self.test.outcomes.size)
        off = is_off(*share_interval(sides, self.moments(names), tail))
        return bool((self._outside(names, sides) | (off & self.different)).any())

    def left(self, names: Names, sides: Sides) -> float:
        """The relative differences that would be left over with `names`.

        They are added up over the regions that need an explanation.
        """
        left = np.abs(sides.gap - self.moments(names).mean) / np.maximum(sides.scale, 1e-300)
        return float(np.nan_to_num(left[self.wanted]).sum())

    def acting(self, sides: Sides) -> list[str]:
        """The names whose effect alone is known and may matter."""
        allowed = self.test.tolerance * sides.scale
        alone = [(name, self.pairs.get(frozenset([name]))) for name in self.names]
        return [name for name, d in alone if d is not None and (np.abs(d.mean(axis=0)) > ACTING * allowed).any()]

    def _of_size(self, size: int) -> list[Names]:
        return [names for names in self.pairs if len(names) == size]

    def _ends(self, sides: Sides, shift: Moments) -> tuple:
        floor = np.maximum(self.test.floor, LEAST_LEFT * sides.scale)
        return tolerance_ends(sides.candidate, sides.reference, self.test.tolerance, floor, shift)

    def _outside(self, names: Names, sides: Sides) -> np.ndarray:
        """The regions (N,) that are outside the tolerance with `names`.

        It serves only to choose what to try next.
        """
        p = p_different(*self._ends(sides, self.moments(names)))
        return p * p.size <= DROP_LEVEL

    def _try(self, size: int, sides: Sides, effects: Effects) -> bool:
        """Render the effects of sets of one size; whether none is left.

        All single departures are rendered; of the larger sets, those whose sum may do.
        """
        if size == 1:
            return self._try_single(effects)
        sets = [frozenset(chosen) for chosen in combinations(self.acting(sides), size)]
        sets = [names for names in sets if names not in self.pairs and not self.is_ruled_out(names, sides)]
        for names in sorted(sets, key=lambda names: self.left(names, sides))[:SETS_PER_LOOK]:
            pairs = effects(names, PAIRS)
            if pairs is None:
                return False
            self.pairs[names] = pairs
        return len(sets) <= SETS_PER_LOOK

    def _try_single(self, effects: Effects) -> bool:
        """Render each departure alone, one pair of each in turn.

        So all of them have as many pairs as time allows. Those that rounding decides come first: they need a second pair.
        """
        later = {d.name: not d.by_rounding for d in self.departures}
        tried = [frozenset([name]) for name in sorted(self._tried, key=later.__getitem__)]
        missing = [names for names in tried if len(self.pairs.get(names, ())) < PAIRS]
        for count in range(1, PAIRS + 1):
            for names in missing:
                pairs = effects(names, count)
                if pairs is not None:
                    self.pairs[names] = pairs
        return all(frozenset([name]) in self.pairs for name in self._tried)
