# SPDX-License-Identifier: GPL-3.0-or-later
"""sample, intersect and pdf of a light speak of the same light."""

import numpy as np
import pytest
from etalon.lib.lights.area import AreaSampler

POINTS = {
    "near": np.array([[0.1], [0.3], [0.4]]),
    "aside": np.array([[-2.0], [1.0], [1.2]]),
    "very_near": np.array([[0.3], [-0.2], [1.7]]),
    "far": np.array([[30.0], [-40.0], [-500.0]]),
    "inside_a_sphere": np.array([[0.3], [0.0], [2.1]]),
}


@pytest.fixture(params=POINTS)
def point(request):
    return POINTS[request.param]


def repeat(point, count):
    return np.ascontiguousarray(np.broadcast_to(point, (3, count)))


def test_a_sampled_direction_hits_where_it_was_aimed(extended, point, rng):
    points = repeat(point, 2000)
    u1, u2 = rng.random((2, 2000))
    given = points.copy(), u1.copy(), u2.copy()
    sample = extended.sample(points, u1, u2)
    assert np.allclose((sample.wi**2).sum(axis=0), 1.0, rtol=0.0, atol=1e-14)
    assert np.all(sample.pdf > 0.0)
    assert np.isfinite(sample.pdf).all()
    lit = sample.radiance.any(axis=0)
    if isinstance(extended, AreaSampler) and point[2, 0] > 2.0:
        assert not lit.any()
        return
    distance, radiance = extended.intersect(points, sample.wi)
    # The rim itself may fall on either side by rounding.
    agree = np.isclose(distance, sample.distance, rtol=1e-8, atol=0.0)
    assert np.count_nonzero(lit & ~agree) <= 2
    both = lit & agree
    np.testing.assert_allclose(radiance[:, both], sample.radiance[:, both], rtol=1e-6)
    np.testing.assert_allclose(extended.pdf(points, sample.wi, distance)[both], sample.pdf[both], rtol=1e-8)
    for before, after in zip(given, (points, u1, u2), strict=True):
        assert np.array_equal(before, after), "a kernel wrote into its arguments"


@pytest.mark.grid(3)
def test_directions_follow_the_density(extended, point, rng, assert_directions):
    if isinstance(extended, AreaSampler) and point[2, 0] > 2.0:
        return
    count = 40000
    points = repeat(point, count)
    sample = extended.sample(points, *rng.random((2, count)))

    def pdf(direction):
        origin = repeat(point, direction.shape[1])
        return extended.pdf(origin, direction, extended.intersect(origin, direction)[0])

    reached = pdf(sample.wi) > 0.0
    assert not sample.radiance[:, ~reached].any(), (
        "only an ellipse's spread may aim beyond the rim, and finds nothing there"
    )
    kept = sample.wi[:, reached]
    if not kept.size:  # a narrow spread does not reach the point
        return
    axis = kept.mean(axis=1)
    axis /= np.linalg.norm(axis)
    widest = np.arccos(np.clip((axis @ kept).min(), -1.0, 1.0))
    if widest < 1e-3:  # seen from far away: arccos has no digits
        widest = np.sqrt(((kept - axis[:, None]) ** 2).sum(axis=0).max())
    assert_directions(kept, count, pdf, axis, min(1.02 * widest, np.pi))


def test_nothing_behind_an_area_light(extended, rng):
    if not isinstance(extended, AreaSampler):
        return
    points = np.vstack((rng.uniform(-2.0, 2.0, (2, 500)), rng.uniform(2.0, 4.0, 500)))
    points[2, 0] = 2.0
    sample = extended.sample(points, *rng.random((2, 500)))
    assert not sample.radiance.any()
    assert np.all(sample.pdf > 0.0)
    direction = rng.standard_normal((3, 500))
    direction /= np.linalg.norm(direction, axis=0)
    distance, radiance = extended.intersect(points, direction)
    assert np.isinf(distance).all()
    assert not radiance.any()
    assert not extended.pdf(points, direction, distance).any()


def test_every_ray_that_meets_a_light_is_a_candidate(extended, rng):
    """From inside to 10,000 km away, aimed at the outline.

    What is clearly aimed elsewhere is left out.
    """
    away = rng.standard_normal((3, 20000))
    away *= 10.0 ** rng.uniform(-2.0, 7.0, 20000) / np.linalg.norm(away, axis=0)
    points = away + np.array([[0.2], [0.0], [1.5]])
    wi = extended.sample(
        points, rng.random(20000), np.where(rng.random(20000) < 0.5, 1.0 - 1e-12, rng.random(20000))
    ).wi
    distance, radiance = extended.intersect(points, wi)
    met = np.flatnonzero(np.isfinite(distance) | radiance.any(axis=0))
    assert met.size > 1000
    assert np.isin(met, extended.candidates(points, wi)).all()
    far = np.flatnonzero((away**2).sum(axis=0) > 9.0)
    assert extended.candidates(points[:, far], -wi[:, far]).size < 0.01 * far.size
