# SPDX-License-Identifier: GPL-3.0-or-later
"""Which light differs: the test of light passes in the regions that have a name.

Pass p in region r is tested as a region of its own is (sequential.py), against the same tolerance, relative to the pass's own light, or
to the image's floor where the pass is darker. All passes in all of these regions together have `PASSES_SHARE` of 1 - confidence, a quarter
of what is held back for causes, so claims on the image keep their level. No claim of the verdict rests on a pass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..film.light_passes import LightPass
from ..film.moments import Moments
from ..film.parts import Part
from ..film.regions import RegionMoments
from ..relative import difference_scale
from .claims import WAYS_TO_DIFFER, difference, interval
from .outcome import Outcome
from .rare import FEWEST, describe_tails, room_for_rare_light
from .sequential import ALL_AGREE, ONE_DIFFERS, SequentialTest

PASSES_SHARE = 0.05

Passes = dict[Part, RegionMoments]


@dataclass(frozen=True)
class PassVerdict:
    """What is claimed of P light passes in K regions, the image first.

    `outcomes` (P, K) of Outcome, `bounds` (P, K) as in Verdict; `difference`, `low`, `high` (P, K, 3) the relative difference
    and its interval, simultaneous for all passes, regions and channels; `reference`, `candidate` (P, K, 3) means; `shares` (P, K) the
    part of a region's light that arrives by each pass, by the reference.
    """

    passes: tuple[Part, ...]
    outcomes: np.ndarray
    bounds: np.ndarray
    difference: np.ndarray
    low: np.ndarray
    high: np.ndarray
    reference: np.ndarray
    candidate: np.ndarray
    shares: np.ndarray


class PassTest:
    """The state of the test of `passes` in `count` regions.

    `families` (count,) as in SequentialTest, `expected` its number of looks.
    """

    def __init__(
        self,
        passes: Sequence[Part],
        families: np.ndarray,
        tolerance: float,
        confidence: float,
        expected: int,
    ) -> None:
        self._passes, self._count = tuple(passes), families.size
        self._test = SequentialTest(
            len(passes) * families.size,
            tolerance,
            confidence,
            1.0 - PASSES_SHARE,
            np.tile(families, len(passes)),
            expected,
        )

    @property
    def differing(self) -> frozenset[LightPass]:
        """The light passes that are shown to differ in the image or in a region with a name."""
        differs = (self._test.outcomes == Outcome.DIFFERENT).reshape(len(self._passes), self._count).any(axis=1)
        return frozenset(
            name for name, one in zip(self._passes, differs, strict=True) if one and isinstance(name, LightPass)
        )

    def look(
        self,
        reference: Passes,
        candidate: Passes,
        samples: tuple[int, int],
        floor: np.ndarray,
        last: bool,
    ) -> None:
        """Judge the present data, of `samples` per pixel in each replicate of both sides.

        `floor` (3,) is the image's. Without more replicates of any region there is nothing to judge.
        """
        self._test.floor = floor
        mine, theirs = self._stacked(reference), self._stacked(candidate)
        if not self._test.looks or (mine.most, theirs.most) != self._test.looks[-1].replicates:
            self._test.look(mine, theirs, last, self._room(reference, candidate, samples))

    def conclude(self, reference: Passes, candidate: Passes) -> PassVerdict | None:
        """The verdict on the passes; None before the first look."""
        test = self._test
        if not test.looks:
            return None
        mine, theirs = self._stacked(reference), self._stacked(candidate)
        tail = ONE_DIFFERS * test.level * test.looks[-1].share / (WAYS_TO_DIFFER * test.outcomes.size)
        low, high = interval(theirs, mine, test.floor, tail)
        shape = (len(self._passes), self._count)
        light = np.abs(mine.mean).reshape(*shape, 3)
        whole = np.maximum(np.abs(mine.mean.reshape(*shape, 3).sum(axis=0)), np.finfo(float).tiny)
        return PassVerdict(
            passes=self._passes,
            outcomes=test.outcomes.reshape(shape),
            bounds=test.bounds.reshape(shape),
            difference=difference(theirs, mine, test.floor).reshape(*shape, 3),
            low=low.reshape(*shape, 3),
            high=high.reshape(*shape, 3),
            reference=mine.mean.reshape(*shape, 3),
            candidate=theirs.mean.reshape(*shape, 3),
            shares=(light / whole).mean(axis=2),
        )

    def _stacked(self, side: Passes) -> Moments:
        """The moments of all passes, one after the other.

        Each pass of a region counts as if it were a region (P K, 3).
        """
        parts = [side[name].moments for name in self._passes]
        n, times = (
            np.concatenate([np.broadcast_to(one, self._count) for one in counts])
            for counts in ([part.n for part in parts], [part.n if part.times is None else part.times for part in parts])
        )
        return Moments(n, np.concatenate([p.mean for p in parts]), np.concatenate([p.m2 for p in parts]), times)

    def _room(self, reference: Passes, candidate: Passes, samples: tuple[int, int]) -> np.ndarray:
        """The relative difference (P K,) that light not met by any sample may make.

        See `room_for_rare_light`.
        """
        found = []
        for name in self._passes:
            worth, least = 0.0, np.inf
            for side, each in zip((reference[name], candidate[name]), samples, strict=True):
                drawn = side.drawn(each)
                worth = np.maximum(worth, describe_tails(side.series, drawn, side.weights).worth.max(initial=0.0))
                least = np.minimum(least, drawn * side.moments.n)
            room = room_for_rare_light(worth, least, ALL_AGREE * self._test.level)
            # Few replicates tell of no tail. They may be equal by chance: two of them met the same lamp at an edge, or none.
            few = np.minimum(reference[name].moments.n, candidate[name].moments.n) < FEWEST
            room = np.where(few, np.inf, room)
            mean = reference[name].moments.mean
            # Rare light of a pass that is darker than the floor counts by the floor, too.
            with np.errstate(invalid="ignore"):  # no bound on no light is no bound
                found.append(room * np.abs(mean).mean(axis=1) / difference_scale(mean, self._test.floor).mean(axis=1))
        return np.nan_to_num(np.concatenate(found), nan=np.inf, posinf=np.inf)
