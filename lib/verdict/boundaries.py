# SPDX-License-Identifier: GPL-3.0-or-later
"""How often the data may be looked at, and how the error level is spent on it.

Look k spends a share of the level that is laid down before anything is seen (`Spending`). What a look may spend turns into the level of
its own test in one of two ways. Bonferroni's inequality adds the levels up, however the looks depend on one another. `Boundary` is
exact for a mean of independent replicates: it asks for the probability that this look is the first to reject.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy
from scipy.special import ndtr, ndtri

FIRST_LOOK = 8
GROWTH = 1.2
# Looks among which the level is shared where nothing says how many there will be: 8 to some 300 replicates.
EXPECTED_LOOKS = 20
# Points of the grid on which densities are integrated, and how far it reaches, in standard deviations.
_POINTS, _REACH = 512, 8.5
# Of looks that are nearer to each other than this factor, the later one pays by Bonferroni's inequality: the grid is too coarse.
_NEAREST = 1.01


def next_look(replicates: int) -> int:
    """The number of replicates at which to look next: 8, 10, 12, 15, 18, 22, ...

    Each is a factor GROWTH or more above the last.
    """
    look = FIRST_LOOK
    while look <= replicates:
        look = int(np.ceil(GROWTH * look))
    return look


def looks_between(first: int, last: int) -> list[int]:
    """The numbers of replicates of the looks above `first` and below `last`."""
    found = []
    while (look := next_look(found[-1] if found else first)) < last:
        found.append(look)
    return found


def count_looks(replicates: int) -> int:
    """How many looks there are at up to so many replicates, at least 1."""
    look, count = FIRST_LOOK, 1
    while (look := next_look(look)) <= replicates:
        count += 1
    return count


class Spending:
    """The shares of the error level that successive looks spend, at most 1 in all.

    The first `expected` looks have equal shares; those after them divide one more such share as 1 / (j (j + 1)). Equal shares over a
    geometric series of looks favour no number of replicates, so they suit a need that is not known.
    """

    def __init__(self, expected: int = EXPECTED_LOOKS) -> None:
        self.expected = expected
        self.looks, self.spent = 0, 0.0

    def take(self, last: bool) -> float:
        """The share of the next look; all that is left if it is the `last`.

        Whether it is the last may depend on time and budgets, never on what is seen.
        """
        share = 1.0 - self.spent if last else self.share_of(self.looks + 1)
        self.looks += 1
        self.spent += share
        return share

    def share_of(self, look: int) -> float:
        """The share of look number `look` = 1, 2, ... where it is not the last."""
        equal, beyond = 1.0 / (self.expected + 1), look - self.expected
        return equal if beyond <= 0 else equal / (beyond * (beyond + 1))


class Boundary:
    """Levels of successive one-sided tests of one mean.

    Together they reject a true hypothesis with probability `level` at most.
    The statistic at n replicates is a sum of n independent normal terms, a Brownian motion observed at the times n. Its
    density among the paths that no look has rejected is carried from look to look (Armitage, McPherson and Rowe,
    "Repeated significance tests on accumulating data", 1969), and each look rejects the share that it may spend (Lan
    and DeMets, "Discrete sequential boundaries for clinical trials", 1983). The levels are used for Student's t as they
    stand (Jennison and Turnbull, "Group sequential methods", 2000, section 3.3).
    """

    def __init__(self, level: float) -> None:
        self.level = level
        # The looks so far as (replicates, share); those that are too near to the one before are not among them.
        self._looks: tuple[tuple[float, float], ...] = ()

    def next(self, replicates: float, share: float) -> float:
        """The level of a test at `replicates` that spends `share` of the whole.

        It is at least what Bonferroni's inequality allows.
        """
        if self._looks and replicates < _NEAREST * self._looks[-1][0]:
            return self.level * share
        self._looks = (*self._looks, (replicates, share))
        return float(ndtr(-_look(self.level, self._looks).z))


@dataclass(frozen=True)
class _State:
    """The state after a look.

    The `z` beyond which it rejected, and the density of paths that no look has rejected, as `points` and `weights` of a
    sum.
    """

    z: float
    points: np.ndarray
    weights: np.ndarray


@lru_cache(maxsize=256)
def _look(level: float, looks: tuple[tuple[float, float], ...]) -> _State:
    """The state after the last of `looks`."""
    *earlier, (replicates, share) = looks
    before, time = (_look(level, tuple(earlier)), earlier[-1][0]) if earlier else (_START, 0.0)
    scale, step = np.sqrt(replicates), np.sqrt(replicates - time)
    z = _rejecting(before, scale, step, level * share)
    points = np.linspace(-_REACH, z, _POINTS) * scale
    density = np.exp(-0.5 * ((points[:, None] - before.points) / step) ** 2) @ before.weights
    weights = density * (points[1] - points[0]) / (step * np.sqrt(2.0 * np.pi))
    weights[[0, -1]] *= 0.5
    return _State(z, points, weights)


_START = _State(np.inf, np.zeros(1), np.ones(1))


def _rejecting(before: _State, scale: float, step: float, spend: float) -> float:
    """The z beyond which the statistic lies with probability `spend`.

    No look before may have rejected.
    """

    def excess(z: float) -> float:
        return float(before.weights @ ndtr((before.points - z * scale) / step)) - spend

    plain = float(-ndtri(spend))
    return plain if excess(plain) >= 0 else scipy.optimize.brentq(excess, 0.0, plain, xtol=1e-9)
