# SPDX-License-Identifier: GPL-3.0-or-later
"""The forecast of what deciding costs, against what it then did cost."""

import numpy as np
import pytest
from etalon.lib.film.moments import Moments
from etalon.lib.verdict.forecast import COVERAGE, forecast, forecast_bound, passing_probability, spread_of_differences
from etalon.lib.verdict.sequential import SequentialTest
from etalon.tests.lib.verdict.simulated import decided, gaussian, rows_of
from scipy import stats

ASKED_AT = 18


@pytest.mark.parametrize("runs", [3, pytest.param(60, marks=pytest.mark.slow)])
@pytest.mark.parametrize("spread", [0.0, 0.002])
def test_the_true_cost_is_inside_the_interval_as_often_as_it_says(rng, runs, spread):
    """Regions of very different noise, in truth `spread` apart.

    A run that is not decided at the end lies above every finite interval.
    """
    count, inside = 20, []
    for _ in range(runs):
        truth = 1.0 + spread * np.clip(rng.standard_normal(count), -3, 3)
        sigma = np.exp(rng.normal(-4.3, 0.7, (count, 1)))
        asked = []

        def look(test, n, reference, candidate, asked=asked):
            if n == ASKED_AT and test.undecided.any():
                asked.append(forecast_bound(test, reference, candidate, test.tolerance))

        test = decided(rng, truth, gaussian, sigma, last=30_000, look=look)
        if asked:
            needed = np.inf if test.undecided.any() else test.looks[-1].replicates[1] / ASKED_AT
            inside.append(asked[0].low <= needed <= asked[0].high)
    assert len(inside) > runs // 2
    assert sum(inside) >= stats.binom.ppf(1e-3, len(inside), COVERAGE)


def test_passing_probability_is_what_happens(rng):
    """Draw the truth from the prior given the estimate, then new data about it."""
    runs, growth, share, error = 400_000, 3.0, 0.6, 1.0
    gap, distance, q = 1.2, 2.0, 2.5  # in standard errors: the estimate, and the way from it to the end
    truth = rng.normal(share * gap, np.sqrt(share) * error, runs)
    fresh = rng.normal(truth, error / np.sqrt(growth - 1))
    pooled = (gap + (growth - 1) * fresh) / growth
    z = (pooled + distance) * np.sqrt(growth)
    expected = float((z >= q).mean())
    found = passing_probability(np.array(gap + distance), np.array(gap), np.array(share), q, growth)
    assert float(found) == pytest.approx(expected, abs=5 * np.sqrt(expected * (1 - expected) / runs))


def test_the_spread_of_differences_is_estimated(rng):
    error = np.exp(rng.normal(-5, 0.5, 4000))
    gap = rng.normal(0, 0.01, 4000) + error * rng.standard_normal(4000)
    assert spread_of_differences(gap, error, 1e-6) == pytest.approx(1e-4, rel=0.1)
    noise = error * rng.standard_normal(4000)
    assert spread_of_differences(noise, error, 1e-3) < 2e-6
    assert spread_of_differences(np.array([np.nan]), np.array([np.nan]), 1e-3) == 1e-6


def test_nothing_to_forecast():
    test = SequentialTest(1, 0.01, 0.99)
    one = Moments(1, np.ones((1, 3)), np.zeros((1, 3)))
    assert forecast(test, one, one) is None
    sure = Moments(8, np.ones((1, 3)), np.zeros((1, 3)))
    test.look(sure, sure, last=True)
    assert forecast(test, sure, sure) is None


def test_ends_are_in_order_and_beyond_what_is_there(rng):
    test = SequentialTest(5, 0.01, 0.99)
    sides = [rows_of(1 + 0.05 * gaussian(rng, 8, 5)) for _ in range(2)]
    test.look(*sides, last=True)
    found = forecast(test, *sides)
    assert 1 < found.low <= found.factor <= found.high
    assert found.regions == int(test.undecided.sum())
