# SPDX-License-Identifier: GPL-3.0-or-later
"""Noise, cells and patterns: properties that hold for any hash, and brute force.

Their numbers are compared with Cycles elsewhere.
"""

import itertools

import numpy as np
import pytest
from etalon.lib.textures.hashes import hash_floats, hash_words, pcg
from etalon.lib.textures.noise import fbm, perlin
from etalon.lib.textures.patterns import gradient, white_noise
from etalon.lib.textures.voronoi import Shape, _nearest, _radius, _to_edge
from scipy import stats

ONE = np.float64(1.0)


def points(rng, dimensions, count=400, spread=20.0):
    return [spread * (rng.random(count) - 0.5) for _ in range(dimensions)]


def lookup3_of_nothing(seed):
    """Jenkins' final mix of three equal words in whole numbers, by the published listing."""
    mask = 0xFFFFFFFF
    words = dict.fromkeys("abc", seed)
    for target, source, k in (
        ("c", "b", 14),
        ("a", "c", 11),
        ("b", "a", 25),
        ("c", "b", 16),
        ("a", "c", 4),
        ("b", "a", 14),
        ("c", "b", 24),
    ):
        other = words[source]
        turned = ((other << k) | (other >> (32 - k))) & mask
        words[target] = ((words[target] ^ other) - turned) & mask
    return words["c"]


def test_the_hash_is_lookup3():
    zero = np.zeros(1, np.uint32)
    for count in (1, 2, 3):
        assert hash_words(*[zero] * count)[0] == lookup3_of_nothing((0xDEADBEEF + 4 * count + 13) & 0xFFFFFFFF)


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_noise_vanishes_at_whole_coordinates_and_is_continuous(dimensions, rng):
    whole = [np.round(p) for p in points(rng, dimensions)]
    np.testing.assert_allclose(perlin(whole), 0.0, atol=1e-12)
    at = [np.array([3.0 - 1e-9, 3.0 + 1e-9]), *(np.full(2, p) for p in rng.random(dimensions - 1))]
    low, high = perlin(at)
    assert low == pytest.approx(high, abs=1e-6)
    assert np.abs(perlin(points(rng, dimensions, 5000))).max() < 1.3


def test_noise_repeats_after_a_hundred_thousand_units(rng):
    near = [np.abs(p) for p in points(rng, 3)]
    far = [p + 100000.0 for p in near]
    np.testing.assert_allclose(perlin(far), perlin(near), atol=1e-6)


def test_whole_and_broken_octaves_meet(rng):
    """Detail runs through whole numbers without a step, and detail 0 is one octave."""
    at = points(rng, 3)
    below, above = (fbm(at, ONE * d, ONE * 0.5, ONE * 2.0, True) for d in (2.0 - 1e-9, 2.0 + 1e-9))
    np.testing.assert_allclose(below, above, atol=1e-7)
    np.testing.assert_allclose(fbm(at, ONE * 0.0, ONE * 0.5, ONE * 2.0, True), 0.5 + 0.5 * perlin(at))


@pytest.mark.parametrize("dimensions", [2, 3, 4])
def test_the_nearest_point_is_nearest_among_more_cells(dimensions, rng):
    """The truth comes from trying every cell two steps around.

    Blender looks one step far, which suffices for the nearest point of random ones, mostly.
    """
    shape = Shape("EUCLIDEAN", ONE, ONE, ONE * 0.0)
    at = np.array(points(rng, dimensions, 300))
    base = np.floor(at)
    offsets = [np.array(o, float)[:, None] for o in itertools.product(range(-2, 3), repeat=dimensions)]
    sites = np.stack([base + o + pcg(base + o) for o in offsets])
    distance = np.sort(np.sqrt(((sites - at) ** 2).sum(axis=1)), axis=0)
    first, second = _nearest(at, shape, 1), _nearest(at, shape, 2)
    assert np.mean(np.abs(first.distance - distance[0]) > 1e-12) < 0.02
    assert np.mean(np.abs(second.distance - distance[1]) > 1e-12) < 0.15
    assert (first.distance >= distance[0] - 1e-12).all()
    np.testing.assert_allclose(np.sqrt(((first.position - at) ** 2).sum(axis=0)), first.distance, atol=1e-12)


def test_at_a_wall_the_two_nearest_are_as_far(rng):
    """Where the distance to the edge is small, so is that between the two nearest points.

    The latter is the difference between first and second distance.
    """
    shape = Shape("EUCLIDEAN", ONE, ONE, ONE * 0.0)
    at = np.array(points(rng, 2, 20000))
    edge = _to_edge(at, shape)
    gap = _nearest(at, shape, 2).distance - _nearest(at, shape, 1).distance
    assert (gap <= 2.0 * edge + 1e-9).mean() > 0.999
    assert (_radius(at, shape) > 0.0).all()


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4])
def test_white_noise_is_uniform(dimensions, rng):
    values = white_noise(points(rng, dimensions, 20000), True)
    for channel in values:
        assert stats.kstest(channel, "uniform").pvalue > 1e-4 / 12
    assert hash_floats(1.0) != hash_floats(2.0)


def test_gradients_by_their_formulas():
    x = np.array([[-0.5, 0.25, 0.5, 2.0], [0.0, 0.5, 0.5, 0.0], [0.0, 0.0, 0.0, 0.0]])
    np.testing.assert_allclose(gradient("LINEAR", x), [0.0, 0.25, 0.5, 1.0])
    np.testing.assert_allclose(gradient("QUADRATIC", x), [0.0, 0.0625, 0.25, 1.0])
    np.testing.assert_allclose(gradient("EASING", x), [0.0, 0.15625, 0.5, 1.0])
    np.testing.assert_allclose(gradient("DIAGONAL", x), [0.0, 0.375, 0.5, 1.0])
    np.testing.assert_allclose(gradient("RADIAL", x), [1.0, 0.5 + np.arctan(2.0) / (2.0 * np.pi), 0.625, 0.5])
    np.testing.assert_allclose(
        gradient("SPHERICAL", x), [0.499999, 0.999999 - np.hypot(0.25, 0.5), 0.999999 - 0.5**0.5, 0.0], atol=1e-12
    )
