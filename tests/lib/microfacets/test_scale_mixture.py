# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures of Beckmann's distributions against quadrature and 50 digits.

Tested are closed forms, Smith's Lambda and the mixtures themselves.
"""

import mpmath as mp
import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.directions import normal_from_tangents
from etalon.lib.microfacets.scale_mixture import ExponentialPower, ShiftedGamma

EVERY = pytest.mark.parametrize(
    "distribution",
    [
        ShiftedGamma(0.3, 0.1),
        ShiftedGamma(0.8, 1e-3),
        ShiftedGamma(1.5, 0.05),
        *map(ExponentialPower, (0.3, 0.5, 0.75)),
    ],
    ids=str,
)


def half_line(step=1.0 / 24.0, end=3.6):
    """Nodes and weights of an integral over (0, inf): exp(pi/2 sinh t)."""
    node = np.arange(-end, end + 0.5 * step, step)
    x = np.exp(0.5 * np.pi * np.sinh(node))
    return x, x * 0.5 * np.pi * np.cosh(node) * step


def slopes(distribution, x, y):
    """The density of slopes at roughness 1, D cos^4, (n,)."""
    m = normal_from_tangents(x, y)
    return distribution.density(m, 1.0, 1.0) * m[2] ** 4


@EVERY
def test_d_cos_integrates_to_one(distribution):
    r, weight = half_line()
    total = 2.0 * np.pi * (slopes(distribution, r, np.zeros_like(r)) * r * weight).sum()
    assert total == pytest.approx(1.0, abs=1e-10)


@EVERY
@pytest.mark.parametrize("cot", [0.05, 0.5, 1.5])
def test_lambda_is_smiths_integral_over_the_slopes(distribution, cot):
    """Lambda(a) = 1/a times the integral of (x - a) over all slopes x > a.

    See Smith 1967; Heitz 2014, eq. 61.
    """
    x, weight_x = half_line()
    y, weight_y = half_line()
    along, across = np.repeat(cot + x, y.size), np.tile(y, x.size)
    marginal = 2.0 * slopes(distribution, along, across).reshape(x.size, y.size) @ weight_y
    expected = (x * marginal * weight_x).sum() / cot
    sine = 1.0 / np.sqrt(1.0 + cot * cot)
    found = distribution.smith_lambda(np.array([[sine], [0.0], [cot * sine]]), 1.0, 1.0)
    assert abs(found[0] - expected) <= 1e-10 * (1.0 + expected)


@EVERY
def test_the_mixture_has_the_moments_of_its_closed_form(distribution):
    """The mean squared slope, and the mean inverse slope.

    The largest scales determine the former, the smallest the latter.
    """
    r, weight = half_line()
    density = 2.0 * np.pi * slopes(distribution, r, np.zeros_like(r)) * r * weight
    parts = distribution.components
    assert parts.shares.sum() == pytest.approx(1.0, abs=1e-13)
    assert (parts.shares * parts.scales**2).sum() == pytest.approx((density * r * r).sum(), rel=1e-9)
    assert (parts.shares / parts.scales).sum() * np.sqrt(np.pi) == pytest.approx((density / r).sum(), rel=1e-6)


def test_the_factor_of_the_shifted_gamma_distribution_is_an_incomplete_gamma_function():
    for p, shift in ((0.3, 0.1), (1.0, 0.02), (1.7, 1e-3)):
        with mp.workdps(30):
            q = mp.mpf(shift) + mp.mpf("0.7")
            exact = mp.exp(-q) * q ** -mp.mpf(p) / (mp.pi * mp.gammainc(1 - mp.mpf(p), shift))
        assert ShiftedGamma(p, shift).slopes(np.array([0.7]))[0] == pytest.approx(float(exact), rel=1e-13)


def test_bagher_writes_it_with_one_roughness(rng):
    """D = exp(-x) / (pi Gamma(1 - p, a) a x^p cos^4), x = a + tan^2 / a.

    This is up to his own factor: shift a, alpha sqrt(a).
    """
    a, p = 0.04, 0.6
    m = normal_from_tangents(rng.normal(size=50) * 0.3, rng.normal(size=50) * 0.3)
    x = a + (m[0] ** 2 + m[1] ** 2) / m[2] ** 2 / a
    gamma = float(mp.gammainc(1 - p, a))
    expected = np.exp(-x) / (np.pi * gamma * a * x**p * m[2] ** 4)
    np.testing.assert_allclose(ShiftedGamma(p, a).density(m, np.sqrt(a), np.sqrt(a)), expected, rtol=1e-12)


def test_without_the_power_the_shifted_gamma_distribution_is_beckmanns(rng):
    m, u = normal_from_tangents(*rng.normal(size=(2, 200))), rng.random((2, 200))
    plain = ShiftedGamma(0.0, 0.3)
    np.testing.assert_allclose(plain.density(m, 0.4, 0.2), Beckmann().density(m, 0.4, 0.2), rtol=1e-12)
    np.testing.assert_allclose(
        1.0 + plain.smith_lambda(m, 0.4, 0.2), 1.0 + Beckmann().smith_lambda(m, 0.4, 0.2), rtol=1e-10
    )
    np.testing.assert_allclose(plain.sample_d_cos(0.4, 0.2, *u), Beckmann().sample_d_cos(0.4, 0.2, *u), rtol=1e-12)


@pytest.mark.parametrize(
    "make", [lambda: ShiftedGamma(-0.1, 0.3), lambda: ShiftedGamma(0.5, 0.0), lambda: ExponentialPower(1.0)]
)
def test_parameters_out_of_range_are_refused_with_what_to_do(make):
    with pytest.raises(EtalonError, match="is out of range; give at least"):
        make()


def test_nan_is_out_of_range():
    with pytest.raises(EtalonError, match="out of range"):
        ExponentialPower(float("nan"))
