# SPDX-License-Identifier: GPL-3.0-or-later
"""Russian roulette: fewer rays, the same mean."""

import numpy as np
import pytest
from etalon.lib.scene.materials import Diffuse, Emission
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.replicates import assert_mean, assert_same, blocks, replicates
from etalon.tests.scenes import color, cube, diffuse, emission, floor, material, perspective, quad, scene, transparent

INSIDE = perspective(6, 6, 1.0, (0.1, 0.2, 0.3), (0.3, 0.5, -1.0))


@pytest.mark.parametrize("albedo", [(0.8, 0.8, 0.8), (0.9, 0.5, 0.1)])
def test_the_glowing_box_keeps_its_series(albedo, seed):
    """1 + a + a^2 + ... of 16 terms, although most paths are stopped before."""
    box = scene(cube(), material(Diffuse(color(*albedo)), Emission(color(1.0))), INSIDE, bounces=14)
    a = np.array(albedo)
    images = replicates(box, 10, 16, direct="bsdf", russian_roulette=True, seed=seed).mean(axis=(1, 2), keepdims=True)
    assert_mean(images, (1.0 - a**16) / (1.0 - a), 0.01)


@pytest.mark.slow
@pytest.mark.parametrize("veil", [pytest.param(False, marks=pytest.mark.slow), True])
def test_the_same_image_with_fewer_rays(veil, seed):
    """A lit room, with and without a transparent sheet in it."""
    parts = [cube(), quad((-0.4, -0.4, 0.9), (0.0, 0.8, 0.0), (0.8, 0.0, 0.0), 1)]
    materials = [diffuse(0.5, 0.3, 0.2), emission(3.0)]
    if veil:
        parts.append(floor(0.9, 0.2, 2))
        materials.append(transparent(0.9, 0.7, 0.8))
    camera = perspective(10, 10, 0.8, (0.03, -0.9, 0.1), (0.1, 1.0, -0.2))
    room = scene(parts, materials, camera, bounces=6)
    images = [blocks(replicates(room, 12, 32, russian_roulette=r, seed=seed + r), 5) for r in (False, True)]
    assert_same(*images, 0.04)
    rays = [
        ReferenceRenderer(room, Options(seed=seed, threads=1, russian_roulette=r)).render(0, 16).rays
        for r in (False, True)
    ]
    assert rays[1] < 0.8 * rays[0]


def test_it_does_not_touch_short_paths(seed):
    """Up to the third scattering there is no roulette.

    With two bounces the image is the same, sample by sample, except for the last ray.
    """
    box = scene(cube(), material(Diffuse(color(0.3)), Emission(color(1.0))), INSIDE, bounces=1)
    images = [replicates(box, 1, 16, russian_roulette=r, seed=seed) for r in (False, True)]
    np.testing.assert_array_equal(*images)


def test_white_paths_are_never_stopped(seed):
    """A throughput of 1 survives with certainty."""
    box = scene(cube(), material(Diffuse(color(1.0)), Emission(color(1.0))), INSIDE, bounces=10)
    np.testing.assert_allclose(
        replicates(box, 1, 16, direct="bsdf", russian_roulette=True, seed=seed), 12.0, rtol=1e-12
    )


def test_what_is_not_finite_is_not_stopped(seed):
    """Every path in the box carries NaN from its first scattering on.

    It is counted when it meets the lamp, however late.
    """
    parts = [cube(), quad((-0.4, -0.4, 0.9), (0.0, 0.8, 0.0), (0.8, 0.0, 0.0), 1)]
    box = scene(parts, [diffuse(np.nan), emission(3.0)], INSIDE, bounces=6)
    counts = [
        ReferenceRenderer(box, Options(seed=seed, threads=1, direct="bsdf", russian_roulette=r)).render(0, 64).nonfinite
        for r in (False, True)
    ]
    assert counts[0].sum() > 100
    np.testing.assert_array_equal(*counts)
