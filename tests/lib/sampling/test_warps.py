# SPDX-License-Identifier: GPL-3.0-or-later
"""Warps against their densities: chi-square on the sphere, moments and areas in the plane."""

import numpy as np
import pytest
from etalon.lib.sampling.warps import circle, cosine_hemisphere, regular_polygon, uniform_disk, uniform_hemisphere
from etalon.tests.chi2 import Tangents, chi_square, sidak
from scipy import stats

LEVEL = 1e-4
COUNT = 100_000


@pytest.mark.parametrize(
    ("warp", "density"),
    [
        (cosine_hemisphere, lambda w: np.maximum(w[2], 0.0) / np.pi),
        (uniform_hemisphere, lambda w: np.where(w[2] > 0.0, 0.5 / np.pi, 0.0)),
    ],
    ids=["cosine", "uniform"],
)
def test_hemispheres(warp, density, rng):
    wi = warp(*rng.random((2, COUNT)))
    np.testing.assert_allclose((wi * wi).sum(axis=0), 1.0, rtol=1e-14)
    assert chi_square(wi, density, Tangents(1.0, 1.0)).p_value > LEVEL


def test_the_documents_lambert(rng):
    """phi = 2 pi xi1 theta = acos(sqrt(1 - xi2))."""
    u1, u2 = rng.random((2, 1000))
    wi = cosine_hemisphere(u1, u2)
    np.testing.assert_allclose(np.arccos(wi[2]), np.arccos(np.sqrt(1.0 - u2)), rtol=1e-12)
    np.testing.assert_allclose(np.arctan2(wi[1], wi[0]) / (2.0 * np.pi) % 1.0, u1, atol=1e-12)


def test_circle_is_cosine_and_sine(rng):
    u = np.concatenate([rng.random(1000), [0.0, 0.25, 0.5, 0.75, 1.0, 2.0**-33, 1.0 - 2.0**-33]])
    x, y = circle(u)
    angle = 2.0 * np.pi * u
    np.testing.assert_allclose(x, np.cos(angle), atol=1e-15)
    np.testing.assert_allclose(y, np.sin(angle), atol=1e-15)


def test_the_ends_of_the_square():
    """Uniforms 0 and 1 give unit vectors, not NaN."""
    u1, u2 = (g.ravel() for g in np.meshgrid([0.0, 0.5, 1.0], [0.0, 1.0]))
    for warp in (cosine_hemisphere, uniform_hemisphere):
        wi = warp(u1, u2)
        np.testing.assert_allclose((wi * wi).sum(axis=0), 1.0, rtol=1e-14)
        assert wi[2].min() >= 0.0
    assert np.isfinite(uniform_disk(u1, u2)).all()
    assert np.isfinite(regular_polygon(u1, u2, 5, 0.3)).all()


def test_uniform_disk(rng):
    x, y = uniform_disk(*rng.random((2, COUNT)))
    assert stats.kstest(x * x + y * y, "uniform").pvalue > sidak(LEVEL, 3)  # r^2 is uniform
    assert stats.kstest(np.arctan2(y, x), "uniform", (-np.pi, 2.0 * np.pi)).pvalue > sidak(LEVEL, 3)
    assert abs(stats.spearmanr(x * x + y * y, np.arctan2(y, x)).statistic) < 4.5 / np.sqrt(COUNT)


@pytest.mark.parametrize("sides", [3, 4, 5, 8])
def test_polygon_is_uniform(sides, rng):
    """All points lie inside every edge.

    Each cell of a grid has as many points as its area says; cells that the outline cuts are pooled.
    """
    rotation = 0.4
    x, y = regular_polygon(*rng.random((2, COUNT)), sides, rotation)
    normal = rotation + 2.0 * np.pi * np.arange(sides) / sides  # corners lie half a step from the edges' normals
    inradius = np.cos(np.pi / sides)
    reach = np.cos(normal)[:, None] * x + np.sin(normal)[:, None] * y
    assert reach.max() <= inradius + 1e-12
    assert reach.max() > inradius - 1e-3, "the rim is reached"
    edges = np.linspace(-1.0, 1.0, 13)
    counts = np.histogram2d(x, y, (edges, edges))[0]
    corner_x, corner_y = np.meshgrid(edges, edges, indexing="ij")
    inside = (np.cos(normal) * corner_x[..., None] + np.sin(normal) * corner_y[..., None] <= inradius).all(axis=-1)
    whole = inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:]
    area = 0.5 * sides * np.sin(2.0 * np.pi / sides)
    share = (1.0 / 6.0) ** 2 / area
    observed = np.append(counts[whole], COUNT - counts[whole].sum())
    expected = COUNT * np.append(np.full(whole.sum(), share), 1.0 - whole.sum() * share)
    assert whole.sum() > 20
    assert stats.chisquare(observed, expected).pvalue > sidak(LEVEL, 4)


def test_no_warp_writes_into_its_arguments(rng):
    u = rng.random((2, 50))
    u.flags.writeable = False
    for warp in (cosine_hemisphere, uniform_hemisphere, uniform_disk):
        warp(*u)
    circle(u[0])
    regular_polygon(*u, 6, 0.0)
