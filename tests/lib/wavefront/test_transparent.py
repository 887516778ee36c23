# SPDX-License-Identifier: GPL-3.0-or-later
"""Stacks of transparent sheets: products of colours, and how many are passed."""

import numpy as np
import pytest
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.lights import AreaLight, SunLight
from etalon.lib.scene.materials import Diffuse, Emission, Material, Transparent, WeightedClosure
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import color, diffuse, floor, glossy, material, orthographic, scene, transparent

COLORS = np.array([[0.9, 0.5, 0.7], [0.8, 1.0, 0.3], [0.6, 0.7, 0.9], [0.5, 0.9, 0.8], [0.7, 0.6, 0.95]])
ABOVE = orthographic(2, 2, 0.5, (0.03, 0.02, 10.0))
BELOW = orthographic(2, 2, 0.5, (0.03, 0.02, 0.5))
SUN = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (1.0, 1.0, 1.0))


def sheets(count=5, first=1, start=0):
    return [floor(5.0, 1.0 + k, first + k) for k in range(start, count)]


@pytest.mark.parametrize("limit", [0, 1, 3, 5, 64])
def test_stack_before_the_sky(limit, seed):
    """max(t, 1) sheets are passed; a sixth thing, the sky, is seen only if all five are."""
    stack = scene(sheets(first=0), [transparent(*c) for c in COLORS], ABOVE, world=2.0, transparent_max_bounces=limit)
    exact = 2.0 * COLORS.prod(axis=0) if limit >= 5 else np.zeros(3)
    np.testing.assert_allclose(replicates(stack, 1, 4, seed=seed), np.broadcast_to(exact, (1, 2, 2, 3)), rtol=1e-12)


@pytest.mark.parametrize("limit", [0, 1, 2, 4, 5])
def test_the_next_surface_gives_its_emission_only(limit, seed):
    """Every sheet glows by 1: from the top down, 1 + c1 (1 + c2 (...)).

    The series goes up to the surface after the last that is passed.
    """
    glowing = [material(Transparent(color(*c)), Emission(color(1.0))) for c in COLORS]
    stack = scene(sheets(first=0), glowing, ABOVE, world=2.0, transparent_max_bounces=limit)
    exact, through = np.zeros(3), np.ones(3)
    for met, c in enumerate(COLORS[::-1]):
        exact = exact + through
        if met == max(limit, 1):
            through = np.zeros(3)
            break
        through = through * c
    exact = exact + 2.0 * through
    images = replicates(stack, 1, 4, seed=seed, direct="bsdf")
    np.testing.assert_allclose(images, np.broadcast_to(exact, images.shape), rtol=1e-12)


@pytest.mark.parametrize("limit", [0, 1, 4, 5, 64])
def test_shadow_rays_pass_as_many(limit, seed):
    """A floor under five sheets and a sun: t hits for shadow rays, and none for t = 0."""
    under = scene(
        [floor(5.0), *sheets()],
        [diffuse(0.8), *(transparent(*c) for c in COLORS)],
        BELOW,
        [SUN],
        transparent_max_bounces=limit,
    )
    exact = 0.8 / np.pi * COLORS.prod(axis=0) if limit >= 5 else np.zeros(3)
    np.testing.assert_allclose(replicates(under, 1, 4, seed=seed), np.broadcast_to(exact, (1, 2, 2, 3)), rtol=1e-12)


def test_no_sheets_and_no_transparent_bounces(seed):
    """t = 0 still lets light arrive where nothing is in between."""
    parts = [floor(5.0), floor(0.1, 20.0, 1)]
    parts[1].vertices[0] += 50.0  # a transparent sheet far aside, so that the scene calls for the effect
    bare = scene(parts, [diffuse(0.8), transparent(0.5)], BELOW, [SUN], transparent_max_bounces=0)
    np.testing.assert_allclose(replicates(bare, 1, 4, seed=seed), 0.8 / np.pi, rtol=1e-12)


@pytest.mark.grid(3)
@pytest.mark.parametrize("direct", ["mis", "lights", "bsdf"])
@pytest.mark.parametrize("roughness", [None, 0.3])
def test_area_light_through_coloured_sheets(direct, roughness, seed):
    """Howell's disk (C-11: r^2 / (h^2 + r^2) on its axis) times the product.

    For a glossy floor, all ways of finding it agree.
    """
    light = AreaLight(
        "disk", (0.03, 0.02, 7.0), (8.0, 0.0, 0.0), (0.0, -8.0, 0.0), (0, 0, -1.0), "ELLIPSE", (2.0,) * 3, np.pi
    )
    ground = diffuse(0.8) if roughness is None else glossy(roughness)
    camera = orthographic(2, 2, 1e-3, (0.03, 0.02, 0.5))
    parts = [floor(50.0), *(floor(50.0, 1.0 + k, 1 + k) for k in range(2))]
    under = scene(parts, [ground, *(transparent(*c) for c in COLORS[:2])], camera, [light])
    images = replicates(under, 10, 128, direct=direct, seed=seed).mean(axis=(1, 2), keepdims=True)
    product = COLORS[:2].prod(axis=0)
    if roughness is None:
        assert_mean(images, 2.0 * 0.8 * 16.0 / (49.0 + 16.0) * product, 0.02)
    else:
        bare = scene([floor(50.0)], [ground], camera, [light])
        plain = replicates(bare, 10, 512, seed=seed + 1).mean(axis=(0, 1, 2))
        assert_mean(images, plain * product, 0.02, rounding=4e-3)


def test_half_transparent_half_diffuse(seed):
    """A white sheet lets half of the light pass and scatters the other half.

    It loses nothing in a white furnace.
    """
    half = Material("half", (WeightedClosure(Transparent(), Constant(0.5)), WeightedClosure(Diffuse(), Constant(0.5))))
    furnace = scene(
        [floor(5.0, 1.0), floor(5.0, 2.0)], [half], ABOVE, world=1.0, bounces=200, transparent_max_bounces=1000
    )
    image = replicates(furnace, 1, 64, seed=seed)[0]
    np.testing.assert_allclose(image, 1.0, rtol=1e-9)


def test_partial_shadow(seed):
    """Sun through a sheet of weight 0.3 transparent (colour c) and 0.7 black: 0.3 c."""
    sheet = Material("sheet", (WeightedClosure(Transparent(color(*COLORS[0])), Constant(0.3)),))
    under = scene([floor(5.0), floor(5.0, 1.0, 1)], [diffuse(0.8), sheet], BELOW, [SUN])
    exact = 0.8 / np.pi * 0.3 * COLORS[0]
    np.testing.assert_allclose(replicates(under, 1, 4, seed=seed), np.broadcast_to(exact, (1, 2, 2, 3)), rtol=1e-12)


def test_passing_is_no_scattering(seed):
    """max_bounces 0: a diffuse floor seen through five clear sheets is lit all the same."""
    parts = [floor(5000.0), *(floor(5000.0, 1.0 + k, 1 + k) for k in range(5))]
    seen = scene(parts, [diffuse(0.8), *(transparent(*c) for c in COLORS)], ABOVE, world=1.0)
    # The sky comes down through the sheets as the view does: the product twice, but for what comes in below their edges.
    exact = 0.8 * COLORS.prod(axis=0) ** 2
    assert_mean(replicates(seen, 10, 64, seed=seed), exact, 0.01, rounding=1e-5)
