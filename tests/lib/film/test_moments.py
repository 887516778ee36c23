# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments against exact rational arithmetic, which has no rounding to forgive."""

from fractions import Fraction

import numpy as np
import pytest
from etalon.lib.film.moments import Moments, merge
from scipy import stats


def exact(values):
    """Mean and sum of squared deviations of each column, from the floats as they are."""
    means, squares = [], []
    for column in values.T:
        numbers = [Fraction(float(v)) for v in column]
        mean = sum(numbers) / len(numbers)
        means.append(float(mean))
        squares.append(float(sum((v - mean) ** 2 for v in numbers)))
    return np.array(means), np.array(squares)


def one_by_one(values):
    moments = Moments.empty(values.shape[1:])
    for row in values:
        moments.add(row)
    return moments


@pytest.mark.parametrize("offset", [0.0, 1.0, 1e8])
def test_moments_are_exact_to_rounding(rng, offset):
    """With an offset of 1e8, E[x^2] - E[x]^2 would have no digit left.

    1e16 times 2^-53 is all of the variance.
    """
    values = offset + rng.standard_normal((200, 5))
    mean, m2 = exact(values)
    moments = one_by_one(values)
    np.testing.assert_allclose(moments.mean, mean, rtol=1e-14, atol=1e-14)
    np.testing.assert_allclose(moments.m2, m2, rtol=1e-6 if offset > 1 else 1e-12)
    naive = (values**2).sum(axis=0) - values.sum(axis=0) ** 2 / len(values)
    assert offset < 1e8 or not np.allclose(naive, m2, rtol=1e-2)


def test_merging_in_any_order_gives_the_same(rng):
    values = 3.0 + rng.standard_normal((90, 4))
    parts = [one_by_one(part) for part in np.split(values, [1, 7, 8, 40])]
    mean, m2 = exact(values)
    for order in ([0, 1, 2, 3, 4], [4, 2, 0, 3, 1]):
        merged = Moments.empty((4,))
        for index in order:
            merged = merge(merged, parts[index])
        assert merged.n == 90
        np.testing.assert_allclose(merged.mean, mean, rtol=1e-14)
        np.testing.assert_allclose(merged.m2, m2, rtol=1e-13)
    tree = merge(merge(parts[0], parts[1]), merge(merge(parts[2], parts[3]), parts[4]))
    np.testing.assert_allclose(tree.m2, m2, rtol=1e-13)


def test_one_observation_has_no_variance():
    moments = Moments.empty((2,))
    moments.add(np.array([1.0, 2.0]))
    assert np.isnan(moments.variance).all()
    assert np.isnan(moments.standard_error).all()


def test_equal_observations_have_none_either():
    """No rounding may pretend to noise where there is none."""
    moments = one_by_one(np.full((50, 3), 0.1))
    assert (moments.m2 == 0).all()
    assert (moments.mean == 0.1).all()


def test_entries_may_be_observed_more_often_than_others(rng):
    values = rng.standard_normal((9, 4, 5, 3))
    moments, often = Moments.empty((4, 5, 3)), rng.random((4, 5)) < 0.4
    for k, row in enumerate(values):
        moments.add(row if k < 3 else np.where(often[..., None], row, np.nan), None if k < 3 else often)
    assert moments.most == 9
    assert (moments.n == np.where(often, 9, 3)).all()
    for which, count in ((often, 9), (~often, 3)):
        direct = values[:count, which]
        np.testing.assert_allclose(moments.mean[which], direct.mean(axis=0), rtol=1e-12, atol=1e-14)
        np.testing.assert_allclose(moments.variance[which], direct.var(axis=0, ddof=1), rtol=1e-12)
    moments.add(values[0])
    assert (moments.n == np.where(often, 10, 4)).all()
    np.testing.assert_allclose(
        moments.mean[~often], np.append(values[:3], values[:1], 0)[:, ~often].mean(axis=0), atol=1e-14
    )


def test_arguments_are_left_alone(rng):
    a, b = one_by_one(rng.standard_normal((5, 3))), one_by_one(rng.standard_normal((6, 3)))
    kept = a.mean.copy(), a.m2.copy(), b.mean.copy(), b.m2.copy()
    merge(a, b)
    for before, after in zip(kept, (a.mean, a.m2, b.mean, b.m2), strict=True):
        assert (before == after).all()


def test_an_observation_of_weight_w_counts_as_the_mean_of_w(rng):
    """Weighted mean and sum of squares against their definitions.

    The degrees of freedom are those of the observations.
    """
    weights = np.array([1, 1, 4, 2, 8, 1])
    values, often = 3.0 + rng.standard_normal((6, 7, 3)), rng.random(7) < 0.5
    moments = Moments.empty((7, 3))
    for k, (row, weight) in enumerate(zip(values, weights, strict=True)):
        moments.add(row, None if k < 3 else often, int(weight))
    for which, count in ((often, 6), (~often, 3)):
        w, x = weights[:count, None, None], values[:count, which]
        mean = (w * x).sum(axis=0) / w.sum()
        np.testing.assert_allclose(moments.mean[which], mean, rtol=1e-13)
        np.testing.assert_allclose(moments.m2[which], (w * (x - mean) ** 2).sum(axis=0), rtol=1e-12)
        assert (moments.n[which] == w.sum()).all()
        assert (moments.df[which] == count - 1).all()


def test_weighted_observations_have_the_t_distribution_of_their_number(rng):
    """Kolmogorov and Smirnov's test at 0.1 %.

    With degrees of freedom from the weights it fails.
    """
    weights = [1] * 4 + [4, 4, 16]
    moments = Moments.empty((40_000,))
    for weight in weights:
        moments.add(rng.standard_normal(40_000) / np.sqrt(weight), weight=weight)
    t = moments.mean / moments.standard_error
    assert stats.kstest(t, stats.t(len(weights) - 1).cdf).pvalue > 1e-3
    assert stats.kstest(t, stats.t(sum(weights) - 1).cdf).pvalue < 1e-3
