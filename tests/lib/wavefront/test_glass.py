# SPDX-License-Identifier: GPL-3.0-or-later
"""Two smooth interfaces: the series of internal reflections, whose sum is known."""

import numpy as np
import pytest
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.materials import Refraction
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import color, diffuse, emission, floor, glass, material, orthographic, quad, scene


def slab(ior, tint, degrees, bounces):
    """A plate of glass seen under an angle; its lower face looks down.

    The sky is 1 everywhere.
    """
    angle = np.radians(degrees)
    forward = np.array([np.sin(angle), 0.0, -np.cos(angle)])
    top = floor(500.0)
    bottom = quad((-500.0, 500.0, -0.1), (1000.0, 0.0, 0.0), (0.0, -1000.0, 0.0))
    camera = orthographic(2, 2, 0.01, -5.0 * forward + [0.013, 0.007, 0.0], forward)
    return scene([top, bottom], glass(ior, *tint), camera, world=1.0, bounces=bounces)


def reflectance(degrees, ior):
    """Fresnel by angles; at normal incidence by indices."""
    i = np.radians(degrees)
    if i == 0.0:
        return ((ior - 1.0) / (ior + 1.0)) ** 2
    t = np.arcsin(np.sin(i) / ior)
    return 0.5 * ((np.sin(i - t) / np.sin(i + t)) ** 2 + (np.tan(i - t) / np.tan(i + t)) ** 2)


@pytest.mark.parametrize("degrees", [0.0, 45.0, 75.0])
def test_clear_glass_in_a_furnace(degrees, seed):
    """Every interaction has weight 1 and both ways out see the same sky.

    The image is 1 exactly, as soon as no path is cut off.
    """
    images = replicates(slab(1.5, (1.0,), degrees, 60), 1, 256, seed=seed)
    np.testing.assert_allclose(images, 1.0, rtol=1e-12)


@pytest.mark.grid(3)
@pytest.mark.parametrize("degrees", [0.0, 45.0, 75.0])
@pytest.mark.parametrize("bounces", [0, 1, 2, 20])
def test_coloured_glass_in_a_furnace(degrees, bounces, seed):
    """Each interaction tints by c.

    c R + c^2 (1 - R)^2 sum over k of (c R)^k, k + 2 interactions for the k-th, at most bounces + 1.
    """
    c = np.array([0.9, 0.5, 0.2])
    r = reflectance(degrees, 1.5)
    inner = sum(((c * r) ** k for k in range(bounces)), np.zeros(3))
    exact = c * r + c**2 * (1.0 - r) ** 2 * inner
    images = replicates(slab(1.5, c, degrees, bounces), 10, 256, seed=seed).mean(axis=(1, 2), keepdims=True)
    assert_mean(images, exact, 0.02)


def test_refraction_goes_where_snell_says(seed):
    """Through the upper face only, without Fresnel, onto a wall of emission.

    A straight ray would miss the wall.
    """
    degrees, ior = 60.0, 1.5
    inside = np.arcsin(np.sin(np.radians(degrees)) / ior)
    forward = np.array([np.sin(np.radians(degrees)), 0.0, -np.cos(np.radians(degrees))])
    camera = orthographic(4, 1, 0.2, -3.0 * forward, forward)
    bottom_x = np.tan(inside)  # depth 1
    patch = quad((bottom_x - 0.21, -1.0, -1.0), (0.42, 0.0, 0.0), (0.0, 2.0, 0.0), 1)
    water = scene(
        [floor(500.0), patch], [material(Refraction(color(0.8), Constant(ior))), emission(2.0)], camera, bounces=3
    )
    np.testing.assert_allclose(replicates(water, 1, 64, seed=seed), 1.6, rtol=1e-12)
    # Outwards beyond the critical angle nothing is refracted.
    under = orthographic(2, 2, 0.1, (0.0, 0.0, -1.0), (np.sin(0.8), 0.0, np.cos(0.8)))
    total = scene([floor(500.0)], [material(Refraction(color(0.8), Constant(ior)))], under, world=1.0, bounces=3)
    assert not replicates(total, 1, 16, seed=seed).any()


def test_glass_casts_a_shadow_on_light_sampling(seed):
    """A delta light is not found through refraction.

    The floor under a plate of glass is dark, as in Cycles.
    """
    plate = quad((-5.0, -5.0, 0.5), (10.0, 0.0, 0.0), (0.0, 10.0, 0.0), 1)
    sun = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (1.0, 1.0, 1.0))
    camera = orthographic(2, 2, 0.1, (0.01, 0.02, 0.4))
    dark = scene([floor(5.0), plate], [diffuse(0.8), glass(1.5)], camera, [sun], bounces=4)
    assert not replicates(dark, 1, 16, seed=seed).any()
