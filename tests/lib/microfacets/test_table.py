# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts that hold for every distribution in the table, whatever its formulas.

A new row is tested as it stands.
"""

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.microfacets import densities
from etalon.lib.microfacets.distribution import BoundedDistribution
from etalon.lib.microfacets.distributions import DISTRIBUTIONS, distribution_by_name
from etalon.lib.microfacets.masking import HIDDEN
from etalon.lib.microfacets.scale_mixture import ExponentialPower, ShiftedGamma
from etalon.lib.microfacets.student_t import StudentT
from etalon.tests.chi2 import Tangents, chi_square, integrals, sidak

MIXTURES = {"shifted gamma": ShiftedGamma(0.8, 0.01), "exponential power": ExponentialPower(0.5)}
WITH_SHAPES = DISTRIBUTIONS | {f"student-t {g:g}": StudentT(g) for g in (1.8, 2.5, 30.0)} | MIXTURES
EVERY = pytest.mark.parametrize("distribution", WITH_SHAPES.values(), ids=WITH_SHAPES)
ALPHAS = pytest.mark.parametrize("alphas", [(0.1, 0.1), (0.7, 0.2)])
ANGLES = pytest.mark.parametrize("degrees", [20.0, 75.0])
COUNT = 50_000
LEVEL = sidak(1e-3, 2 * 2 * 3 * len(WITH_SHAPES))


def viewer(degrees, count):
    theta = np.radians(degrees)
    return np.repeat(np.array([[np.sin(theta) * 0.6], [np.sin(theta) * 0.8], [np.cos(theta)]]), count, axis=1)


def visible(distribution, alphas, degrees, m):
    wo = viewer(degrees, m.shape[1])
    return densities.pdf_visible(m, wo, distribution.density(m, *alphas), distribution.smith_lambda(wo, *alphas))


@EVERY
@ALPHAS
def test_projected_facets_cover_the_surface(distribution, alphas):
    """The integral of D cos over the hemisphere is 1."""
    total = integrals(lambda m: densities.pdf_d_cos(m, distribution.density(m, *alphas)), Tangents(*alphas), (16, 24))
    assert total.sum() == pytest.approx(1.0, abs=1e-4)


@EVERY
@ALPHAS
@ANGLES
def test_lambda_is_smiths_integral(distribution, alphas, degrees):
    """Visible normals integrate to 1 for every view.

    That defines Smith's Lambda (Heitz 2014, eq. 18).
    """
    total = integrals(lambda m: visible(distribution, alphas, degrees, m), Tangents(*alphas), (16, 24))
    assert total.sum() == pytest.approx(1.0, abs=3e-4)


@EVERY
@ALPHAS
def test_normals_follow_d_cos(distribution, alphas, rng):
    m = distribution.sample_d_cos(*alphas, *rng.random((2, COUNT)))
    found = chi_square(m, lambda m: densities.pdf_d_cos(m, distribution.density(m, *alphas)), Tangents(*alphas))
    assert found.p_value > LEVEL


@pytest.mark.grid(3)
@EVERY
@ALPHAS
@ANGLES
def test_visible_normals_follow_their_density(distribution, alphas, degrees, rng):
    """With Lambda given and without it: the same normals, with the density of visible ones."""
    wo, u = viewer(degrees, COUNT), rng.random((2, COUNT))
    m = distribution.sample_visible(wo, *alphas, *u)
    np.testing.assert_array_equal(
        m, distribution.sample_visible(wo, *alphas, *u, distribution.smith_lambda(wo, *alphas))
    )
    found = chi_square(m, lambda m: visible(distribution, alphas, degrees, m), Tangents(*alphas))
    assert found.p_value > LEVEL


@EVERY
@ALPHAS
def test_the_density_of_a_longer_vector_falls_as_its_fourth_power(distribution, alphas, rng):
    m = distribution.sample_d_cos(*alphas, *rng.random((2, 100)))
    np.testing.assert_allclose(
        distribution.density(3.0 * m, *alphas), distribution.density(m, *alphas) / 81.0, rtol=1e-11
    )


@EVERY
def test_nothing_lies_below_the_horizon(distribution):
    below = np.array([[0.6, 1.0], [0.0, 0.0], [-0.8, 0.0]])
    assert not distribution.density(below, 0.3, 0.3).any()
    assert (distribution.smith_lambda(below, 0.3, 0.3) == HIDDEN).all()


@EVERY
def test_rows_are_values(distribution):
    """Frozen and comparable, so that tables can be kept for each."""
    assert hash(distribution) == hash(type(distribution)(**vars(distribution)))
    with pytest.raises(AttributeError):
        distribution.alpha = 1.0


def test_distributions_are_found_by_the_names_of_blender():
    assert isinstance(distribution_by_name("GGX"), BoundedDistribution)
    assert distribution_by_name("MULTI_GGX") == distribution_by_name("GGX") != distribution_by_name("BECKMANN")


def test_an_unknown_distribution_is_refused_by_name():
    with pytest.raises(EtalonError, match="'PHONG'; choose one of BECKMANN, GGX, MULTI_GGX"):
        distribution_by_name("PHONG")
