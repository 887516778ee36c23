# SPDX-License-Identifier: GPL-3.0-or-later
"""A world with small suns in it.

Its samples have the density that it states, and find all of its light.
"""

import numpy as np
import pytest
from etalon.lib.lights.sky import SunnySampler, suns_of
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.sky import Sky, SunDisc
from etalon.lib.textures.sky import toward
from scipy.integrate import quad

SUNS = [(toward(0.5, 2.0), 0.005), (toward(1.2, -1.0), 0.03)]
SHINE = (8e4, 500.0)


def radiance(direction):
    """A slope, and in it suns that darken to a tenth at their limb."""
    total = 1.0 + 0.5 * direction[2]
    for (center, half_angle), shine in zip(SUNS, SHINE, strict=True):
        apart = direction - np.array(center)[:, None]
        share = 2.0 * np.arcsin(0.5 * np.sqrt((apart * apart).sum(axis=0))) / half_angle
        total = total + shine * np.where(share < 1.0, 1.0 - 0.9 * share**2, 0.0)
    return np.broadcast_to(total, direction.shape)


def shine_of(sun):
    """The integral of a sun's radiance over its disc."""
    half = SUNS[sun][1]
    return 2.0 * np.pi * SHINE[sun] * quad(lambda t: np.sin(t) * (1.0 - 0.9 * (t / half) ** 2), 0.0, half)[0]


ALL = 4.0 * np.pi + shine_of(0) + shine_of(1)


@pytest.fixture
def sampler():
    return SunnySampler(radiance, (64, 32), SUNS)


def test_all_light_is_found_and_little_else(sampler, rng):
    u1, u2 = rng.random((2, 200_000))
    drawn = sampler.sample(np.zeros((3, u1.size)), u1, u2)
    found = drawn.radiance[0] / drawn.pdf
    error = found.std() / np.sqrt(found.size)
    assert error < 2e-3 * ALL
    assert abs(found.mean() - ALL) < 4.0 * error
    np.testing.assert_array_equal(drawn.radiance, radiance(drawn.wi))
    np.testing.assert_allclose(np.linalg.norm(drawn.wi, axis=0), 1.0, atol=1e-12)
    assert sampler.power == pytest.approx(np.pi * ALL, rel=0.02)


def test_the_density_is_that_of_the_samples(sampler, rng):
    u1, u2 = rng.random((2, 200_000))
    drawn = sampler.sample(np.zeros((3, u1.size)), u1, u2)
    np.testing.assert_array_equal(drawn.pdf, sampler.pdf(drawn.wi, drawn.wi, drawn.distance))
    # The mean of 1 / pdf over samples in a set is the set's solid angle: the inner half of each sun, and a half space.
    sets = [(np.array(center), np.cos(0.5 * half)) for center, half in SUNS] + [(np.array([0.6, 0.0, 0.8]), 0.0)]
    for axis, cosine in sets:
        found = np.where(axis @ drawn.wi > cosine, 1.0 / drawn.pdf, 0.0)
        solid = 2.0 * np.pi * (1.0 - cosine)
        assert abs(found.mean() - solid) < 4.0 * found.std() / np.sqrt(found.size)
        assert found.std() / np.sqrt(found.size) < 0.03 * solid


def test_the_suns_of_a_world_are_those_of_its_skies_once():
    sun = SunDisc(0.5, 0.01, 1)
    skies = [
        Sky(ex.Coordinates("GENERATED"), 0, azimuth, disc) for azimuth, disc in ((2.0, sun), (2.0, sun), (1.0, None))
    ]
    world = ex.Mix(ex.ONE, ex.Mix(ex.ONE, skies[0], skies[1], "ADD"), skies[2], "ADD")
    assert suns_of(world) == [(toward(0.5, 2.0), 0.005)]
    assert suns_of(ex.WHITE) == []
