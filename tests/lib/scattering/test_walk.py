# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks in a medium: free paths against their distributions.

What leaves a half space and a slab is compared with transport theory.
"""

import numpy as np
import pytest
from etalon.lib.scattering.subsurface import Medium
from etalon.lib.scattering.walk import Walks, free_path_weight, sample_free_path, similar, walk
from etalon.tests.lib.scattering.test_subsurface import MU, WEIGHT, h_function
from scipy.stats import kstest

COUNT = 40_000


def slab(thickness):
    """Layers 0 < depth < thickness, depth = -z: the top is face 0, the bottom face 1."""

    def closest(_, origin, direction, reach):
        z, speed = origin[2], direction[2]
        with np.errstate(divide="ignore", invalid="ignore"):
            up, down = -z / speed, (-thickness - z) / speed
        distance = np.where(speed > 0.0, up, down)
        met = (distance >= 0.0) & (distance < reach)
        zero = np.zeros(z.size)
        return np.where(met, np.where(speed > 0.0, 0, 1), -1), distance, zero, zero

    return closest


def nowhere(_, position):
    return np.zeros(position.shape[1], bool)


def medium(albedo, count, extinction=(1.0, 3.0, 0.2), g=0.0):
    rows = (np.repeat(np.array(x, float)[:, None], count, axis=1) for x in (extinction, albedo))
    return Medium(*rows, np.full(count, g), np.ones((3, count)))


def walks(cosine, of, count=COUNT):
    """Walks that enter the top along one direction."""
    direction = np.repeat(np.array([[np.sqrt(1.0 - cosine**2)], [0.0], [-cosine]]), count, axis=1)
    return Walks(np.arange(count), np.zeros((3, count)), direction, np.ones((3, count)), of)


def leaving(exits, face, count=COUNT):
    """Mean and standard error of what leaves by a face, (3,) each."""
    carried = np.zeros((3, count))
    carried[:, exits.index] = exits.throughput * (exits.triangle == face)
    return carried.mean(axis=1), carried.std(axis=1) / np.sqrt(count)


def keys(rng, count=COUNT):
    return rng.integers(0, 2**64, count, dtype=np.uint64)


def test_free_paths_are_exponential_in_the_channel_that_was_chosen(rng):
    of = medium((0.9, 0.5, 0.7), COUNT)
    length, chance = sample_free_path(walks(1.0, of), rng.random(COUNT))
    np.testing.assert_allclose(chance[:, 0], np.array([0.9, 0.5, 0.7]) / 2.1, rtol=1e-12)

    def mass(t):
        return 1.0 - (chance[:, :1] * np.exp(-of.extinction[:, :1] * t)).sum(axis=0)

    assert kstest(length, mass).pvalue > 1e-3


def test_weighed_by_all_channels_each_has_its_own_free_paths(rng):
    """The mean length of scattered light is the mean free path of each channel.

    It is so whichever channel was sampled.
    """
    of = medium((0.9, 0.5, 0.7), COUNT)
    length, chance = sample_free_path(walks(1.0, of), rng.random(COUNT))
    weight = free_path_weight(of, length, np.zeros(COUNT, bool), chance)
    for power in (0, 1):
        carried = weight / of.albedo * length**power
        error = carried.std(axis=1) / np.sqrt(COUNT)
        expected = of.extinction[:, 0] ** -float(power)
        assert (np.abs(carried.mean(axis=1) - expected) < 4.5 * error).all()


@pytest.mark.parametrize("cosine", [1.0, 0.3])
def test_a_half_space_reflects_what_chandrasekhar_says(cosine, rng):
    """1 - sqrt(1 - albedo) H(cosine), whatever the free path of the channel."""
    albedo = np.array([0.95, 0.6, 0.25])
    exits, _ = walk(slab(np.inf), nowhere, walks(cosine, medium(albedo, COUNT)), keys(rng))
    mean, error = leaving(exits, 0)
    for k, one in enumerate(albedo):
        h, root = h_function(one), np.sqrt(1.0 - one)
        at_cosine = 1.0 / (root + 0.5 * one * (WEIGHT * h * MU / (cosine + MU)).sum())
        assert mean[k] == pytest.approx(1.0 - root * at_cosine, abs=4.5 * error[k])


def analog_walks(cosine, albedo, g, thickness, rng, count):
    """Reflected and transmitted shares by a plain walk in depth.

    Cosines come from the tabulated phase function, absorption is by chance.
    """
    edge = np.cos(np.linspace(0.0, np.pi, 20_001))[::-1]
    middle = 0.5 * (edge[1:] + edge[:-1])
    table = np.append(0.0, np.cumsum((1.0 - g * g) / (1.0 + g * g - 2.0 * g * middle) ** 1.5 * np.diff(edge)))
    depth, mu, shares = np.zeros(count), np.full(count, cosine), []
    while depth.size:
        depth = depth + mu * rng.exponential(size=depth.size)
        shares.append(((depth < 0.0).sum(), (depth > thickness).sum()))
        kept = (depth >= 0.0) & (depth <= thickness) & (rng.random(depth.size) < albedo)
        depth, mu = depth[kept], mu[kept]
        turn, phi = np.interp(rng.random(depth.size) * table[-1], table, edge), 2.0 * np.pi * rng.random(depth.size)
        mu = mu * turn + np.sqrt((1.0 - mu**2) * (1.0 - turn**2)) * np.cos(phi)
    return np.sum(shares, axis=0) / count


@pytest.mark.parametrize("g", [0.7, -0.5])
def test_a_slab_reflects_and_transmits_as_a_plain_walk_does(g, rng):
    of = medium((0.9,) * 3, COUNT, extinction=(1.0,) * 3, g=g)
    exits, _ = walk(slab(2.0), nowhere, walks(0.6, of), keys(rng))
    expected = analog_walks(0.6, 0.9, g, 2.0, rng, COUNT)
    for face in (0, 1):
        mean, error = leaving(exits, face)
        spread = np.sqrt(expected[face] * (1.0 - expected[face]) / COUNT)
        assert mean[0] == pytest.approx(expected[face], abs=4.5 * np.hypot(error[0], spread))


def test_a_lossless_slab_loses_nothing(rng):
    """At the largest albedo less than 1e-3 is lost.

    Long walks are followed to their ends, at random.
    """
    count = 1000
    of = medium((0.999999,) * 3, count, extinction=(1.0,) * 3)
    exits, _ = walk(slab(20.0), nowhere, walks(1.0, of, count), keys(rng, count))
    assert np.bincount(exits.index, minlength=count).max() == 1
    carried = exits.throughput[0].sum() / count
    spread = np.sqrt(np.sum((exits.throughput[0] - 1.0) ** 2)) / count
    assert carried == pytest.approx(1.0, abs=4.5 * spread + 1e-3)


def test_walks_that_end_at_random_far_away_leave_the_mean_as_it_is(rng):
    of = medium((0.95,) * 3, COUNT, extinction=(1.0,) * 3)
    exits, _ = walk(slab(np.inf), lambda _, position: position[2] < -1.0, walks(1.0, of), keys(rng))
    mean, error = leaving(exits, 0)
    root = np.sqrt(0.05)
    at_normal = 1.0 / (root + 0.475 * (WEIGHT * h_function(0.95) * MU / (1.0 + MU)).sum())
    assert mean[0] == pytest.approx(1.0 - root * at_normal, abs=4.5 * error[0])


def test_walks_that_are_ended_early_lose_what_is_still_inside(rng):
    """From inside a half space half of the light leaves by the first free path.

    It does if it is isotropic.
    """
    of = medium((0.9,) * 3, COUNT)
    whole, _ = walk(slab(np.inf), nowhere, walks(1.0, of), keys(rng))
    short, rays = walk(slab(np.inf), nowhere, walks(1.0, of), keys(rng), most=2)
    assert rays < 2 * COUNT + 1
    mean, error = leaving(short, 0)
    # One scattering: albedo / 2 times the integral of mu / (1 + mu) over the directions.
    assert mean[0] == pytest.approx(0.45 * (1.0 - np.log(2.0)), abs=4.5 * error[0])
    assert leaving(whole, 0)[0][0] > 2.0 * mean[0]


def test_the_similar_medium_is_isotropic_and_carries_light_as_far():
    of = medium((0.9, 0.5, 0.7), 1, g=0.6)
    there = similar(of)
    assert not there.anisotropy.any()
    np.testing.assert_allclose(there.extinction * (1.0 - there.albedo), of.extinction * (1.0 - of.albedo))
    np.testing.assert_allclose(there.extinction * there.albedo, of.extinction * of.albedo * 0.4)
