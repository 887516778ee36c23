# SPDX-License-Identifier: GPL-3.0-or-later
"""Intervals hold the truth as often as they say."""

from dataclasses import replace

import numpy as np
from etalon.lib.fit.candidates import Candidate
from etalon.lib.fit.intervals import CONFIDENCE
from etalon.lib.fit.solve import Lobes, solve_linear
from etalon.tests.lib.fit.planted import planted
from scipy.stats import binomtest, chi2

LEVEL = 1e-4


def test_chi2_rises_to_the_truth_as_stated_where_errors_come_from_eight_replicates(rng):
    """Both linear parameters are free, so that the rise has two degrees of freedom."""
    model, shape = Candidate("ggx", "correlated", "none", False), np.log([0.3])
    exact = planted(rng, model, 0.3, noise=1e-9, count=400, colors=1)
    error, degrees, tries = 0.01 * exact.values, 7, 1500
    lobes, inside = Lobes(model, exact), 0
    for _ in range(tries):
        values = exact.values + error * rng.standard_normal(error.shape)
        variances = np.square(error) * rng.chisquare(degrees, error.shape) / degrees
        seen = replace(exact, values=values, variances=variances, noise=0.0, degrees=float(degrees))
        predicted = solve_linear(model, seen, shape, lobes)[1]
        truth, least = (float(np.square((values - one) / seen.deviations).sum()) for one in (exact.values, predicted))
        inside += truth - least <= chi2.ppf(CONFIDENCE, 2) * seen.rise
    assert binomtest(inside, tries, CONFIDENCE).pvalue > LEVEL
