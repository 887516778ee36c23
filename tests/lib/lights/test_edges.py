# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights at the edge of their domain (hard cases 15, 16 and 22).

They are finite, defined, and give no floating-point warning.
"""

import math
from dataclasses import replace

import mpmath
import numpy as np
import pytest
from etalon.lib.lights.build import light_sampler
from etalon.lib.lights.spread import Spread
from etalon.lib.scene.lights import AreaLight, Cone, PointLight, SphereLight, SpotLight, SunLight

WHITE = (1.0, 1.0, 1.0)
AREA = AreaLight(
    "area", (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", WHITE, math.pi
)
POINT = PointLight("point", (0.0, 0.0, 1.0), WHITE)
CONE = Cone((0.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1.0, 0.15)
SPOT = SpotLight("spot", (0.0, 0.0, 1.0), 0.0, WHITE, CONE)


def points_about(rng, count=400):
    points = rng.uniform(-2.0, 2.0, (3, count))
    points[:, 0] = (0.0, 0.0, 1.0)  # in the middle of every light here
    points[:, 1] = (0.5, 0.5, 1.0)  # at the rectangle's corner
    points[:, 2] = (7.0, 0.0, 1.0)  # in its plane
    return points


EDGES = {
    "no width": replace(AREA, edge_u=(0.0, 0.0, 0.0)),
    "edges in line": replace(AREA, edge_v=(2.0, 0.0, 0.0)),
    "no area, ellipse": replace(AREA, edge_v=(0.0, 0.0, 0.0), shape="ELLIPSE"),
    "no area, no spread": replace(AREA, edge_v=(0.0, 0.0, 0.0), spread=0.0),
    "no radiance": replace(AREA, radiance=(0.0, 0.0, 0.0)),
    "black point": replace(POINT, intensity=(0.0, 0.0, 0.0)),
    "spot of 0 degrees": SPOT,
    "spot of 0 degrees with a step": replace(SPOT, cone=replace(CONE, blend=0.0)),
    "sphere spot of 0 degrees": replace(SPOT, radius=0.2),
}


@pytest.mark.parametrize("name", EDGES)
def test_a_light_that_emits_nothing_lights_nothing(name, rng):
    light = EDGES[name]
    sampler = light_sampler(light, 1.0)
    assert sampler.power == 0.0
    points = points_about(rng)
    if light is EDGES["sphere spot of 0 degrees"]:
        points = points[:, np.linalg.norm(points - [[0.0], [0.0], [1.0]], axis=0) > 0.2]  # its inside is not dimmed
    sample = sampler.sample(points, *rng.random((2, points.shape[1])))
    assert not sample.radiance.any()
    assert np.all(sample.pdf > 0.0)
    assert np.isfinite(sample.wi).all()
    if not sampler.delta:
        assert not sampler.intersect(points, sample.wi)[1].any()


ODD = {
    "negative power": replace(POINT, intensity=(-1.0, -2.0, -1.0)),
    "point": POINT,
    "spot of 180 degrees": replace(SPOT, cone=replace(CONE, cos_half_angle=0.0)),
    "spot of 180 degrees with a step": replace(
        SPOT, cone=replace(CONE, cos_half_angle=math.cos(math.pi / 2.0), blend=0.0)
    ),
    "sphere spot of 180 degrees": replace(SPOT, radius=0.3, cone=replace(CONE, cos_half_angle=0.0)),
    "sliver": replace(AREA, edge_u=(1e-9, 0.0, 0.0)),
    "narrow spread": replace(AREA, spread=1e-6),
    "almost no narrowing": replace(AREA, spread=math.pi - 1e-9),
    "ellipse sliver": replace(AREA, edge_v=(0.0, 1e-9, 0.0), shape="ELLIPSE"),
    "needle of a sun": SunLight("sun", (0.0, 0.0, 1.0), 1e-9, WHITE),
    "sun of 180 degrees": SunLight("sun", (0.0, 0.0, 1.0), math.pi / 2.0, WHITE),
    "sphere": SphereLight("sphere", (0.0, 0.0, 1.0), 0.5, WHITE),
    "speck": SphereLight("sphere", (0.0, 0.0, 1.0), 1e-12, WHITE),
}


@pytest.mark.parametrize("name", ODD)
def test_odd_lights_stay_finite(name, rng):
    sampler = light_sampler(ODD[name], 1.0)
    points = points_about(rng)
    sample = sampler.sample(points, *rng.random((2, points.shape[1])))
    for array in (sample.wi, sample.radiance, sample.pdf):
        assert np.isfinite(array).all()
    assert np.all(sample.pdf > 0.0)
    assert not np.isnan(sample.distance).any()
    if not sampler.delta:
        distance, radiance = sampler.intersect(points, sample.wi)
        assert not np.isnan(distance).any()
        assert np.isfinite(radiance).all()
        pdf = sampler.pdf(points, sample.wi, distance)
        assert np.isfinite(pdf).all()
        assert np.all(pdf >= 0.0)


def test_negative_light_takes_away(rng):
    sampler = light_sampler(ODD["negative power"], 1.0)
    assert sampler.power > 0.0
    assert np.all(sampler.sample(np.zeros((3, 5)), *rng.random((2, 5))).radiance < 0.0)


@pytest.mark.parametrize("shape", ["RECTANGLE", "ELLIPSE"])
def test_normal_says_which_side_shines_whatever_the_order_of_the_edges(shape, rng):
    """A mirrored object has the edges the other way round."""
    for edge_u, edge_v in ((AREA.edge_u, AREA.edge_v), (AREA.edge_v, AREA.edge_u)):
        sampler = light_sampler(replace(AREA, edge_u=edge_u, edge_v=edge_v, shape=shape), 1.0)
        below, above = np.zeros((3, 8)), np.full((3, 8), 2.0)
        u = rng.random((2, 8))
        assert sampler.sample(below, *u).radiance.all()
        assert not sampler.sample(above, *u).radiance.any()


@pytest.mark.parametrize("gap", [1e8, 1e3, 1.0, 1e-3, 1e-9])
def test_solid_angle_of_a_sphere(gap):
    """Hard case 16, from `gap` outside a sphere of 1 m.

    The truth is 2 pi (1 - cos) by 50 digits, given the distance as a double.
    """
    distance = 1.0 + gap
    sampler = light_sampler(SphereLight("sphere", (0.0, 0.0, 0.0), 1.0, WHITE), 1.0)
    origin = np.array([[0.0], [0.0], [-distance]])
    toward = np.array([[0.0], [0.0], [1.0]])
    reach, _ = sampler.intersect(origin, toward)
    assert reach[0] == pytest.approx(distance - 1.0, rel=1e-12 if gap < 1e3 else 1e-7)
    with mpmath.workdps(50):
        solid = 2 * mpmath.pi * (1 - mpmath.sqrt(1 - 1 / mpmath.mpf(distance) ** 2))
        # Just outside, one ulp of the squared distance already moves the cosine: condition 1 / gap under the root.
        tolerance = 1e-14 + 4e-16 / math.sqrt(2.0 * min(gap, 1.0))
        assert sampler.pdf(origin, toward, reach)[0] == pytest.approx(float(1 / solid), rel=tolerance)


def test_sphere_from_very_far_is_still_met(rng):
    """1 mm at 10,000 km: sampled directions hit it."""
    sampler = light_sampler(SphereLight("sphere", (0.0, 0.0, 0.0), 1e-3, WHITE), 1.0)
    origin = np.ascontiguousarray(np.broadcast_to([[6e6], [0.0], [-8e6]], (3, 1000)))
    sample = sampler.sample(origin, *rng.random((2, 1000)))
    distance, _ = sampler.intersect(origin, sample.wi)
    assert np.count_nonzero(np.isfinite(distance)) >= 999


def test_inside_a_sphere_the_cone_does_not_dim(rng):
    """As in Cycles (measured); just outside it does."""
    sampler = light_sampler(ODD["sphere spot of 180 degrees"], 1.0)
    for height, lit in ((1.2, True), (1.31, False)):  # above the light, behind the half space that the cone fills
        points = np.ascontiguousarray(np.broadcast_to([[0.0], [0.0], [height]], (3, 200)))
        sample = sampler.sample(points, *rng.random((2, 200)))
        seen = sampler.intersect(points, sample.wi)[1]
        assert np.all(sample.radiance == 1.0) == lit
        assert np.all(seen == 1.0) == lit


@pytest.mark.parametrize("spread", [1e-8, 1e-3, 0.0599999, 0.0600001, 0.2, 1.0, 3.0, math.pi - 1e-6])
def test_scale_of_the_spread(spread):
    """At angle 0: tan h / (tan h - h), by 50 digits.

    1e-12 just above the switch from the series.
    """
    with mpmath.workdps(50):
        h = mpmath.mpf(spread) / 2
        exact = float(mpmath.tan(h) / (mpmath.tan(h) - h))
    assert Spread(spread)(np.zeros(1))[0] == pytest.approx(exact, rel=1e-12 if spread < 3.0 else 1e-9)


@pytest.mark.parametrize("spread", [math.pi, 1.0])
@pytest.mark.parametrize("behind", [0.05, 0.5, 1.0])
def test_points_behind_a_rectangle_get_no_light_and_change_no_other_sample(behind, spread, rng):
    sampler = light_sampler(replace(AREA, spread=spread), 1.0)
    size = 400
    points = rng.uniform(-2.0, 2.0, (3, size))
    points[:2] *= rng.choice([1.0, 20.0], size)  # near and far: sampled by solid angle and by area
    points[2] = rng.uniform(-1.0, 0.99, size)
    back = rng.permutation(size)[: round(behind * size)]
    points[2, back] = rng.uniform(1.0, 3.0, back.size)
    uniforms = rng.random((2, size))
    sample = sampler.sample(points, *uniforms)
    assert not sample.radiance[:, back].any()
    assert np.isfinite(sample.pdf).all()
    assert (sample.pdf > 0.0).all()
    np.testing.assert_allclose((sample.wi**2).sum(axis=0), 1.0, rtol=1e-12)
    front = np.setdiff1d(np.arange(size), back)
    for k in front[:50]:
        alone = sampler.sample(points[:, [k]], *uniforms[:, [k]])
        for whole, one in zip(sample, alone, strict=True):
            np.testing.assert_array_equal(whole[..., [k]], one)
