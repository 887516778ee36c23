# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as a light (hard case 21).

It has a texel of 1e6, NaN texels, is black, 1 x 1, and has poles.
"""

import numpy as np
import pytest
from etalon.lib.lights.environment import EnvironmentSampler
from scipy import stats


def equirectangular(image):
    """Bilinear lookup as the conventions have it, repeating both ways.

    `image` (height, width).
    """
    height, width = image.shape

    def radiance(direction):
        x, y, z = direction
        u = (0.5 - np.arctan2(y, x) / (2.0 * np.pi)) * width - 0.5
        v = np.arccos(np.clip(z, -1.0, 1.0)) / np.pi * height - 0.5
        i, j = np.floor(v).astype(int), np.floor(u).astype(int)
        dv, du = v - i, u - j
        rows, columns = (i % height, (i + 1) % height), (j % width, (j + 1) % width)
        top = image[rows[0], columns[0]] * (1.0 - du) + image[rows[0], columns[1]] * du
        bottom = image[rows[1], columns[0]] * (1.0 - du) + image[rows[1], columns[1]] * du
        return np.broadcast_to(top * (1.0 - dv) + bottom * dv, (3, u.size)).copy()

    return radiance


def irradiance(sampler, rng, replicates=16, count=4096):
    """Replicates of the irradiance on a plane that faces +z."""
    means = []
    for _ in range(replicates):
        sample = sampler.sample(np.zeros((3, count)), *rng.random((2, count)))
        means.append((sample.radiance * np.maximum(sample.wi[2], 0.0) / sample.pdf).mean(axis=1))
    return means


MAPS = {
    "smooth": lambda rng: 1.0 + rng.random((16, 32)),
    "hot": lambda rng: np.where(np.arange(512).reshape(16, 32) == 117, 1e6, 0.5),
    "hot pole": lambda rng: np.where(np.arange(512).reshape(16, 32) < 32, 100.0, 0.1),
    "black": lambda rng: np.zeros((16, 32)),
    "one texel": lambda rng: np.full((1, 1), 2.0),
}


@pytest.fixture(params=MAPS, ids=lambda name: name.replace(" ", "_"))
def image(request, rng):
    return MAPS[request.param](rng)


def test_density_of_a_sample_is_the_density_of_its_direction(image, rng):
    sampler = EnvironmentSampler(equirectangular(image), image.shape[::-1])
    points, (u1, u2) = np.zeros((3, 5000)), rng.random((2, 5000))
    given = u1.copy(), u2.copy()
    sample = sampler.sample(points, u1, u2)
    assert np.array_equal(given, (u1, u2)), "a kernel wrote into its arguments"
    assert np.allclose((sample.wi**2).sum(axis=0), 1.0, rtol=0.0, atol=1e-14)
    assert np.isinf(sample.distance).all()
    distance, radiance = sampler.intersect(points, sample.wi)
    assert np.array_equal(radiance, sample.radiance)
    assert np.isinf(distance).all()
    # A direction on the border of two cells may fall into either.
    same = sampler.pdf(points, sample.wi, distance) == sample.pdf
    assert np.count_nonzero(~same) <= 2


def test_directions_follow_the_density(image, rng):
    """Chi-square over the cells of the map, level 1e-4.

    The expected counts also show that the density integrates to 1.
    """
    height, width = image.shape
    sampler = EnvironmentSampler(equirectangular(image), (width, height))
    edges = np.linspace(0.0, np.pi, height + 1)
    theta, phi = np.meshgrid(
        0.5 * (edges[1:] + edges[:-1]), 2.0 * np.pi * (0.5 - (np.arange(width) + 0.5) / width), indexing="ij"
    )
    centres = np.stack((np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))).reshape(3, -1)
    solid = np.repeat(-np.diff(np.cos(edges)) * 2.0 * np.pi / width, width)
    expected = sampler.pdf(None, centres, None) * solid
    assert expected.sum() == pytest.approx(1.0, rel=1e-12)
    x, y, z = sampler.sample(np.zeros((3, 40000)), *rng.random((2, 40000))).wi
    row = np.clip((np.arccos(z) / np.pi * height).astype(int), 0, height - 1)
    column = np.clip(((0.5 - np.arctan2(y, x) / (2.0 * np.pi)) * width).astype(int), 0, width - 1)
    observed = np.bincount(row * width + column, minlength=expected.size)
    expected *= 40000
    order = np.argsort(expected)
    groups = np.floor(np.cumsum(expected[order]) / 50.0).astype(int)  # neighbours in size, pooled to about 50 or more
    observed, expected = (np.bincount(groups, counts[order]) for counts in (observed, expected))
    used = expected > 0.0
    statistic = ((observed - expected)[used] ** 2 / expected[used]).sum()
    assert statistic < stats.chi2.ppf(1.0 - 1e-4, max(used.sum() - 1, 1))


@pytest.mark.parametrize("name", ["smooth", "hot", "hot pole"])
def test_irradiance_of_a_map(rng, assert_mean, name):
    """Against the midpoint rule on a grid that has the texels' own corners among its nodes."""
    image = MAPS[name](rng)
    radiance = equirectangular(image)
    fine_v, fine_u = 16 * 64, 32 * 16
    theta = (np.arange(fine_v) + 0.5) / fine_v * np.pi
    theta, u = np.meshgrid(theta[theta < np.pi / 2.0], (np.arange(fine_u) + 0.5) / fine_u, indexing="ij")
    phi = 2.0 * np.pi * (0.5 - u)
    grid = np.stack((np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))).reshape(3, -1)
    exact = (radiance(grid)[0] * grid[2] * np.sin(theta).ravel()).sum() * (np.pi / fine_v) * (2.0 * np.pi / fine_u)
    values = irradiance(EnvironmentSampler(radiance, image.shape[::-1]), rng)
    assert_mean(values, exact)
    assert np.std(values) < 0.05 * exact, "the table has to make the hot texel tame"


def test_irradiance_of_a_gradient(rng, assert_mean):
    """Radiance 1 + z, exactly pi + 2 pi / 3, with tables of any size."""
    for resolution in ((1, 1), (2, 1), (7, 5), (64, 32)):
        sampler = EnvironmentSampler(lambda w: np.broadcast_to(1.0 + w[2], w.shape), resolution)
        assert_mean(irradiance(sampler, rng, count=1024), np.pi * 5.0 / 3.0)


def test_light_that_the_probes_miss_is_still_found(rng, assert_mean):
    """A cap between the probes of cells that look black.

    The floor keeps the estimate unbiased.
    """
    sampler = EnvironmentSampler(
        lambda w: np.broadcast_to(((w[2] > 0.8) | (w[2] < 0.0)).astype(float), w.shape), (4, 2)
    )
    assert_mean(irradiance(sampler, rng, 64, 8192), np.pi * (1.0 - 0.8**2))


def test_a_cell_is_filled_evenly(rng):
    """One cell for the whole sphere: z = 1 - 2 u1, and u2 goes once round."""
    u1, u2 = rng.random((2, 1000))
    x, y, z = EnvironmentSampler(np.ones_like, (1, 1)).sample(np.zeros((3, 1000)), u1, u2).wi
    np.testing.assert_allclose(z, 1.0 - 2.0 * u1, atol=1e-14)
    np.testing.assert_allclose(0.5 - np.arctan2(y, x) / (2.0 * np.pi), u2, atol=1e-12)


def test_nan_texels_are_counted_and_passed_on(rng):
    def radiance(direction):
        return np.where((direction[2] > 0.9) & (direction[0] > 0.0), np.nan, np.ones_like(direction))

    sampler = EnvironmentSampler(radiance, (16, 16))
    assert sampler.nonfinite > 0
    assert np.isfinite(sampler.power)
    sample = sampler.sample(np.zeros((3, 20000)), *rng.random((2, 20000)))
    assert np.isfinite(sample.wi).all()
    assert np.isfinite(sample.pdf).all()
    assert np.all(sample.pdf > 0.0)
    assert np.isnan(sample.radiance).any(), "what is not finite is for the film to count, not for the sampler to hide"


def test_black_world_has_no_power(rng):
    sampler = EnvironmentSampler(np.zeros_like, (8, 4))
    assert sampler.power == 0.0
    assert np.allclose(sampler.sample(np.zeros((3, 9)), *rng.random((2, 9))).pdf, 0.25 / np.pi)


def test_power_is_the_flux_through_the_scene():
    sampler = EnvironmentSampler(np.ones_like, (16, 8), 3.0)
    assert sampler.power == pytest.approx(4.0 * np.pi * np.pi * 9.0)


def test_flux_counts_each_channel_of_the_whole_sphere():
    """Red from above, green from in front, blue half from everywhere: solid angles 2 pi, 2 pi and 4 pi."""

    def radiance(wi):
        return np.stack([wi[2] > 0.0, wi[0] > 0.0, np.full(wi.shape[1], -0.5)]).astype(float)

    sampler = EnvironmentSampler(radiance, (16, 8), 3.0)
    np.testing.assert_allclose(sampler.flux, 9.0 * np.pi * np.array([2.0 * np.pi] * 3))
