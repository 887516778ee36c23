# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks at accumulating data: how the level is spent, and that no more of it is."""

from itertools import pairwise

import numpy as np
import pytest
from etalon.lib.verdict.boundaries import Boundary, Spending, count_looks, next_look
from scipy import stats


def test_looks_are_at_least_a_factor_apart():
    looks = [next_look(0)]
    while looks[-1] < 100_000:
        looks.append(next_look(looks[-1]))
    assert looks[:7] == [8, 10, 12, 15, 18, 22, 27]
    assert all(b >= 1.2 * a for a, b in pairwise(looks))
    assert next_look(20) == 22
    assert [count_looks(n) for n in (1, 8, 9, 10, 27)] == [1, 1, 1, 2, 7]


@pytest.mark.parametrize("last", [1, 3, 20, 21, 40, 60])
def test_shares_of_all_looks_are_at_most_one(last):
    spending = Spending(20)
    shares = [spending.take(False) for _ in range(last - 1)]
    assert sum(shares) + spending.take(True) == pytest.approx(1.0)
    assert all(share > 0 for share in shares)


def rejected(rng, spending, level, looks, runs=200_000):
    """In what part of the runs any look rejects, where nothing is to be found."""
    boundary, total, n, ever = Boundary(level), np.zeros(runs), 0, np.zeros(runs, bool)
    for k in range(looks):
        more = next_look(n)
        total += np.sqrt(more - n) * rng.standard_normal(runs)
        n = more
        ever |= total / np.sqrt(n) > stats.norm.isf(boundary.next(n, spending.take(k == looks - 1)))
    return ever.mean()


@pytest.mark.parametrize("looks", [1, 5, 15])
@pytest.mark.parametrize("level", [0.05, 0.005])
def test_all_of_the_level_is_spent_and_no_more(rng, level, looks):
    found = rejected(rng, Spending(20), level, looks)
    assert found == pytest.approx(level, abs=4 * np.sqrt(level / 200_000))


def test_looks_that_cost_nothing_reject_too_often(rng, monkeypatch):
    """The test above can fail."""
    monkeypatch.setattr(Boundary, "next", lambda self, replicates, share: self.level)
    assert rejected(rng, Spending(20), 0.05, 5) > 0.07


def test_a_look_spends_at_least_what_bonferroni_allows():
    boundary = Boundary(0.005)
    levels = [boundary.next(n, 0.05) for n in (8, 10, 12, 12.05, 15)]
    assert levels[0] == pytest.approx(0.005 * 0.05, rel=1e-6)
    assert levels[3] == pytest.approx(0.005 * 0.05)
    assert all(level >= 0.005 * 0.05 * (1 - 1e-6) for level in levels)
    assert levels[2] > 1.5 * levels[0]
