# SPDX-License-Identifier: GPL-3.0-or-later
"""Deciding while sampling goes on: every look at the data is paid for, and so is every region.

For each region there are two claims, inside and outside the tolerance; all 2 N of them share one error level (1 -
confidence). Look k spends a share w_k of it, with sum w_k <= 1: alpha spending (Lan and DeMets, "Discrete sequential boundaries for clinical
trials", 1983), here by Bonferroni's inequality, so that it holds however looks, regions and channels depend on one another.
The least p_k / w_k so far is then a p-value at every look, and Holm ("A simple sequentially rejective multiple test
procedure", 1979) over all 2 N of them holds the level for the family. Where attribution follows (attribution.py), the level here is what
that leaves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..film.moments import Moments
from .claims import FLOOR_SHARE, p_different, p_equivalent, tolerance_ends
from .outcome import Outcome

FIRST_LOOK = 8
GROWTH = 1.5


def next_look(replicates: int) -> int:
    """The number of replicates at which to look next: 8, 12, 18, 27, 41, ... , from quantiles of t that are bearable on."""
    look = FIRST_LOOK
    while look <= replicates:
        look = int(np.ceil(GROWTH * look))
    return look


def look_share(k: int, last: bool) -> float:
    """The share of the error level that look k = 1, 2, ... spends: 1 / (k (k + 1)), and all that is left, 1 / k, if it is the last.

    Whether it is the last may depend on time and on budgets, never on what is seen.
    """
    return 1 / k if last else 1 / (k * (k + 1))


def holm(p: np.ndarray, level: float) -> np.ndarray:
    """Which of the hypotheses with p-values `p` (m,) are rejected at family-wise error `level` (Holm 1979)."""
    order = np.argsort(p, kind="stable")
    passed = p[order] <= level / np.arange(p.size, 0, -1)
    count = p.size if passed.all() else int(np.argmin(passed))
    rejected = np.zeros(p.size, bool)
    rejected[order[:count]] = True
    return rejected


@dataclass(frozen=True)
class Look:
    """One look: replicates on each side, its share of the error level, and the regions it left undecided."""

    replicates: tuple[int, int]
    share: float
    undecided: int


class SequentialTest:
    """The state of the decision on N regions; `floor` is fixed by the first look, from the mean of region 0, the whole image.

    `held_back` is the share of the error level, 1 - `confidence`, that claims made elsewhere may spend.
    """

    def __init__(self, count: int, tolerance: float, confidence: float, held_back: float = 0.0) -> None:
        self.tolerance = tolerance
        self.confidence = confidence
        self.level = (1 - confidence) * (1 - held_back)
        self.floor = 0.0
        self.looks: list[Look] = []
        self.outcomes = np.full(count, Outcome.UNDECIDED)
        self.decided_at = np.zeros(count, int)
        self._evidence = np.full((2, count), np.inf)

    @property
    def undecided(self) -> np.ndarray:
        """Which regions (N,) are not decided yet."""
        return self.outcomes == Outcome.UNDECIDED

    @property
    def claims_left(self) -> int:
        """How many claims share the level that the next one must meet (Holm's divisor)."""
        return 2 * self.outcomes.size - int((~self.undecided).sum())

    def look(self, reference: Moments, candidate: Moments, last: bool) -> None:
        """Judge what there is, moments (N, 3) of the region means; a region once decided stays so."""
        if not self.looks:
            self.floor = FLOOR_SHARE * float(np.nan_to_num(np.abs(reference.mean[0]).mean()))
        share = look_share(len(self.looks) + 1, last)
        upper, lower = tolerance_ends(candidate, reference, self.tolerance, self.floor)
        p = np.stack([p_equivalent(upper, lower), p_different(upper, lower)])
        # What is decided may not be sampled any more, and has no share in this look.
        self._evidence = np.where(self.undecided, np.minimum(self._evidence, p / share), self._evidence)
        rejected = holm(self._evidence.ravel(), self.level).reshape(2, -1)
        for row, outcome in enumerate((Outcome.EQUIVALENT, Outcome.DIFFERENT)):
            # A region decided before keeps its outcome, even if the other claim now passes too.
            now = rejected[row] & self.undecided
            self.outcomes[now] = outcome
            self.decided_at[now] = min(reference.most, candidate.most)
        self.looks.append(Look((reference.most, candidate.most), share, int(self.undecided.sum())))
