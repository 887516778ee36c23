# SPDX-License-Identifier: GPL-3.0-or-later
"""White furnace: under a white sky a surface shows its directional albedo.

Quadrature gives the truth. E(wo) = integral of F |cos| over wi; over the microfacet m its integrand is
D G (wo.m) / cos_o. D, Lambda and G are written here once more, from the papers, so that the integrator's own are not
their own judges.
"""

from functools import cache

import numpy as np
import pytest
from etalon.tests.chi2 import sidak
from etalon.tests.replicates import LEVEL, assert_mean, replicates
from etalon.tests.scenes import fan, fan_camera, glossy, scene
from scipy.integrate import dblquad
from scipy.special import erf, roots_legendre

MASKING = ["correlated", "separable", "torrance_sparrow"]
STRATEGIES = ["visible", "d_cos", "cosine", "uniform"]
# Torrance and Sparrow's min has kinks, which cost the quadrature digits.
QUADRATURE = {"correlated": 2e-6, "separable": 2e-6, "torrance_sparrow": 1e-4}
ALPHAS = (0.01, 0.05, 0.1, 0.3, 0.5, 0.7, 1.0)
ANGLES = np.radians([0.0, 15.0, 30.0, 45.0, 60.0, 70.0, 78.0, 84.0, 88.0])


def slope_density(distribution, tangent, alpha):
    """D(m) cos^4: the density of slopes."""
    t2 = (tangent / alpha) ** 2
    return (np.exp(-t2) if distribution == "BECKMANN" else (1.0 + t2) ** -2) / (np.pi * alpha**2)


def smith_lambda(distribution, tangent, alpha):
    """Lambda of a direction with that tangent: Heitz 2014, eq. 72 (GGX) and 66 (Beckmann)."""
    a = 1.0 / np.maximum(alpha * tangent, 1e-12)
    if distribution == "BECKMANN":
        return 0.5 * (erf(a) - 1.0) + np.exp(-np.minimum(a * a, 700.0)) / (2.0 * a * np.sqrt(np.pi))
    return 0.5 * (np.sqrt(1.0 + 1.0 / (a * a)) - 1.0)


def shadowing(masking, distribution, alpha, cos_i, cos_o, m_z, cos_om):
    """G in each of its three forms."""
    if masking == "torrance_sparrow":  # wi.m equals wo.m
        return np.minimum(1.0, 2.0 * m_z * np.minimum(cos_i, cos_o) / cos_om)
    lambdas = [smith_lambda(distribution, np.sqrt(np.maximum(1.0 - c * c, 0.0)) / c, alpha) for c in (cos_i, cos_o)]
    if masking == "separable":
        return 1.0 / ((1.0 + lambdas[0]) * (1.0 + lambdas[1]))
    return 1.0 / (1.0 + lambdas[0] + lambdas[1])


@cache
def albedo(distribution, alpha, masking, nodes=(300, 300)):
    """E at ANGLES, (angles,).

    Slopes are in polar form, t = tan theta_m up to where the reflection meets the horizon.
    """
    cos_o, sin_o = np.cos(ANGLES)[:, None, None], np.sin(ANGLES)[:, None, None]
    (node, weight), (turn, turn_weight) = (roots_legendre(n) for n in nodes)
    node, weight = 0.5 * (node + 1.0), 0.5 * weight
    forward = sin_o * np.cos(0.5 * np.pi * (turn + 1.0))[:, None]
    horizon = (forward + np.sqrt(forward**2 + cos_o**2)) / cos_o
    y = node * horizon / (alpha + horizon)  # t = alpha y / (1 - y): no width of lobe is too narrow
    t = alpha * y / (1.0 - y)
    dt = weight * horizon / (alpha + horizon) * alpha / (1.0 - y) ** 2
    m_z = 1.0 / np.sqrt(1.0 + t * t)
    cos_om = m_z * (forward * t + cos_o)
    cos_i = np.maximum(2.0 * cos_om * m_z - cos_o, 1e-12)
    g = shadowing(masking, distribution, alpha, cos_i, cos_o, m_z, cos_om)
    # D dm = (slope density / cos^4) (t cos^3 dt dphi); twice the half circle
    rings = (slope_density(distribution, t, alpha) / m_z * g * cos_om / cos_o * t * dt).sum(axis=2)
    return np.pi * rings @ turn_weight


def furnace(distribution, alphas, angles=ANGLES):
    return scene(
        fan(angles, len(alphas)),
        [glossy(alpha, distribution=distribution) for alpha in alphas],
        fan_camera(angles, len(alphas)),
        world=1.0,
    )


def test_the_quadrature_itself():
    """No roughness loses nothing, and GGX of alpha 1 at normal incidence is known.

    The latter has correlated masking.
    """
    np.testing.assert_allclose(albedo("GGX", 1e-4, "correlated")[:6], 1.0, atol=1e-6)
    # alpha 1: D = 1/pi; with wo = n: m = half of wi, cos_i = 2 c^2 - 1, Lambda_o = 0, G = 2 cos_i / (1 + cos_i), so that
    # E = integral of (2 c^2 - 1) / c^2 * 2 c dc from 1/sqrt 2 to 1 = 1 - ln 2.
    np.testing.assert_allclose(albedo("GGX", 1.0, "correlated")[0], 1.0 - np.log(2.0), rtol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("masking", MASKING)
def test_the_quadrature_has_settled(masking):
    """Other nodes, the same albedo."""
    for distribution in ("GGX", "BECKMANN"):
        for alpha in (0.01, 0.3, 1.0):
            other = albedo(distribution, alpha, masking, (200, 450))
            np.testing.assert_allclose(albedo(distribution, alpha, masking), other, rtol=QUADRATURE[masking])


def test_the_quadrature_against_the_sphere_of_wi():
    """Straight from the definition, over wi rather than m, by an adaptive rule."""
    o = np.array([np.sin(ANGLES[4]), 0.0, np.cos(ANGLES[4])])

    def integrand(phi, cos_i):
        i = np.array([np.sqrt(1.0 - cos_i**2) * np.cos(phi), np.sqrt(1.0 - cos_i**2) * np.sin(phi), cos_i])
        m = (i + o) / np.linalg.norm(i + o)
        d = slope_density("BECKMANN", np.sqrt(1.0 / m[2] ** 2 - 1.0), 0.5) / m[2] ** 4
        return d * shadowing("separable", "BECKMANN", 0.5, cos_i, o[2], m[2], m @ o) / (4.0 * o[2])

    exact = 2.0 * dblquad(integrand, 1e-9, 1.0, 0.0, np.pi, epsabs=1e-7)[0]
    np.testing.assert_allclose(albedo("BECKMANN", 0.5, "separable")[4], exact, rtol=1e-6)


def assert_albedo(images, exact, samples, precision, rounding):
    """t tests where many samples lose something.

    Where few do, the mean of a few rare losses is not normal, and Bernstein's inequality for losses in [0, 1] stands
    in: |error| < sqrt(2 v L / n) + 2 L / (3 n), v = 1 - E at most, L = log(2 / level).
    """
    count = samples * len(images)
    rare = count * np.abs(1.0 - exact) < 50.0
    assert_mean(images[:, ~rare], exact[~rare][:, None], precision, rounding)
    if rare.any():
        odds = np.log(2.0 / sidak(LEVEL, int(rare.sum())))
        lost = np.abs(1.0 - exact[rare])
        error = np.abs(images.mean(axis=0)[rare] - exact[rare][:, None]).max(axis=1)
        assert np.all(error < np.sqrt(2.0 * lost * odds / count) + 2.0 * odds / (3.0 * count) + rounding)


# Sampling without visible normals has weights that grow towards grazing views, and hemispheres do not find narrow lobes: for each
# strategy the roughnesses (from this one on) and angles (up to this one) that its noise allows, and the noise.
REACH = {"visible": (0, 9, 0.01), "d_cos": (0, 6, 0.02), "cosine": (3, 6, 0.04), "uniform": (3, 6, 0.02)}


@pytest.mark.parametrize("distribution", ["GGX", "BECKMANN"])
@pytest.mark.parametrize(
    "masking", [pytest.param(name, marks=() if name == "correlated" else pytest.mark.slow) for name in MASKING]
)
@pytest.mark.parametrize(
    "strategy", [pytest.param(name, marks=() if name == "visible" else pytest.mark.slow) for name in STRATEGIES]
)
def test_directional_albedo(distribution, masking, strategy, seed):
    """By facing angle, for every roughness that the strategy can resolve at all."""
    first, last, precision = REACH[strategy]
    alphas, angles = ALPHAS[first:], ANGLES[:last]
    exact = np.stack([albedo(distribution, alpha, masking)[:last] for alpha in alphas])
    images = replicates(furnace(distribution, alphas, angles), 12, 256, masking=masking, strategy=strategy, seed=seed)
    assert_albedo(images, exact, 256, precision, QUADRATURE[masking])


def test_no_sample_gains_energy(seed):
    """A visible normal's weight is G2 / G1 <= 1.

    There is one sample a pixel, and none is brighter than the sky.
    """
    for distribution in ("GGX", "BECKMANN"):
        for masking in ("correlated", "separable"):
            images = replicates(furnace(distribution, ALPHAS), 40, 1, masking=masking, seed=seed)
            assert images.max() <= 1.0 + 1e-12
