# SPDX-License-Identifier: GPL-3.0-or-later
"""The three masking forms: as printed, at their limits, and conserving the visible area."""

import numpy as np
import pytest
from etalon.lib.microfacets import masking
from etalon.lib.microfacets.beckmann import Beckmann
from etalon.lib.microfacets.ggx import GGX

BOTH = pytest.mark.parametrize("distribution", [Beckmann(), GGX()], ids=["beckmann", "ggx"])


def hemisphere(rng, count):
    w = rng.normal(size=(3, count))
    w[2] = np.abs(w[2])
    return w / np.sqrt((w * w).sum(axis=0))


def dot(a, b):
    return (a * b).sum(axis=0)


def test_torrance_sparrow_as_printed(rng):
    wi, wo = hemisphere(rng, 5000), hemisphere(rng, 5000)
    m = wi + wo
    m /= np.sqrt(dot(m, m))
    printed = np.minimum(1.0, np.minimum(2.0 * m[2] * wo[2] / dot(wo, m), 2.0 * m[2] * wi[2] / dot(wi, m)))
    np.testing.assert_allclose(masking.torrance_sparrow(wi, wo, m), printed, rtol=1e-14)
    assert (masking.torrance_sparrow(wi, wo, m) == masking.torrance_sparrow(wo, wi, m)).all()


@BOTH
@pytest.mark.parametrize("degrees", [0.0, 30.0, 70.0, 89.0])
def test_torrance_sparrow_conserves_the_visible_area(distribution, degrees):
    """V-shaped grooves are a surface.

    For any D, what an observer sees of them is the flat surface's area. With the light at the normal, the light's own
    bound is 2 and the form is the masking of one direction.
    """
    node, weight = np.polynomial.legendre.leggauss(400)
    angle, weight_t = 0.25 * np.pi * (1.0 + node), 0.25 * np.pi * weight
    theta, phi = (g.ravel() for g in np.meshgrid(angle, 2.0 * np.pi * (np.arange(720) + 0.5) / 720, indexing="ij"))
    m = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    wo = np.repeat([[np.sin(np.radians(degrees))], [0.0], [np.cos(np.radians(degrees))]], theta.size, axis=1)
    normal = np.repeat([[0.0], [0.0], [1.0]], theta.size, axis=1)
    seen = (
        masking.torrance_sparrow(normal, wo, m)
        * distribution.density(m, 0.6, 0.4)
        * np.maximum(dot(wo, m), 0.0)
        * np.sin(theta)
    )
    total = (seen.reshape(400, 720).sum(axis=1) * weight_t).sum() * (2.0 * np.pi / 720)
    assert total == pytest.approx(wo[2, 0], rel=2e-5)


@BOTH
def test_smith_forms(distribution, rng):
    wi, wo = hemisphere(rng, 2000), hemisphere(rng, 2000)
    lambda_i, lambda_o = (distribution.smith_lambda(w, 0.7, 0.3) for w in (wi, wo))
    separable, correlated = masking.separable(lambda_i, lambda_o), masking.height_correlated(lambda_i, lambda_o)
    np.testing.assert_allclose(separable, 1.0 / (1.0 + lambda_i) / (1.0 + lambda_o), rtol=1e-14)
    np.testing.assert_allclose(correlated, 1.0 / (1.0 + lambda_i + lambda_o), rtol=1e-14)
    assert (separable <= correlated * (1.0 + 1e-15)).all()
    assert (correlated <= np.minimum(1.0 / (1.0 + lambda_i), 1.0 / (1.0 + lambda_o)) * (1.0 + 1e-15)).all()


def test_separable_against_correlated_at_grazing():
    """Hard case 26: tens of per cent apart, a difference between models and not an error."""
    grazing = np.array([[np.sin(1.5)], [0.0], [np.cos(1.5)]])
    value = GGX().smith_lambda(grazing, 1.0, 1.0)
    assert masking.height_correlated(value, value) / masking.separable(value, value) > 1.5


def test_zero_below_the_horizon_and_from_behind():
    up, down = np.array([[0.6], [0.0], [0.8]]), np.array([[0.6], [0.0], [-0.8]])
    level = np.array([[1.0], [0.0], [0.0]])
    tilted = np.array([[-0.96], [0.0], [0.28]])  # up looks at its back
    normal = np.array([[0.0], [0.0], [1.0]])
    for wi, wo, m in (
        (up, down, normal),
        (down, up, normal),
        (down, down, normal),
        (up, up, tilted),
        (up, level, normal),
        (level, up, normal),
        (level, level, level),
        (up, up, -normal),
    ):
        assert masking.torrance_sparrow(wi, wo, m) == 0.0
    for distribution in (Beckmann(), GGX()):
        below, above = (distribution.smith_lambda(w, 0.5, 0.5) for w in (down, up))
        for form in (masking.separable, masking.height_correlated):
            assert form(below, above) < 1e-90
            assert form(above, below) * (1.0 + below) < 2.0
