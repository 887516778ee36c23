# SPDX-License-Identifier: GPL-3.0-or-later
"""Claims and intervals from pairs.

Tested are their equation, their level on known pairs, and pairs without noise.
"""

import numpy as np
import pytest
from etalon.lib.audit.paired import interval, p_values
from scipy.special import stdtrit
from scipy.stats import binom

TRIALS, REPLICATES = 4000, 8


def pairs(rng, ratio, noise=0.2, common=0.95):
    """Series (replicates, trials, 3) with neutral means 1.

    With the setting the mean is `ratio`, and most of the noise is common to both.
    """
    shape = (REPLICATES, TRIALS, 3)
    shared, own = rng.standard_normal(shape), rng.standard_normal(shape)
    neutral = 1.0 + noise * shared
    return ratio * (1.0 + noise * (common * shared + np.sqrt(1 - common**2) * own)), neutral


def test_the_ends_solve_their_equation(rng):
    user, neutral = pairs(rng, 0.8)
    tail = 1e-3
    q = -stdtrit(REPLICATES - 1, tail)
    for end in interval(user, neutral, 1e-3, tail):
        found = np.isfinite(end)
        assert found.mean() > 0.9
        series = (user - neutral) - end * neutral
        error = series.std(axis=0, ddof=1) / np.sqrt(REPLICATES)
        np.testing.assert_allclose(np.abs(series.mean(axis=0))[found], (q * error)[found], rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize("floor", [1e-3, 10.0])
def test_the_interval_holds_as_often_as_it_says(rng, floor):
    """This holds also where the region is darker than the floor.

    The difference is then relative to the floor.
    """
    user, neutral = pairs(rng, 0.97)
    low, high = interval(user, neutral, floor, 0.01)
    truth = -0.03 if floor < 1 else -0.03 / floor
    missed = ((truth < low) | (truth > high)).sum()
    ends = binom.ppf([1e-5, 1 - 1e-5], 3 * TRIALS, 0.02)
    assert ends[0] <= missed <= ends[1]


def test_common_noise_makes_narrow_intervals(rng):
    wide, narrow = (np.subtract(*interval(*pairs(rng, 0.97, common=c), 1e-3, 0.01)[::-1]).mean() for c in (0.0, 0.99))
    assert narrow < 0.3 * wide


@pytest.mark.parametrize(("ratio", "claim"), [(0.99, 0), (1.01, 0), (0.99, 1), (1.01, 1)])
def test_neither_claim_is_made_too_often_at_the_edge_of_the_tolerance(rng, ratio, claim):
    """Exactly at the tolerance both claims are false, each at most at its level.

    Three channels on the same side make the first one rarer.
    """
    p = p_values(*pairs(rng, ratio, noise=0.01), 0.01, 1e-3)[claim]
    assert (p <= 0.05).sum() <= binom.ppf(1 - 1e-5, TRIALS, 0.05)


def test_a_bias_is_claimed_and_its_absence_too(rng):
    for ratio, claim in ((0.97, 1), (1.0, 0)):
        p = p_values(*pairs(rng, ratio, noise=0.01), 0.01, 1e-3)
        assert np.mean(p[claim] < 1e-3) > 0.9
        assert np.mean(p[1 - claim] > 0.5) > 0.99


def test_without_noise():
    """Exactly equal sides show no bias, also where all is black.

    A sure difference is a sure bias; a single replicate says nothing.
    """
    same = np.ones((4, 1, 3))
    for level in (0.0, 1.0):
        floor = 1e-3 * level
        np.testing.assert_array_equal(p_values(level * same, level * same, 0.01, floor), [[0.0], [1.0]])
        for end in interval(level * same, level * same, floor, 1e-6):
            np.testing.assert_array_equal(end, np.zeros((1, 3)))
    np.testing.assert_array_equal(p_values(1.5 * same, same, 0.01, 1e-3), [[1.0], [0.0]])
    np.testing.assert_allclose(interval(1.5 * same, same, 1e-3, 1e-6), 0.5 * np.ones((2, 1, 3)), rtol=1e-12)
    np.testing.assert_array_equal(p_values(same[:1], same[:1], 0.01, 1e-3), [[1.0], [1.0]])
    assert np.isnan(interval(same[:1], same[:1], 1e-3, 1e-6)).all()


def test_equal_to_the_last_bit_is_equal_however_noisy(rng):
    noisy = np.exp(5.0 * rng.standard_normal((2, 3, 3)))
    np.testing.assert_array_equal(p_values(noisy, noisy, 0.01, 1e-3), [[0.0] * 3, [1.0] * 3])
    for end in interval(noisy, noisy, 1e-3, 1e-6):
        np.testing.assert_array_equal(end, np.zeros((3, 3)))
    other = noisy.copy()
    other[1, 2, 0] *= 1.5
    assert p_values(other, noisy, 0.01, 1e-3)[0, 2] > 0.0
