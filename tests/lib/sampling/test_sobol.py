# SPDX-License-Identifier: GPL-3.0-or-later
"""Sobol' pairs are nets where nets are promised.

They are uniform and independent wherever samples are averaged.
"""

import math

import numpy as np
import pytest
from etalon.lib.sampling.sobol import RandomSampler, SobolSampler, owen_scramble, sobol_pairs
from etalon.tests.chi2 import sidak
from scipy import stats
from scipy.stats import qmc

LEVEL = 1e-4
DIMENSIONS = (0, 1, 2, 3, 7, 40)


def pairs(sampler, pixels, dimension):
    """Pairs of all samples of the pixels, two arrays (pixels, samples)."""
    pixels = np.asarray(pixels)
    pixel = np.repeat(np.arange(pixels.size), sampler.samples)
    sample = np.tile(np.arange(sampler.samples), pixels.size)
    u1, u2 = sampler.tile(pixels).pair(dimension, pixel, sample)
    return u1.reshape(pixels.size, -1), u2.reshape(pixels.size, -1)


def is_net(u1, u2):
    """Whether each row's n points are a (0, m, 2)-net in base 2.

    Every elementary interval of area 1 / n then holds one of them.
    """
    count = u1.shape[1]
    log2 = count.bit_length() - 1
    for k in range(log2 + 1):
        cell = np.floor(u1 * 2**k) * 2 ** (log2 - k) + np.floor(u2 * 2 ** (log2 - k))
        if not np.array_equal(np.sort(cell, axis=1), np.broadcast_to(np.arange(count), cell.shape)):
            return False
    return True


@pytest.mark.parametrize("log2", [0, 1, 2, 4, 7, 10])
def test_every_pixel_and_dimension_is_a_net(log2, seed):
    sampler = SobolSampler(seed, 3, 2**log2)
    for dimension in DIMENSIONS:
        assert is_net(*pairs(sampler, np.arange(200, 264), dimension))


def test_the_net_test_sees_what_is_no_net(rng):
    u1, u2 = rng.random((2, 1, 64))
    assert not is_net(u1, u2)
    x, y = sobol_pairs(6) * 2.0**-32
    assert is_net(x[None], y[None])
    assert not is_net(x[None], ((y + 0.3) % 1.0)[None])


def test_sobol_is_the_van_der_corput_sequence_and_its_partner():
    """The first dimension is the index with its bits turned round; both begin 0, 1/2."""
    x, y = sobol_pairs(8)
    index = np.arange(256)
    reversed_bits = np.array([int(f"{i:08b}"[::-1], 2) for i in index]) / 256.0
    np.testing.assert_array_equal(np.sort(x * 2.0**-32), np.sort(reversed_bits))
    assert is_net((x * 2.0**-32)[None], (y * 2.0**-32)[None])


def test_sobol_points_are_those_of_scipy():
    """SciPy visits the same points by Gray code."""
    expected = qmc.Sobol(2, scramble=False, bits=32).random_base2(9).T
    index = np.arange(512)
    np.testing.assert_array_equal(sobol_pairs(9)[:, index ^ index >> 1] * 2.0**-32, expected)


def common_bits(x, y):
    """How many leading bits of 32 two arrays share."""
    return np.array([32 - int(v).bit_length() for v in (np.asarray(x, np.uint64) ^ np.asarray(y, np.uint64)).ravel()])


@pytest.mark.parametrize("depth", [1, 6, 11])
def test_owen_scrambling_keeps_what_bits_share(depth, rng):
    """Two points that agree in their first k bits, and not in the next.

    They do so after nested scrambling too.
    """
    a, b = rng.integers(0, 2**depth, (2, 3000), dtype=np.uint64)
    a, b = a[a != b], b[a != b]
    scrambled = owen_scramble(depth, np.array([987654321], np.uint64))
    shift = np.uint64(32 - depth)
    np.testing.assert_array_equal(common_bits(scrambled[a], scrambled[b]), common_bits(a << shift, b << shift))


@pytest.mark.parametrize("depth", [0, 5])
def test_owen_scrambling_makes_any_point_uniform(depth, rng):
    """Over keys, the image of one fixed point is uniform."""
    keys = rng.integers(0, 2**63, 4000, dtype=np.uint64)
    for point in {0, 2**depth // 3, 2**depth - 1}:
        u = owen_scramble(depth, keys[:, None])[:, point] * 2.0**-32
        assert stats.kstest(u, "uniform").pvalue > sidak(LEVEL, 4)


def test_owen_scrambling_makes_bits_independent(rng):
    """Over keys, the flips of three levels and three bits below them are fair coins.

    They go together by chance only.
    """
    keys = rng.integers(0, 2**63, 20_000, dtype=np.uint64)
    u = owen_scramble(3, keys[:, None])
    columns = []
    for level, points in ((0, (0,)), (1, (0, 4)), (2, (0, 2, 4, 6)), (3, range(8)), (4, range(8)), (5, range(8))):
        columns += [(u[:, [point]] >> np.uint64(31 - level)) & np.uint64(1) for point in points]
    columns = np.concatenate(columns, axis=1).astype(float)
    n, k = columns.shape
    level = sidak(LEVEL, k + k * (k - 1) // 2)
    quantile = stats.norm.isf(0.5 * level) / math.sqrt(n)
    assert np.abs(2.0 * columns.mean(axis=0) - 1.0).max() < quantile
    assert np.abs(np.corrcoef(columns.T)[np.triu_indices(k, 1)]).max() < quantile


@pytest.mark.grid(3)
@pytest.mark.parametrize("sampler", [SobolSampler, RandomSampler])
@pytest.mark.parametrize("samples", [1, 5, 16])
def test_each_sample_is_uniform_over_replicates(sampler, samples, seed):
    """The fact that makes a pixel unbiased.

    Any one sample of any one pixel, over scramblings, is uniform in the square.
    """
    drawn = np.array(
        [[pairs(sampler(seed, r, samples), [17, 18], d) for d in (0, 5)] for r in range(300)]
    )  # (replicates, dimensions, 2, pixels, samples)
    assert drawn.min() >= 0.0
    assert drawn.max() < 1.0
    level = sidak(LEVEL, 2 * 2 * 2 * 2)
    for d in range(2):
        for pixel in range(2):
            for at in {0, samples - 1}:
                u1, u2 = drawn[:, d, 0, pixel, at], drawn[:, d, 1, pixel, at]
                assert stats.kstest(u1, "uniform").pvalue > level
                assert stats.kstest(u2, "uniform").pvalue > level
                counts = np.histogram2d(u1, u2, 4, [[0.0, 1.0], [0.0, 1.0]])[0]
                assert stats.chisquare(counts.ravel()).pvalue > level


def largest_correlation(columns):
    """The probability of so large a rank correlation between any two columns.

    Columns are (n, k), all pairs together.
    """
    n, k = columns.shape
    rho = np.abs(np.corrcoef(stats.rankdata(columns, axis=0).T)[np.triu_indices(k, 1)]).max()
    one = 2.0 * stats.norm.sf(rho * math.sqrt(n - 1.0))
    return -np.expm1(0.5 * k * (k - 1) * np.log1p(-one))


@pytest.mark.parametrize("samples", [1, 16, 24])
def test_dimensions_are_independent(samples, seed):
    """Every coordinate of one path against every other of six dimensions.

    They are tested over pixels and replicates.
    """
    drawn = []
    for r in range(8):
        sampler = SobolSampler(seed, r, samples)
        drawn.append([u.ravel() for d in DIMENSIONS for u in pairs(sampler, np.arange(400, 700), d)])
    # Stratification makes whole sets less scattered than independent points, never more alike.
    assert largest_correlation(np.concatenate(drawn, axis=1).T) > LEVEL


def test_dimensions_are_independent_jointly(seed):
    """First coordinates of two dimensions in 8 x 8 cells.

    Dimensions are padded by independent random orders, not the same one.
    """
    sampler = SobolSampler(seed, 0, 16)
    for a, b in ((0, 1), (2, 3), (3, 7)):
        x, y = (pairs(sampler, np.arange(2000), d)[0].ravel() for d in (a, b))
        counts = np.histogram2d(x, y, 8, [[0.0, 1.0], [0.0, 1.0]])[0]
        assert stats.chisquare(counts.ravel(), ddof=14).pvalue > sidak(LEVEL, 3)


def test_dimensions_are_padded_within_a_pixel(seed):
    """In one pixel two dimensions are paired at random.

    Mean products scatter by 1 / (144 n), as for independent orders, not as on a curve.
    """
    sampler = SobolSampler(seed, 0, 64)
    for a, b in ((0, 1), (2, 5), (3, 7)):
        for k in range(2):
            u, v = (pairs(sampler, np.arange(2000), d)[k] - 0.5 for d in (a, b))
            assert 0.7 < 144.0 * 64.0 * (u * v).mean(axis=1).var() < 1.4


def test_pixels_are_independent(seed):
    """Neighbours and pixels a row apart, over replicates: means of pixels do not go together."""
    pixels = [0, 1, 2, 3, 32, 64, 512, 513]
    means = []
    for r in range(250):
        u1, u2 = pairs(SobolSampler(seed, r, 4), pixels, 2)
        # A function that stratification does not make constant.
        means.append((np.sin(9.0 * u1) * u2).mean(axis=1))
    assert largest_correlation(np.array(means)) > LEVEL


def test_replicates_are_independent(seed):
    u = np.array([pairs(SobolSampler(seed, r, 16), np.arange(300), 2)[0].ravel() for r in range(8)])
    assert largest_correlation(u.T) > LEVEL
    assert np.unique(u[:, 0]).size == 8


@pytest.mark.parametrize("samples", [3, 6, 12, 37])
def test_any_number_of_samples_is_unbiased(samples, seed):
    """Part of a net, in random order.

    The mean of a rough function over replicates is its integral.
    """
    means = []
    for r in range(150):
        u1, u2 = pairs(SobolSampler(seed, r, samples), np.arange(64), 1)
        means.append(((u1 < 0.3) & (u2 > 0.6)).mean() + (u1 * u2).mean())
    error = stats.sem(means)
    assert error < 4e-3
    assert abs(np.mean(means) - 0.12 - 0.25) < stats.t.ppf(1.0 - 0.5 * sidak(LEVEL, 4), 149) * error


def test_a_net_integrates_better_than_random_points(seed):
    """Owen: variance falls as n^-3 for a smooth function.

    At 256 points that is hundreds of times less.
    """
    variances = []
    for make in (SobolSampler, RandomSampler):
        u1, u2 = (np.concatenate(x) for x in zip(*(pairs(make(seed, r, 256), [r], 1) for r in range(100)), strict=True))
        variances.append((np.exp(u1) * np.cos(u2)).mean(axis=1).var())
    assert variances[0] < variances[1] / 100.0


def test_uniforms_never_reach_the_ends():
    """The largest and smallest points, whatever the shift.

    They lie within (0, 1), so that log(1 - u) is finite.
    """
    for samples in (1, 2**12):
        u = np.concatenate([v.ravel() for v in pairs(SobolSampler(0, 0, samples), np.arange(64), 0)])
        assert u.min() >= 2.0**-33
        assert u.max() <= 1.0 - 2.0**-33


def test_a_tile_sees_the_same_points_as_the_image(seed):
    """A pixel's pairs depend on its place in the image.

    They depend neither on the tile it is rendered in nor on the other samples.
    """
    sampler = SobolSampler(seed, 0, 16)
    whole = pairs(sampler, np.arange(100), 3)
    alone = pairs(sampler, [57], 3)
    np.testing.assert_array_equal(whole[0][57], alone[0][0])
    some = sampler.tile(np.array([56, 57])).pair(3, np.array([1, 1, 0]), np.array([15, 3, 2]))
    np.testing.assert_array_equal(some[1], [whole[1][57, 15], whole[1][57, 3], whole[1][56, 2]])
