# SPDX-License-Identifier: GPL-3.0-or-later
"""p-values and intervals of one look, against scipy.stats.

Also the answers that bad input must have.
"""

import numpy as np
import pytest
from etalon.lib.film.moments import Moments
from etalon.lib.verdict.claims import combine, difference, interval, p_different, p_equivalent, tolerance_ends
from scipy import stats
from scipy.optimize import brentq


def of(rows):
    mean = rows.mean(axis=0)
    return Moments(len(rows), mean, ((rows - mean) ** 2).sum(axis=0))


def constant(value, n=8):
    return Moments(n, np.full((1, 3), value), np.zeros((1, 3)))


@pytest.fixture
def sides(rng):
    return 1.02 + 0.05 * rng.standard_normal((9, 4, 3)), 1.0 + 0.02 * rng.standard_normal((14, 4, 3))


@pytest.mark.parametrize("factor", [1.0, 1.01, 0.9])
def test_a_combination_is_welchs(sides, factor):
    candidate, reference = sides
    c = combine(of(candidate), of(reference), factor)
    found = stats.t.cdf(c.value / c.error, c.df)
    asked = stats.ttest_ind(candidate, factor * reference, axis=0, equal_var=False, alternative="less").pvalue
    np.testing.assert_allclose(found, asked, rtol=1e-9)


def test_claims_are_two_one_sided_welch_tests(sides):
    candidate, reference = sides
    tolerance = 0.05
    ends = tolerance_ends(of(candidate), of(reference), tolerance, 1e-3)

    def welch(factor, side):
        return stats.ttest_ind(candidate, factor * reference, axis=0, equal_var=False, alternative=side).pvalue

    inside = np.maximum(welch(1 + tolerance, "less"), welch(1 - tolerance, "greater")).max(axis=1)
    outside = np.minimum(welch(1 + tolerance, "greater"), welch(1 - tolerance, "less")).min(axis=1)
    np.testing.assert_allclose(p_equivalent(*ends), inside, rtol=1e-9)
    np.testing.assert_allclose(p_different(*ends), np.minimum(6 * outside, 1), rtol=1e-9)


def test_below_the_floor_the_tolerance_is_absolute(rng):
    rows = 1e-4 + 1e-6 * rng.standard_normal((10, 1, 3))
    upper, lower = tolerance_ends(of(rows + 1e-3), of(rows), 0.01, 0.5)
    np.testing.assert_allclose(upper.value, 1e-3 - 0.005, rtol=1e-9)
    np.testing.assert_allclose(lower.value, 1e-3 + 0.005, rtol=1e-9)


def test_a_negative_reference_has_its_tolerance_the_right_way_round():
    upper, lower = tolerance_ends(constant(-1.0), constant(-1.0), 0.1, 1e-3)
    np.testing.assert_allclose(upper.value, -0.1)
    np.testing.assert_allclose(lower.value, 0.1)


def test_the_interval_is_fiellers(sides):
    candidate, reference = of(sides[0]), of(sides[1])
    low, high = interval(candidate, reference, 1e-3, 0.005)
    plain = combine(candidate, reference, 1.0)
    q = stats.t.isf(0.005, plain.df)

    def beyond(rho, k):
        gap = candidate.mean.flat[k] - rho * reference.mean.flat[k]
        noise = candidate.variance.flat[k] / candidate.n + rho**2 * reference.variance.flat[k] / reference.n
        return gap**2 - q.flat[k] ** 2 * noise

    for k in range(low.size):
        middle = candidate.mean.flat[k] / reference.mean.flat[k]
        assert brentq(beyond, middle - 1, middle, args=(k,), xtol=1e-13) - 1 == pytest.approx(low.flat[k], abs=1e-9)
        assert brentq(beyond, middle, middle + 1, args=(k,), xtol=1e-13) - 1 == pytest.approx(high.flat[k], abs=1e-9)


def test_the_interval_covers_as_often_as_it_says(rng):
    runs, tail = 4000, 0.05
    candidate, reference = (m + 0.2 * rng.standard_normal((10, runs, 3)) for m in (1.1, 1.0))
    low, high = interval(of(candidate), of(reference), 1e-3, tail)
    outside = int(((low > 0.1) | (high < 0.1)).sum())
    assert stats.binom.ppf(1e-4, 3 * runs, 2 * tail) <= outside <= stats.binom.ppf(1 - 1e-4, 3 * runs, 2 * tail)


def test_an_interval_about_nothing_has_no_ends(rng):
    rows = rng.standard_normal((6, 1, 3))
    low, high = interval(of(1.0 + rows), of(rows), 1e-9, 0.001)
    assert np.isneginf(low).all()
    assert np.isposinf(high).all()


@pytest.mark.parametrize(
    ("candidate", "inside", "outside"),
    [(1.0, 0.0, 1.0), (1.005, 0.0, 1.0), (1.02, 1.0, 0.0), (0.98, 1.0, 0.0)],
)
def test_without_noise_the_claims_are_certain(candidate, inside, outside):
    ends = tolerance_ends(constant(candidate), constant(1.0), 0.01, 1e-3)
    assert p_equivalent(*ends) == inside
    assert p_different(*ends) == outside
    low, high = interval(constant(candidate), constant(1.0), 1e-3, 0.01)
    np.testing.assert_allclose([low, high], candidate - 1, atol=1e-12)


def test_black_on_both_sides_is_the_same_black():
    ends = tolerance_ends(constant(0.0), constant(0.0), 0.01, 0.0)
    assert p_equivalent(*ends) == 0
    assert p_different(*ends) == 1
    assert (difference(constant(0.0), constant(0.0), 0.0) == 0).all()
    assert (np.stack(interval(constant(0.0), constant(0.0), 0.0, 0.01)) == 0).all()


def test_light_where_the_reference_is_black_differs_without_end():
    ends = tolerance_ends(constant(0.1), constant(0.0), 0.01, 0.0)
    assert p_different(*ends) == 0
    assert np.isposinf(difference(constant(0.1), constant(0.0), 0.0)).all()


@pytest.mark.parametrize("one", [0, 1])
def test_one_replicate_on_either_side_claims_nothing(one):
    pair = [constant(1.0), constant(5.0)]
    pair[one] = constant(pair[one].mean[0, 0], n=1)
    ends = tolerance_ends(*pair, 0.01, 1e-3)
    assert p_equivalent(*ends) == 1
    assert p_different(*ends) == 1
    assert np.isnan(np.stack(interval(*pair, 1e-3, 0.01))).all()


def test_a_region_with_no_pixel_left_claims_nothing():
    ends = tolerance_ends(constant(np.nan), constant(1.0), 0.01, 1e-3)
    assert p_equivalent(*ends) == 1
    assert p_different(*ends) == 1
    assert np.isnan(difference(constant(np.nan), constant(1.0), 1e-3)).all()
