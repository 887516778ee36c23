# SPDX-License-Identifier: GPL-3.0-or-later
"""The heuristics: their own formula in exact arithmetic.

Two strategies share each contribution.
"""

from fractions import Fraction

import numpy as np
import pytest
from etalon.lib.sampling.mis import CUTOFF, cutoff_power_heuristic, power_heuristic
from scipy import stats


def test_exact(rng):
    p, q = np.exp(rng.uniform(-30.0, 30.0, (2, 200)))
    exact = [float(Fraction(a) ** 2 / (Fraction(a) ** 2 + Fraction(b) ** 2)) for a, b in zip(p, q, strict=True)]
    np.testing.assert_allclose(power_heuristic(p, q), exact, rtol=1e-15)


BOTH = pytest.mark.parametrize("heuristic", [power_heuristic, cutoff_power_heuristic])


@BOTH
@pytest.mark.parametrize("range_", [2.0, 300.0])
def test_both_weights_sum_to_one(heuristic, range_, rng):
    p, q = np.exp(rng.uniform(-range_, range_, (2, 5000)))
    np.testing.assert_allclose(heuristic(p, q) + heuristic(q, p), 1.0, rtol=1e-15)


def test_the_cutoff(rng):
    """The power heuristic's weight while neither density is below a fifth of the other.

    Else all goes to the larger.
    """
    p, q = np.exp(rng.uniform(-4.0, 4.0, (2, 5000)))
    expected = np.where(p < CUTOFF * q, 0.0, np.where(q < CUTOFF * p, 1.0, power_heuristic(p, q)))
    assert {0.0, 1.0} < set(expected)
    np.testing.assert_array_equal(cutoff_power_heuristic(p, q), expected)


@BOTH
@pytest.mark.parametrize(
    ("p", "q", "weight"),
    [
        (1e300, 1e300, 0.5),
        (1e-300, 1e-300, 0.5),
        (1e300, 1.0, 1.0),
        (1.0, 1e300, 0.0),
        (1e-300, 1e300, 0.0),
        (np.inf, 1e300, 1.0),
        (3.0, 0.0, 1.0),
    ],
)
def test_ends(p, q, weight, heuristic):
    """Near-specular densities squared overflow; a delta has density infinity.

    A strategy may be impossible.
    """
    assert heuristic(np.array([p]), np.array([q]))[0] == weight


@BOTH
def test_two_strategies_of_one_integral(heuristic, rng):
    """Integral of 3 x^2 over (0, 1) from uniform and linear densities, weighted: unbiased."""
    u, v = rng.random((2, 200_000))
    v = np.sqrt(v)
    first = 3.0 * u**2 * heuristic(np.ones_like(u), 2.0 * u)
    second = 3.0 * v**2 / (2.0 * v) * heuristic(2.0 * v, np.ones_like(v))
    total = first + second
    assert abs(total.mean() - 1.0) < stats.norm.isf(0.5e-4) * stats.sem(total)
    assert stats.sem(total) < 2e-3
