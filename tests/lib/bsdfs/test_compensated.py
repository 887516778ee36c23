# SPDX-License-Identifier: GPL-3.0-or-later
"""Multiple scattering given back.

A white furnace stays white, colours follow the series of bounces, the density stays.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.compensated import Compensated, multiple_scattering
from etalon.lib.bsdfs.microfacet import MicrofacetReflection
from etalon.lib.microfacets import albedo
from etalon.lib.microfacets.ggx import GGX
from etalon.tests.chi2 import Reflections, Tangents, integrals
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import fan, fan_camera, glossy, scene

ANGLES = np.radians([0.0, 35.0, 60.0, 75.0, 85.0])
ALPHAS = (0.1, 0.4, 0.7, 1.0)


@pytest.mark.parametrize("alpha", [0.01, *ALPHAS])
def test_white_furnace_by_quadrature(alpha):
    """Integral of the compensated lobe over the hemisphere: 1, to the albedo's table."""
    for angle in ANGLES:
        wo = np.array([np.sin(angle), 0.0, np.cos(angle)])

        def value(wi, wo=wo):
            lobe = MicrofacetReflection(
                np.repeat(wo[:, None], wi.shape[1], axis=1), alpha, alpha, GGX(), "correlated", "visible"
            )
            factor = multiple_scattering(np.full(wi.shape[1], wo[2]), alpha, np.ones((3, 1)))
            return Compensated(lobe, factor).evaluate(wi)[0][1]

        # The half vector's chart ends where wi meets the horizon: a kink that the quadrature sees as 1e-4.
        total = integrals(value, Reflections(wo, Tangents(alpha, alpha)), (16, 24), tolerance=2e-5).sum()
        assert total == pytest.approx(1.0, abs=3e-4)


def test_white_furnace_rendered(seed):
    materials = [glossy(alpha, distribution="MULTI_GGX") for alpha in ALPHAS]
    images = replicates(
        scene(fan(ANGLES, len(ALPHAS)), materials, fan_camera(ANGLES, len(ALPHAS)), world=1.0), 10, 256, seed=seed
    )
    assert_mean(images, 1.0, 0.004, rounding=1e-5)


def test_coloured_furnace_rendered(seed):
    """The furnace shows the closed form of the series.

    It is E + (1 - E) sum over k of Fss^k+1 Eavg (1 - Eavg)^k, times the colour of the first bounce.
    """
    color = (0.9, 0.5, 0.0)
    materials = [glossy(alpha, *color, distribution="MULTI_GGX") for alpha in ALPHAS]
    images = replicates(
        scene(fan(ANGLES, len(ALPHAS)), materials, fan_camera(ANGLES, len(ALPHAS)), world=1.0), 10, 256, seed=seed
    )
    mu, alpha = (grid.ravel() for grid in np.meshgrid(np.cos(ANGLES), ALPHAS))
    single, average = albedo.directional_albedo(mu, alpha), albedo.average_albedo(alpha)
    fss = np.array(color)[:, None]
    bounces = sum(fss ** (k + 1) * average * (1.0 - average) ** k for k in range(200))
    exact = (fss * (single + (1.0 - single) * bounces)).T.reshape(len(ALPHAS), len(ANGLES), 3)
    assert_mean(images, exact, 0.004, rounding=1e-5)


def test_anisotropic_takes_the_geometric_mean(rng):
    mu = rng.random(50)
    alpha_x, alpha_y = 0.9, 0.1
    factor = multiple_scattering(mu, np.sqrt(alpha_x * alpha_y), np.ones((3, 1)))
    np.testing.assert_allclose(factor, np.tile(1.0 / albedo.directional_albedo(mu, 0.3), (3, 1)), rtol=1e-12)


def test_density_parts_and_arguments(rng):
    wo = np.abs(rng.normal(size=(3, 40)))
    wo /= np.sqrt((wo * wo).sum(axis=0))
    lobe = MicrofacetReflection(wo, 0.3, 0.3, GGX(), "correlated", "visible")
    color = rng.random((3, 40))
    mu, alpha = wo[2].copy(), np.full(40, 0.3)
    for argument in (color, mu, alpha):
        argument.flags.writeable = False
    whole = Compensated(lobe, multiple_scattering(mu, alpha, color))
    u = rng.random((2, 40))
    wi, weight, pdf = whole.sample(*u)
    value, density = whole.evaluate(wi)
    np.testing.assert_allclose(pdf[weight[0] > 0], density[weight[0] > 0], rtol=1e-9)
    np.testing.assert_allclose(value, weight * pdf, rtol=1e-9, atol=1e-12)
    index = np.array([3, 17, 30])
    some = whole.part(index)
    np.testing.assert_array_equal(some.evaluate(wi[:, index])[0], value[:, index])


def test_the_series_of_bounces_grows_with_a_colour_above_one_until_it_has_no_sum():
    """Fss (1 - Eavg) is the ratio of the series of bounces between facets.

    At 1 and above it has no limit.
    """
    alpha = 0.49
    mean, directional = float(albedo.average_albedo(alpha)), float(albedo.directional_albedo(np.array([1.0]), alpha)[0])
    limit = 1.0 / (1.0 - mean)
    color = np.array([[1.4], [0.999 * limit], [1.001 * limit]])
    factor = multiple_scattering(np.array([1.0]), alpha, color)[:, 0]
    bounces = sum(mean * 1.4 * (1.4 * (1.0 - mean)) ** k for k in range(200))
    assert factor[0] == pytest.approx(1.0 + (1.0 / directional - 1.0) * bounces, rel=1e-9)
    assert factor[1] > 100.0 * factor[0]
    assert np.isnan(factor[2])
