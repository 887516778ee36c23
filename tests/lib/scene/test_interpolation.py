# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion between keys, and the moments at which a shutter is open."""

import numpy as np
import pytest
from etalon.lib.errors import EtalonError
from etalon.lib.scene.interpolation import (
    decompose,
    interpolate_directions,
    interpolate_transforms,
    shutter_times,
)
from etalon.tests.turns import turned
from scipy import stats


def test_parts_of_a_motion_are_interpolated_apart():
    """Half way between two keys: half the angle about the axis, the mean scale and place.

    This holds also over a key in the middle.
    """
    axis = (1.0, -2.0, 0.5)
    keys = [turned(a, (s, 2.0, 1.0 / s), (s, 0.0, -a), axis) for a, s in ((0.2, 1.0), (1.8, 3.0), (4.2, 2.0))]
    for time, angle, x, z, place in ((0.25, 1.0, 2.0, 2.0 / 3.0, 2.0), (0.75, 3.0, 2.5, 5.0 / 12.0, 2.5)):
        found = interpolate_transforms(np.array(keys), time)
        np.testing.assert_allclose(found, turned(angle, (x, 2.0, z), (place, 0.0, -angle), axis), atol=1e-12)
    for key, time in zip(keys, (0.0, 0.5, 1.0), strict=True):
        np.testing.assert_allclose(interpolate_transforms(np.array(keys), time), key, atol=1e-12)


def test_directions_turn_as_the_chord_between_keys_is_walked():
    """At the share s of the way between directions at the angle theta, tan = s sin theta / (1 - s + s cos theta)."""
    angles = 0.3, 1.7, 0.9
    keys = np.array([(np.sin(a), 0.0, np.cos(a)) for a in angles]).reshape(3, 1, 3, 1)
    for time, first, share in ((0.1, 0, 0.2), (0.5, 1, 0.0), (0.65, 1, 0.3), (1.0, 1, 1.0)):
        turn = angles[first + 1] - angles[first]
        angle = angles[first] + np.arctan2(share * np.sin(turn), 1.0 - share + share * np.cos(turn))
        found = interpolate_directions(keys, time)[0, :, 0]
        np.testing.assert_allclose(found, (np.sin(angle), 0.0, np.cos(angle)), atol=1e-12)


def test_the_middle_of_opposite_directions_is_the_key_before():
    keys = np.array([(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]).reshape(2, 1, 3, 1)
    np.testing.assert_array_equal(interpolate_directions(keys, 0.5)[0, :, 0], (0.0, 0.0, 1.0))


def test_a_rotation_takes_the_smaller_angle():
    found = interpolate_transforms(np.array([turned(0.0), turned(1.5 * np.pi)]), 0.5)
    np.testing.assert_allclose(found, turned(-0.25 * np.pi), atol=1e-12)


def test_shears_and_mirrors_are_kept(rng):
    """Any map is the product of its rotation and its stretch.

    A mirror is in the stretch alone.
    """
    for sign in (1.0, -1.0):
        matrix = rng.normal(size=(3, 4))
        matrix[:, 0] *= sign * np.sign(np.linalg.det(matrix[:, :3]))
        rotation, stretch = decompose(matrix)
        np.testing.assert_allclose(rotation @ stretch, matrix[:, :3], atol=1e-12)
        np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-12)
        assert np.linalg.det(rotation) > 0.0
        assert (np.sign(np.diag(stretch)) == sign).all()


def test_times_follow_the_shutter_curve(rng):
    """A shutter that opens and closes linearly: the distribution of a triangle.

    A flat piece and closed ends are tested by quadrature.
    """
    uniforms = rng.random(4000)
    triangle = shutter_times(np.array([0.0, 1.0, 0.0]), uniforms)
    assert stats.kstest(triangle, stats.triang(0.5).cdf).pvalue > 1e-4
    curve = np.array([0.0, 0.0, 0.7, 0.7, 0.2, 0.0])
    fine = np.linspace(0.0, 1.0, 100_001)
    height = np.interp(fine, np.linspace(0.0, 1.0, curve.size), curve)
    reached = np.concatenate([[0.0], np.cumsum(0.5 * (height[1:] + height[:-1]))])
    found = shutter_times(curve, uniforms)
    np.testing.assert_allclose(np.interp(found, fine, reached / reached[-1]), uniforms, atol=1e-8)
    np.testing.assert_array_equal(shutter_times(None, uniforms), uniforms)
    with pytest.raises(EtalonError, match="nowhere open"):
        shutter_times(np.zeros(4), uniforms)
