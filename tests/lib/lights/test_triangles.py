# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive triangles as one light."""

import numpy as np
import pytest
from etalon.lib.lights.triangles import EmissiveTriangles


@pytest.fixture
def box():
    """A 1 x 2 x 3 box of 12 triangles near the origin.

    It has corners, edges, and indices in a larger scene.
    """
    corners = np.array([[x, y, z] for x in (1.0, 2.0) for y in (-1.0, 1.0) for z in (1.0, 4.0)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    first, second, third = (corners[triangles[:, k]].T for k in range(3))
    return first, second - first, third - first, 10 + 2 * np.arange(12)


def test_a_box_seen_from_outside_and_inside(box, rng, assert_mean):
    """Both faces shine.

    From inside the solid angles add to 4 pi, from outside every direction that hits counts twice.
    """
    first, edge1, edge2, index = box
    light = EmissiveTriangles(first, edge1, edge2, index, rng.random(12) + 0.1)
    for point, crossings in (((1.5, 0.0, 2.0), 1.0), ((1.5, 0.0, -50.0), 2.0)):
        points = np.ascontiguousarray(np.broadcast_to(np.reshape(point, (3, 1)), (3, 4096)))
        values = []
        for _ in range(16):
            sample = light.sample(points, *rng.random((2, 4096)))
            values.append((1.0 / sample.pdf).mean())
        if crossings == 1.0:
            assert_mean(values, 4.0 * np.pi)
        else:
            # Seen face on from below: the nearest face hides the others, and each ray meets the box twice or not at all.
            z, half_x, half_y = 51.0, 0.5, 1.0
            face = 4.0 * np.arcsin(half_x * half_y / np.sqrt((half_x**2 + z * z) * (half_y**2 + z * z)))
            assert_mean(values, crossings * face)


def test_sample_lies_on_its_triangle(box, rng):
    first, edge1, edge2, index = box
    light = EmissiveTriangles(first, edge1, edge2, index, rng.random(12))
    points, (u1, u2) = rng.uniform(-5.0, 5.0, (3, 3000)), rng.random((2, 3000))
    given = points.copy(), u1.copy(), u2.copy()
    sample = light.sample(points, u1, u2)
    for before, after in zip(given, (points, u1, u2), strict=True):
        assert np.array_equal(before, after), "a kernel wrote into its arguments"
    which = (sample.triangle - 10) // 2
    place = first[:, which] + sample.b1 * edge1[:, which] + sample.b2 * edge2[:, which]
    np.testing.assert_allclose(points + sample.distance * sample.wi, place, atol=1e-12)
    assert np.all((sample.b1 >= 0.0) & (sample.b2 >= 0.0) & (sample.b1 + sample.b2 <= 1.0))
    normal = np.cross(edge1[:, which], edge2[:, which], axis=0)
    normal /= np.linalg.norm(normal, axis=0)
    np.testing.assert_allclose(sample.facing, -(normal * sample.wi).sum(axis=0), atol=1e-12)
    np.testing.assert_array_equal(light.pdf_of_hit(sample.triangle, sample.distance, sample.facing), sample.pdf)


def test_choice_follows_the_power(box, rng):
    first, edge1, edge2, index = box
    power = np.where(np.arange(12) < 4, 0.0, np.arange(12.0))
    light = EmissiveTriangles(first, edge1, edge2, index, power)
    chosen = light.sample(np.zeros((3, 40000)), *rng.random((2, 40000))).triangle
    share = np.bincount((chosen - 10) // 2, minlength=12) / 40000
    assert np.all(share[:4] == 0.0)
    # Five standard errors of a binomial share.
    np.testing.assert_array_less(np.abs(share - power / power.sum()), 5.0 * np.sqrt(0.25 / 40000))
    assert light.power == power.sum()


def test_other_triangles_have_no_density(box):
    light = EmissiveTriangles(*box, np.ones(12))
    others = np.array([0, 9, 11, 33, 10**6])
    assert not light.pdf_of_hit(others, np.ones(5), np.ones(5)).any()


def test_degenerate_triangles_are_never_chosen(rng):
    """Hard case 20: a triangle without area beside a proper one; and nothing but such."""
    first = np.zeros((3, 2))
    edge1 = np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]])
    edge2 = np.array([[0.0, 2.0], [1.0, 0.0], [0.0, 0.0]])
    points = np.ascontiguousarray(np.broadcast_to([[0.2], [0.2], [1.0]], (3, 1000)))
    light = EmissiveTriangles(first, edge1, edge2, np.array([0, 1]), np.array([1.0, 5.0]))
    assert not light.sample(points, *rng.random((2, 1000))).triangle.any()
    for power in (np.zeros(1), np.ones(1)):
        light = EmissiveTriangles(first[:, 1:], edge1[:, 1:], edge2[:, 1:], np.array([0]), power)
        assert light.power == 0.0
        assert np.all(light.sample(points, *rng.random((2, 1000))).pdf > 0.0)


def test_edge_on_and_touching_points_stay_finite(rng):
    """Points in the plane of the triangle, and at its corner."""
    light = EmissiveTriangles(np.zeros((3, 1)), np.eye(3)[:, :1], np.eye(3)[:, 1:2], np.array([0]), np.ones(1))
    points = np.array([[2.0, 0.25, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.0]])
    sample = light.sample(points, np.array([0.5, 0.5, 0.0]), np.array([0.5, 0.5, 0.0]))
    assert np.isfinite(sample.pdf).all()
    assert np.all(sample.pdf > 0.0)
    assert np.isfinite(sample.wi).all()
