# SPDX-License-Identifier: GPL-3.0-or-later
"""Henyey and Greenstein's phase function: its integral, its mean cosine, and its sampler."""

import mpmath
import numpy as np
import pytest
from etalon.lib.scattering.henyey_greenstein import evaluate, sample
from etalon.tests.chi2 import Sphere, chi_square, sidak
from numpy.polynomial.legendre import leggauss

ANISOTROPIES = [-0.9, -0.3, 0.0, 1e-9, 0.5, 0.8]
ALONG = np.array([0.48, -0.6, 0.64])


@pytest.mark.parametrize("g", ANISOTROPIES)
def test_the_density_integrates_to_one_and_its_mean_cosine_is_g(g):
    node, weight = leggauss(400)  # near the ends, the nodes are known to 1e-16, which a density of 15 multiplies
    density = 2.0 * np.pi * evaluate(node, np.float64(g))
    assert weight @ density == pytest.approx(1.0, abs=2e-11)
    assert weight @ (density * node) == pytest.approx(g, abs=2e-11)


@pytest.mark.parametrize("g", [0.99, -0.99, 1e-12])
@pytest.mark.parametrize("cosine", [-1.0, -0.999999, 0.3, 0.99999999, 1.0])
def test_the_density_keeps_its_digits(g, cosine):
    with mpmath.workdps(50):
        exact_g, exact_cosine = mpmath.mpf(g), mpmath.mpf(cosine)
        base = 1 + exact_g**2 - 2 * exact_g * exact_cosine
        exact = (1 - exact_g**2) / (4 * mpmath.pi * base ** mpmath.mpf(1.5))
    assert float(evaluate(np.float64(cosine), np.float64(g))) == pytest.approx(float(exact), rel=2e-13)


@pytest.mark.parametrize("g", ANISOTROPIES)
def test_the_sampler_has_the_density(g, rng):
    size = 100_000
    direction = np.repeat(ALONG[:, None], size, axis=1)
    found = sample(direction, np.float64(g), *rng.random((2, size)))
    np.testing.assert_allclose(np.linalg.norm(found, axis=0), 1.0, rtol=1e-12)
    result = chi_square(found, lambda w: evaluate(ALONG @ w, np.float64(g)), Sphere())
    assert result.p_value > sidak(1e-3, len(ANISOTROPIES))


@pytest.mark.parametrize("g", [0.999, -0.999, 0.3, 1e-10])
def test_the_sampled_cosine_inverts_the_distribution(g):
    """The integral of the density from the back up to the sampled cosine is the uniform."""
    u = np.array([0.0, 1e-6, 0.25, 0.5, 0.75, 1.0 - 1e-6])
    direction = np.repeat(ALONG[:, None], u.size, axis=1)
    cosine = ALONG @ sample(direction, np.float64(g), np.full(u.size, 0.3), u)
    with mpmath.workdps(30):
        exact = mpmath.mpf(g)

        def mass(c):
            base = 1 + exact**2 - 2 * exact * c
            return (1 - exact**2) / (2 * exact) * (1 / mpmath.sqrt(base) - 1 / (1 + exact))

        # The cosine of a product of unit vectors is known to 1e-16 only, which the density there multiplies.
        for c, expected in zip(cosine, u, strict=True):
            allowed = 1e-15 * (1.0 + 2.0 * np.pi * float(evaluate(np.float64(c), np.float64(g)))) * 4.0
            assert float(mass(mpmath.mpf(float(c)))) == pytest.approx(expected, abs=allowed)
