# SPDX-License-Identifier: GPL-3.0-or-later
"""Student-t slopes against their definitions by quadrature.

Also their two limits, Phong's, and the fits that papers print.
"""

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.directions import normal_from_tangents
from etalon.lib.microfacets.ggx import GGX
from etalon.lib.microfacets.student_slopes import lambda_by_beta, slope_tables, tail_by_beta
from etalon.lib.microfacets.student_t import StudentT
from etalon.tests.lib.microfacets.published_fits import phong_g1, student_g1
from scipy.stats import t

SHAPES = pytest.mark.parametrize("g", [1.6, 2.0, 2.5, 8.0, 100.0])
COT = np.array([1e-3, 0.05, 0.4, 1.0, 3.0])


def half_line(step=1.0 / 16.0, end=4.5):
    """Nodes and weights of an integral over (0, inf), exp(pi/2 sinh t).

    It is for anything that ends as a power.
    """
    node = np.arange(-end, end + 0.5 * step, step)
    x = np.exp(0.5 * np.pi * np.sinh(node))
    return x, x * 0.5 * np.pi * np.cosh(node) * step


def directions(cot):
    sine = 1.0 / np.sqrt(1.0 + cot * cot)
    return np.stack([sine, np.zeros_like(cot), cot * sine])


def slopes(distribution, x, y):
    """The density of slopes at roughness 1, D cos^4, (n,)."""
    m = normal_from_tangents(x, y)
    return distribution.density(m, 1.0, 1.0) * m[2] ** 4


@SHAPES
@pytest.mark.parametrize("alphas", [(0.3, 0.3), (0.01, 0.7)])
def test_d_cos_integrates_to_one(g, alphas):
    r, weight = half_line()
    phi = 2.0 * np.pi * (np.arange(8) + 0.5) / 8
    rr, pp = (grid.ravel() for grid in np.meshgrid(r, phi, indexing="ij"))
    m = normal_from_tangents(alphas[0] * rr * np.cos(pp), alphas[1] * rr * np.sin(pp))
    integrand = StudentT(g).density(m, *alphas) * m[2] ** 4 * (alphas[0] * alphas[1] * rr * 2.0 * np.pi / 8)
    assert (integrand.reshape(r.size, 8).sum(axis=1) * weight).sum() == pytest.approx(1.0, abs=1e-10)


@pytest.mark.parametrize("g", [1.8, 2.0, 2.5, 8.0, 100.0])
def test_lambda_is_smiths_integral_over_the_slopes(g):
    """Lambda(a) = 1/a times the integral of (x - a) over all slopes x > a.

    See Smith 1967; Heitz 2014, eq. 61.
    """
    x, weight_x = half_line()
    y, weight_y = half_line()
    for cot, value in zip(COT, StudentT(g).smith_lambda(directions(COT), 1.0, 1.0), strict=True):
        along = np.repeat(cot + x, y.size)
        across = np.tile(y, x.size) * (1.0 + along)
        marginal = 2.0 * (1.0 + cot + x) * (slopes(StudentT(g), along, across).reshape(x.size, y.size) @ weight_y)
        expected = (x * marginal * weight_x).sum() / cot
        assert abs(value - expected) <= 1e-10 * (1.0 + expected)


@pytest.mark.parametrize("g", [1.51, 1.6, 2.5, 30.0, 1e4])
def test_tables_hold_what_the_incomplete_beta_function_gives(g, rng):
    a = 10.0 ** rng.uniform(-5.0, 5.0, 5000)
    exact = lambda_by_beta(a, g)
    assert (np.abs(slope_tables(g).masking(np.ones_like(a), a) - exact) / (1.0 + exact)).max() < 1e-11
    w = directions(a)
    by_beta = StudentT(g).smith_lambda_by_beta(w, 0.4, 0.4)
    np.testing.assert_allclose(StudentT(g).smith_lambda(w, 0.4, 0.4) + 1.0, by_beta + 1.0, rtol=1e-11)


@pytest.mark.parametrize("g", [2.0, 2.5, 30.0, 1e4])
def test_the_inversion_ends_where_its_uniform_says(g, rng):
    """Of the slopes visible under a, 1 - u lie above the one that u gives."""
    a, u = 10.0 ** rng.uniform(-4.0, 3.0, 5000), rng.random(5000)
    found = slope_tables(g).visible_tangent(np.ones_like(a), a, u, lambda_by_beta(a, g))
    density = t.pdf(found * np.sqrt(2.0), 2.0 * g - 2.0) * np.sqrt(2.0)
    first = (g - 1.0 + found * found) * density / (2.0 * g - 3.0)
    above = (a * tail_by_beta(found, g) + first) / (a * (1.0 + lambda_by_beta(a, g)))
    np.testing.assert_allclose(1.0 - above, u, atol=2e-8)


def test_the_shape_2_is_ggx(rng):
    m, u = directions(10.0 ** rng.uniform(-3.0, 2.0, 500)), rng.random((2, 500))
    np.testing.assert_allclose(StudentT(2.0).density(m, 0.3, 0.1), GGX().density(m, 0.3, 0.1), rtol=1e-13)
    np.testing.assert_allclose(
        1.0 + StudentT(2.0).smith_lambda(m, 0.3, 0.1), 1.0 + GGX().smith_lambda(m, 0.3, 0.1), rtol=1e-11
    )
    np.testing.assert_allclose(StudentT(2.0).sample_d_cos(0.3, 0.1, *u), GGX().sample_d_cos(0.3, 0.1, *u), rtol=1e-11)


def test_large_shapes_approach_beckmann_as_one_over_g(rng):
    m = directions(10.0 ** rng.uniform(-1.0, 1.0, 200))

    def distance(g):
        density = np.abs(StudentT(g).density(m, 0.5, 0.5) - Beckmann().density(m, 0.5, 0.5)).max()
        return density, np.abs(StudentT(g).smith_lambda(m, 0.5, 0.5) - Beckmann().smith_lambda(m, 0.5, 0.5)).max()

    for near, far in zip(distance(5e3), distance(5e2), strict=True):
        assert far / near == pytest.approx(10.0, rel=0.02)


@pytest.mark.parametrize("n", [1.0, 10.0, 798.0])
def test_phongs_power_of_the_cosine_is_one_of_them(n, rng):
    """D = (n + 2) / (2 pi) cos^n is g = n/2 + 2 with alpha^2 = 2 / (n + 2)."""
    m, alpha = directions(10.0 ** rng.uniform(-1.0, 2.0, 300)), np.sqrt(2.0 / (n + 2.0))
    expected = (n + 2.0) / (2.0 * np.pi) * m[2] ** n
    np.testing.assert_allclose(StudentT(0.5 * n + 2.0).density(m, alpha, alpha), expected, rtol=1e-11, atol=1e-300)


def test_the_printed_fit_for_student_t_is_off_by_up_to_seven_thousandths():
    """Ribardiere et al. 2017 print a fit where this file has an incomplete beta function."""
    a = np.geomspace(1e-3, 100.0, 2000)
    errors = {g: np.abs((1.0 + lambda_by_beta(a, g)) * student_g1(a, g) - 1.0).max() for g in (1.6, 2.0, 3.0, 40.0)}
    expected = {1.6: 0.0027, 2.0: 0.0070, 3.0: 0.0051, 40.0: 0.0051}
    assert errors == pytest.approx(expected, abs=6e-5)


def test_walters_fit_for_phong_is_off_by_a_third():
    """At n = 1: 32 % at 85 degrees, 38 % at grazing.

    It is Beckmann's, and right for large n alone.
    """
    cot = 1.0 / np.tan(np.radians([85.0, 89.99]))
    found = {}
    for n in (1.0, 100.0):
        exact = lambda_by_beta(cot / np.sqrt(2.0 / (n + 2.0)), 0.5 * n + 2.0)
        found[n] = (1.0 + exact) * phong_g1(cot, n) - 1.0
    np.testing.assert_allclose(found[1.0], [0.321, 0.378], atol=2e-3)
    assert np.abs(found[100.0]).max() < 0.01


@pytest.mark.parametrize("g", [1.5, 1.0, -2.0, float("nan"), float("inf"), 2e4])
def test_a_shape_out_of_range_is_refused_with_what_to_do(g):
    with pytest.raises(EtalonError, match=r"is out of range; give more than 1\.5 and at most 10000"):
        StudentT(g)
