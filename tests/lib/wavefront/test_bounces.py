# SPDX-License-Identifier: GPL-3.0-or-later
"""How many times light scatters.

The radiance of the closed box is a finite geometric series.
"""

import numpy as np
import pytest
from etalon.lib.scene.materials import Diffuse, Emission, Glossy
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import color, cube, icosphere, material, orthographic, perspective, scene

INSIDE = perspective(8, 8, 1.0, (0.1, 0.2, 0.3), (0.3, 0.5, -1.0))


@pytest.mark.grid(3)
@pytest.mark.parametrize("direct", ["mis", "lights", "bsdf"])
@pytest.mark.parametrize(("bounces", "exact"), [(0, 1.8), (1, 2.44), (2, 2.952)])
def test_glowing_box(direct, bounces, exact, seed):
    """Albedo 0.8, emission 1, n bounces: 1 + 0.8 + ... + 0.8^(n + 1)."""
    box = scene(cube(), material(Diffuse(color(0.8)), Emission(color(1.0))), INSIDE, bounces=bounces)
    precision = 1e-6 if direct == "bsdf" else 0.02
    assert_mean(
        replicates(box, 8, 64, direct=direct, seed=seed).mean(axis=(1, 2), keepdims=True), exact, precision, 1e-9
    )


def test_glowing_box_is_exact_by_bsdf_sampling(seed):
    """Every path sees emission 1 at every hit and keeps exactly its colour.

    There is no noise at all, and colours differ.
    """
    box = scene(icosphere(), material(Diffuse(color(0.9, 0.5, 0.1)), Emission(color(1.0, 2.0, 3.0))), INSIDE, bounces=5)
    image = replicates(box, 1, 16, direct="bsdf", seed=seed)[0]
    albedo, glow = np.array([0.9, 0.5, 0.1]), np.array([1.0, 2.0, 3.0])
    np.testing.assert_allclose(
        image, np.broadcast_to(glow * (1.0 - albedo**7) / (1.0 - albedo), image.shape), rtol=1e-12
    )


def test_a_mirror_box_counts_the_same(seed):
    """Deltas are scatterings too: mirrors of 0.5 around an emission of 1."""
    box = scene(cube(), material(Glossy("GGX", color(0.5)), Emission(color(1.0))), INSIDE, bounces=3)
    np.testing.assert_allclose(replicates(box, 1, 4, seed=seed), 1.0 + 0.5 + 0.25 + 0.125 + 0.0625, rtol=1e-12)


def test_no_lobes_is_black_and_the_world_is_behind(seed):
    """A black square before a white sky.

    Rays that meet nothing see the world, whatever `max_bounces`.
    """
    black = scene(cube(0.5), material(), orthographic(4, 4, 2.0, (0.0, 0.0, 5.0)), world=0.7)
    image = replicates(black, 1, 16, seed=seed)[0]
    assert np.all(image[1:3, 1:3] == 0.0)
    np.testing.assert_allclose(image[0], 0.7, rtol=1e-15)
