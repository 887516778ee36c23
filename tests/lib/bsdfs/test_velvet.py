# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin's velvet: the density of its normals, reciprocity, and what it reflects.

Also weights against values.
"""

import numpy as np
import pytest
from etalon.lib.bsdfs.velvet import Velvet, inverted_gaussian
from etalon.tests.chi2 import Sphere, chi_square, integrals
from scipy.integrate import quad

COUNT = 100_000
SIGMAS = (0.05, 0.3, 1.0)


def viewer(cos_o, count):
    sine = np.sqrt(1.0 - cos_o**2)
    return np.repeat(np.array([[0.6 * sine], [0.8 * sine], [cos_o]]), count, axis=1)


@pytest.mark.parametrize("sigma", SIGMAS)
def test_projected_normals_integrate_to_one(sigma):
    def ring(theta):
        m = np.array([[np.sin(theta)], [0.0], [np.cos(theta)]])
        return 2.0 * np.pi * np.sin(theta) * np.cos(theta) * inverted_gaussian(m, sigma)[0]

    assert quad(ring, 0.0, 0.5 * np.pi, points=[0.5 * np.pi - sigma], epsrel=1e-10)[0] == pytest.approx(1.0, rel=1e-8)


def test_no_normal_points_along_the_surfaces_own():
    assert not inverted_gaussian(np.array([[0.0], [0.0], [1.0]]), 1.0).any()


@pytest.mark.parametrize("sigma", SIGMAS)
def test_light_and_viewer_of_velvet_may_change_places(sigma, rng):
    directions = rng.normal(size=(2, 3, 2000))
    wo, wi = directions / np.sqrt((directions**2).sum(axis=1, keepdims=True))
    wo[2], wi[2] = np.abs(wo[2]), np.abs(wi[2])
    there = Velvet(wo, np.float64(sigma)).evaluate(wi)[0] / wi[2]
    back = Velvet(wi, np.float64(sigma)).evaluate(wo)[0] / wo[2]
    np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-300)


@pytest.mark.parametrize("sigma", SIGMAS)
@pytest.mark.parametrize("cosine", [0.05, 0.4, 0.95])
def test_velvet_reflects_no_more_than_it_gets_and_its_samples_find_it(sigma, cosine, rng):
    """The mean weight of the samples is the quadrature of the value, at five standard errors."""

    def value(directions):
        return Velvet(viewer(cosine, directions.shape[1]), np.float64(sigma)).evaluate(directions)[0][0]

    albedo = integrals(value, Sphere(), (16, 16), tolerance=1e-5).sum()
    assert albedo < 1.0
    lobe = Velvet(viewer(cosine, COUNT), np.float64(sigma))
    wi, weight, pdf = lobe.sample(*rng.random((2, COUNT)))
    assert weight[0].mean() == pytest.approx(albedo, abs=5.0 * weight[0].std() / np.sqrt(COUNT) + 1e-5)
    np.testing.assert_allclose(weight * pdf, lobe.evaluate(wi)[0], rtol=1e-12)


def test_velvet_is_sampled_by_its_density(rng):
    wi, _, _ = Velvet(viewer(0.4, COUNT), np.float64(0.5)).sample(*rng.random((2, COUNT)))
    density = lambda w: Velvet(viewer(0.4, w.shape[1]), np.float64(0.5)).evaluate(w)[1]  # noqa: E731
    assert chi_square(wi, density, Sphere(), (12, 16), tolerance=1e-5).p_value > 1e-3
