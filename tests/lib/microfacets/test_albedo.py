# SPDX-License-Identifier: GPL-3.0-or-later
"""The directional albedo against adaptive quadrature in another chart.

Also its closed forms, and the coarser table of Cycles.
"""

import numpy as np
import pytest
from etalon.lib.microfacets import albedo, masking
from etalon.lib.microfacets.ggx import GGX
from scipy.integrate import quad_vec
from scipy.special import roots_legendre

PLACES = [
    (mu, alpha)
    for alpha in (1e-5, 1e-3, 0.02, 0.11, 0.37, 0.8, 1.0)
    for mu in (1e-6, 0.3 * alpha, min(2.0 * alpha, 0.97), 0.4, 1.0)
]


def by_quadrature(mu, alpha):
    """E over the tangent angle psi, tan(theta_m) = alpha tan(psi), and the azimuth.

    Gauss-Legendre in the former, an adaptive rule in the latter.
    """
    mu, alpha = mu[:, None], alpha[:, None]
    wo = np.stack([np.sqrt((1.0 - mu) * (1.0 + mu)), np.zeros_like(mu), mu])
    node, weight = roots_legendre(300)
    node, weight = 0.5 + 0.5 * node, 0.5 * weight

    def ring(phi):
        forward = wo[0] * np.cos(phi)
        end = np.arctan((forward + np.hypot(forward, mu)) / (mu * alpha))
        tangent = alpha * np.tan(end * node)
        m = np.stack([tangent * np.cos(phi), tangent * np.sin(phi), np.ones_like(tangent)]) / np.hypot(1.0, tangent)
        cos_om = (wo * m).sum(axis=0)
        wi = 2.0 * cos_om * m - wo
        lambda_i, lambda_o = GGX().smith_lambda(wi, alpha, alpha), GGX().smith_lambda(wo, alpha, alpha)
        value = GGX().density(m, alpha, alpha) * masking.height_correlated(lambda_i, lambda_o) * cos_om / mu
        return (value * tangent * m[2] ** 3 * alpha * (1.0 + (tangent / alpha) ** 2) * end * weight).sum(axis=1)

    middle = 0.5 * np.pi
    crowded = [middle + side * width for width in (1e-6, 1e-4, 1e-2, 0.3) for side in (-1.0, 1.0)]
    return 2.0 * quad_vec(ring, 0.0, np.pi, epsabs=1e-7, norm="max", points=[middle, *crowded])[0]


def test_directional_albedo_against_adaptive_quadrature():
    mu, alpha = np.array(PLACES).T
    exact = by_quadrature(mu, alpha)
    np.testing.assert_allclose(albedo.integrate_albedo(mu, alpha), exact, rtol=0.0, atol=2e-6)
    np.testing.assert_allclose(albedo.directional_albedo(mu, alpha), exact, rtol=0.0, atol=1e-5)


def test_between_the_places(rng):
    """The table between its nodes.

    Places are uniform, at small alpha and grazing, and where mu is near alpha.
    """
    alpha = np.concatenate([rng.random(1000), 10.0 ** rng.uniform(-7.0, 0.0, 2000)])
    mu = np.concatenate(
        [rng.random(1000), 10.0 ** rng.uniform(-7.0, 0.0, 1000), alpha[2000:] * 10.0 ** rng.uniform(-2, 2, 1000)]
    )
    mu = np.minimum(mu, 1.0)
    np.testing.assert_allclose(
        albedo.directional_albedo(mu, alpha), albedo.integrate_albedo(mu, alpha, 32, 20), rtol=0.0, atol=1e-5
    )


def test_one_alpha_for_all_or_one_for_each(rng):
    mu = rng.random(100)
    for table in (albedo.directional_albedo, albedo.directional_albedo_cycles):
        np.testing.assert_allclose(table(mu, 0.3), table(mu, np.full(100, 0.3)), rtol=1e-14)


def test_ends():
    """No roughness loses nothing; alpha 1 at normal incidence keeps 1 - ln 2.

    Nothing exceeds 1.
    """
    mu = np.array([0.0, 1e-300, 1e-12, 0.5, 1.0])
    np.testing.assert_allclose(albedo.directional_albedo(mu, 0.0), 1.0, rtol=0.0, atol=1e-7)
    assert albedo.directional_albedo(mu, 1.0)[-1] == pytest.approx(1.0 - np.log(2.0), abs=1e-6)
    assert albedo.directional_albedo(np.linspace(0.0, 1.0, 999), 1e-4).max() <= 1.0
    assert albedo.directional_albedo(mu, np.zeros(5)).shape == (5,)


def test_average_albedo():
    node, weight = np.polynomial.legendre.leggauss(120)
    mu, weight = (0.5 + 0.5 * node) ** 2, weight * (0.5 + 0.5 * node)
    for alpha in (1e-9, 1e-5, 1e-3, 0.0123, 0.2, 0.5, 0.777, 1.0):
        exact = (2.0 * mu * weight * albedo.integrate_albedo(mu, np.full(120, alpha), 32, 20)).sum()
        assert albedo.average_albedo(alpha) == pytest.approx(exact, abs=1e-5)
    assert albedo.average_albedo(0.0) == pytest.approx(1.0, abs=1e-7)


def test_the_table_of_cycles_is_a_coarser_one(rng):
    """The table is exact at its nodes.

    Between them it is within 0.7 % where cosine and roughness are above a cell, 0.02 % in the median.
    """
    node = np.arange(1, 32) / 31.0
    roughness, mu = (grid.ravel() for grid in np.meshgrid(node, node))
    at_nodes = albedo.directional_albedo_cycles(mu, roughness**2)
    np.testing.assert_allclose(at_nodes, albedo.directional_albedo(mu, roughness**2), rtol=0.0, atol=1e-5)
    mu, alpha = rng.uniform(1.0 / 31.0, 1.0, 20_000), rng.uniform(1.0 / 31.0, 1.0, 20_000) ** 2
    exact = albedo.directional_albedo(mu, alpha)
    error = np.abs(albedo.directional_albedo_cycles(mu, alpha) / exact - 1.0)
    assert 1e-3 < error.max() < 1e-2
    assert np.median(error) < 3e-4
    alpha = node**2
    np.testing.assert_allclose(albedo.average_albedo_cycles(alpha), albedo.average_albedo(alpha), rtol=0.0, atol=1e-6)
