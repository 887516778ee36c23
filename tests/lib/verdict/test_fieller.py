# SPDX-License-Identifier: GPL-3.0-or-later
"""Fieller's interval of a ratio against its definition and by its coverage."""

import numpy as np
from etalon.lib.verdict.fieller import fieller
from scipy.stats import binom, norm


def test_at_both_ends_the_combination_is_q_standard_errors_from_zero(rng):
    a, b = rng.normal(3.0, 1.0, 50), rng.normal(5.0, 0.5, 50)
    aa, bb, ab, q = 0.09, 0.04, 0.03, 2.5
    for end in fieller(a, b, (aa, bb), ab, q):
        distance = np.abs(a - end * b) / np.sqrt(aa - 2 * end * ab + end * end * bb)
        np.testing.assert_allclose(distance, q, rtol=1e-9)


def test_without_noise_it_is_the_ratio():
    np.testing.assert_array_equal(fieller(np.array([3.0]), np.array([4.0]), (0.0, 0.0), 0.0, 5.0), [[0.75], [0.75]])


def test_it_is_unbounded_where_the_denominator_is_not_distinct_from_zero_or_no_variance_is_known():
    for b, bb in ((0.1, 0.04), (0.0, 0.0), (1.0, np.nan)):
        low, high = fieller(np.array([1.0]), np.array([b]), (np.array([0.01]), np.array([bb])), 0.0, 2.0)
        assert (low, high) == (-np.inf, np.inf)


def test_it_covers_the_true_ratio_as_often_as_it_says(rng):
    """Correlated estimates of 0.7 and 1, where the delta method fails.

    The denominator is as noisy as 4 standard errors.
    """
    runs, rho, q = 20000, 0.7, norm.isf(0.025)
    covariance = np.array([[0.04, 0.02], [0.02, 0.0625]])
    a, b = rng.multivariate_normal([rho, 1.0], covariance, runs).T
    low, high = fieller(a, b, (covariance[0, 0], covariance[1, 1]), covariance[0, 1], q)
    # Where the denominator is not distinct from 0 the interval is the whole line, which always covers.
    covered = int(((low <= rho) & (rho <= high)).sum())
    assert covered >= binom.ppf(0.001, runs, 0.95)
    bounded = np.isfinite(low)
    assert covered - (~bounded).sum() <= binom.ppf(0.999, runs, 0.95)
