# SPDX-License-Identifier: GPL-3.0-or-later
"""Projections of images against their definitions.

They are angles, a mirror, and the faces of a box.
"""

from itertools import permutations

import numpy as np
import pytest
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.images import Image
from etalon.lib.textures.evaluate import Evaluator
from etalon.lib.textures.images import ImageSet
from etalon.lib.textures.projections import box_faces, box_weights, mirror_ball, sphere, tube


def test_sphere_is_longitude_and_latitude(rng):
    """From +y, where u is 1/2, longitude runs towards -x."""
    longitude, latitude = rng.uniform(-3.1, 3.1, 200), rng.uniform(-1.5, 1.5, 200)
    level = np.cos(latitude)
    point = 0.5 + 7.0 * np.stack([-level * np.sin(longitude), level * np.cos(longitude), np.sin(latitude)])
    u, v = sphere(point)
    np.testing.assert_allclose(u, 0.5 + longitude / (2 * np.pi), atol=1e-14)
    np.testing.assert_allclose(v, 0.5 + latitude / np.pi, atol=1e-14)


def test_tube_is_longitude_and_height(rng):
    longitude, z = rng.uniform(-3.1, 3.1, 200), rng.uniform(-2, 2, 200)
    u, v = tube(np.stack([0.5 - 3.0 * np.sin(longitude), 0.5 + 3.0 * np.cos(longitude), z]))
    np.testing.assert_allclose(u, 0.5 + longitude / (2 * np.pi), atol=1e-14)
    np.testing.assert_array_equal(v, z)


def test_the_axis_and_the_centre_have_the_places_that_blender_gives_them():
    axis = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 0.5], [0.9, 0.1, 0.5]])
    np.testing.assert_allclose(sphere(axis), [[0, 0, 0], [1, 0, 0]])
    np.testing.assert_array_equal(tube(axis), np.zeros((2, 3)))


def test_mirror_ball_inverts_the_reflection(rng):
    """A ray along +y meets the unit ball and is mirrored there.

    It meets it at (x, -sqrt(1 - x^2 - z^2), z).
    """
    radius, turn = np.sqrt(rng.random(500)), rng.uniform(0, 2 * np.pi, 500)
    x, z = radius * np.cos(turn), radius * np.sin(turn)
    normal = np.stack([x, -np.sqrt(1 - radius**2), z])
    ray = np.array([[0.0], [1.0], [0.0]])
    mirrored = ray - 2 * (ray * normal).sum(axis=0) * normal
    u, v = mirror_ball(3.0 * mirrored)
    np.testing.assert_allclose(u, 0.5 + 0.5 * x, atol=1e-9)
    np.testing.assert_allclose(v, 0.5 + 0.5 * z, atol=1e-9)


def test_behind_the_mirror_ball_and_nowhere_is_the_middle():
    np.testing.assert_array_equal(mirror_ball(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]])), np.full((2, 2), 0.5))


def normals(rng, count=4000):
    return rng.normal(size=(3, count))


def test_a_box_without_blend_shows_the_face_that_the_normal_is_nearest_to(rng):
    normal = normals(rng)
    np.testing.assert_array_equal(box_weights(normal, 0.0).argmax(axis=0), np.abs(normal).argmax(axis=0))
    np.testing.assert_array_equal(box_weights(normal, 0.0).max(axis=0), 1.0)


@pytest.mark.parametrize("blend", [0.05, 0.3, 0.7, 1.0])
def test_box_weights_share_one_and_treat_the_axes_alike(blend, rng):
    normal = normals(rng)
    weights = box_weights(normal, blend)
    np.testing.assert_allclose(weights.sum(axis=0), 1.0, atol=1e-12)
    assert weights.min() > -1e-12
    for order in permutations(range(3)):
        np.testing.assert_allclose(box_weights(normal[list(order)], blend), weights[list(order)], atol=1e-12)


@pytest.mark.parametrize("blend", [0.05, 0.3, 0.7, 1.0])
def test_box_weights_between_two_faces_grow_linearly(blend):
    """By their definition, with the third part of the normal 0.

    Weights grow from (1 - blend) / 2 to (1 + blend) / 2 of |x| + |y|.
    """
    share = np.linspace(0.001, 0.999, 400)
    weights = box_weights(np.stack([share, share - 1, np.zeros(400)]), blend)
    np.testing.assert_allclose(weights[0], np.interp(share, [0.5 - blend / 2, 0.5 + blend / 2], [0, 1]), atol=1e-12)


def test_box_weights_where_three_faces_meet_are_a_third():
    np.testing.assert_allclose(box_weights(np.array([[1.0], [-1.0], [1.0]]), 0.3), 1 / 3, rtol=1e-12)


def test_each_face_of_a_box_is_seen_the_right_way_round():
    """Seen from outside with z up, u grows to the right and v upwards.

    For the faces across z it is seen with x up.
    """
    point = np.array([[0.3], [0.4], [0.7]])
    axes = np.eye(3)
    for k, up in ((0, axes[2]), (1, axes[2]), (2, axes[0])):
        for side in (-1.0, 1.0):
            normal = (side * axes[k])[:, None]
            right = np.cross(up, normal[:, 0])
            moves = (
                np.subtract(list(box_faces(point + step[:, None], normal))[k], list(box_faces(point, normal))[k])
                for step in (right, up)
            )
            np.testing.assert_allclose(np.stack(list(moves))[..., 0], np.eye(2), atol=1e-12)


class Sides:
    """Points on the sides of a cube."""

    def __init__(self, point, normal):
        self._given = {"OBJECT": point, "NORMAL": normal}
        self.size = point.shape[1]

    def coordinates(self, kind, uv_map):
        return self._given[kind]


def test_a_box_blends_the_colours_of_its_faces(rng):
    pixels = rng.random((3, 5, 4)).astype(np.float32)
    images = ImageSet([Image("", pixels, "LINEAR")])
    point, normal = rng.random((3, 50)), np.repeat([[1.0], [1.0], [1.0]], 50, axis=1)
    box = ex.ImageTexture(
        ex.Coordinates("OBJECT"), 0, projection="BOX", normal=ex.Coordinates("NORMAL"), blend=0.4, extension="EXTEND"
    )
    x, y, z = point
    expected = sum(images.sample(0, *place, extension="EXTEND")[:3] for place in ((y, z), (1 - x, z), (1 - y, x))) / 3
    np.testing.assert_allclose(Evaluator(Sides(point, normal), images)(box), expected, rtol=1e-12)
