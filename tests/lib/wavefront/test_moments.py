# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur against closed forms: how long a point of the image sees what moves."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.rendering.replicates import make_renderer
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.motion import Motion
from etalon.lib.settings.reference import OTHER_ESTIMATORS, RenderOptions
from etalon.lib.wavefront.moments import SHUTTER_ENDS, count_moments, draw_moments
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import diffuse, emission, orthographic, perspective, quad, scene


def moved(*places):
    """Keys of an object that does not turn."""
    return np.array([np.column_stack([np.eye(3), place]) for place in places], float)


def blurred(one, motion, seed, count=16, samples=64):
    """Replicates of a scene with motion."""
    return replicates(replace(one, motion=motion), count, samples, seed=seed)


def overlap(left, right, start, stop):
    """The part of [left, right] in [start, stop]."""
    return np.maximum(np.minimum(right, stop) - np.maximum(left, start), 0.0)


def columns(place, times, weights, width=1.0):
    """(8,) light of the pixels from -4 to 4 from a strip, by quadrature over time.

    The strip has `width`, and its left edge is at `place`(time).
    """
    pixels = np.arange(-4.0, 4.0)[:, None]
    left = place(times)
    return (overlap(pixels, pixels + 1.0, left, left + width) * weights).sum(axis=1) / weights.sum()


@pytest.mark.slow
def test_a_strip_that_moves_by_a_piecewise_linear_path(seed):
    """A strip a pixel wide with three keys, fast then slow.

    The shutter opens and closes linearly.
    """
    one = scene(quad((-3, -9, 0), (1, 0, 0), (0, 18, 0)), emission(1.0), orthographic(8, 2, 8.0, (0, 0, 5)))
    motion = {0: moved((0, 0, 0), (4, 0, 0), (5, 0, 0))}
    times = (np.arange(40_000) + 0.5) / 40_000

    def place(time):
        return -3.0 + np.interp(time, (0.0, 0.5, 1.0), (0.0, 4.0, 5.0))

    exact = columns(place, times, 1.0 - np.abs(2.0 * times - 1.0))
    found = blurred(one, Motion(objects=motion, shutter=np.array([0.0, 1.0, 0.0])), seed)
    assert_mean(found, exact[None, :, None], precision=0.1, rounding=1e-6)


@pytest.mark.slow
def test_a_turning_half_plane_covers_a_point_for_its_share_of_the_turn(seed):
    """A half-plane that turns by a right angle about the image's middle.

    A point at the angle phi is covered for its share of the turn.
    """
    one = scene(quad((-90, 0, 0), (180, 0, 0), (0, 90, 0)), emission(1.0), orthographic(8, 8, 2.0, (0, 0, 5)))
    quarter = np.array([[0.0, -1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]])
    fine = (np.arange(8 * 64) + 0.5) / (4 * 64) - 1.0
    x, y = np.meshgrid(fine, -fine)
    # Covered at the turn a where phi - a is in (0, pi); a runs from 0 to pi / 2.
    phi = np.arctan2(y, x) % (2.0 * np.pi)
    covered = np.maximum(np.minimum(phi, np.pi / 2.0) - np.maximum(phi - np.pi, 0.0), 0.0) / (np.pi / 2.0)
    exact = covered.reshape(8, 64, 8, 64).mean(axis=(1, 3))
    found = blurred(one, Motion(objects={0: np.array([np.eye(4)[:3], quarter])}), seed)
    assert_mean(found, exact[:, :, None], precision=0.1, rounding=1e-4)


@pytest.mark.slow
def test_a_camera_that_dollies_sees_a_strip_grow(seed):
    """From depth 4 to 2 a strip of half-width 1 reaches to 1 / depth on the plane at depth 1."""
    one = scene(quad((-1, -9, 0), (2, 0, 0), (0, 18, 0)), emission(1.0), perspective(8, 2, 1.0, (0, 0, 4)))
    keys = np.array([one.camera.world_from_camera] * 2)
    keys[:, 2, 3] = 4.0, 2.0
    times = (np.arange(40_000) + 0.5) / 40_000
    reach = 1.0 / (4.0 - 2.0 * times)
    pixels = np.arange(-4.0, 4.0)[:, None] / 4.0
    exact = 4.0 * overlap(pixels, pixels + 0.25, -reach, reach).mean(axis=1)
    assert_mean(blurred(one, Motion(camera=keys), seed), exact[None, :, None], precision=0.1, rounding=1e-6)


def waving(turns):
    """A smooth square of which the normals of the left side have the angles `turns` at the keys, the right ones none.

    It slides in its plane, so that nothing but its normals changes what is seen.
    """
    square = quad((-3, -3, 0), (6, 0, 0), (0, 6, 0))
    square = replace(square, normals=np.repeat([[0.0], [0.0], [1.0]], 4, axis=1))
    one = scene(
        square, diffuse(0.5), orthographic(4, 1, 4.0, (0, 0, 5)), lights=(SunLight("sun", SUN, 0.0, (2.0,) * 3),)
    )
    left = square.vertices[0] < 0.0
    keys = [np.array([np.sin(a * left), 0.0 * left, np.cos(a * left)]) for a in turns]
    normals = np.array([key[:, square.triangles].transpose(1, 0, 2) for key in keys])
    slid = np.array([square.vertices + np.array([[0.0], [y], [0.0]]) for y in np.linspace(-0.5, 0.5, len(turns))])
    return one, Motion(positions={0: slid}, normals={0: normals})


SUN = (0.6, 0.0, 0.8)


def light_of(turns, angle_at):
    """(4,) light of the pixels of `waving`, by Gauss quadrature over place and time; angle_at(start, stop, share)."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
    sums = np.zeros(4)
    for start, stop in pairwise(turns):
        for share, weight in zip(nodes, weights, strict=True):
            angle = angle_at(start, stop, share)
            for pixel in range(4):
                reach = (pixel + 1.0 + nodes) / 6.0
                n = np.array([(1.0 - reach) * np.sin(angle), 0.0 * reach, (1.0 - reach) * np.cos(angle) + reach])
                cosine = np.maximum(SUN @ (n / np.linalg.norm(n, axis=0)), 0.0)
                sums[pixel] += weight * (weights * cosine).sum() / (len(turns) - 1)
    return sums * 0.5 / np.pi * 2.0


def chord(start, stop, share):
    """The angle on the chord between two directions."""
    return start + np.arctan2(share * np.sin(stop - start), 1.0 - share + share * np.cos(stop - start))


@pytest.mark.slow
def test_normals_that_turn_show_the_mean_of_their_cosines(seed):
    """A square under a distant light, whose normals turn.

    A turn at constant speed, and the normals of the frame, would show other light.
    """
    turns = -0.8, 1.2, -0.8
    one, motion = waving(turns)
    exact = light_of(turns, chord)
    found = blurred(one, motion, seed, count=24)
    assert_mean(found, exact[None, :, None], precision=0.002, rounding=1e-6)
    error = found.std(axis=0, ddof=1).max() / np.sqrt(24)
    even = light_of(turns, lambda start, stop, share: start + share * (stop - start))
    still = light_of((1.2, 1.2), chord)
    assert np.abs(even - exact).max() > 8.0 * error
    assert np.abs(still - exact).max() > 8.0 * error


@pytest.mark.parametrize(("start", "stop"), [(0.0, 0.02), (0.0, 1.0), (0.98, 1.0)])
def test_by_the_departure_the_shutter_is_open_for_a_part_of_its_time(start, stop):
    """What an edge that moves by 1 shows between two places is 1 - x in truth; Cycles shows the second figures.

    docs/findings/scripts/shutter_ends.py has them on 4.5, 5.2 and 5.3, with a noise of 2e-5, 1e-3 and 2e-5.
    """
    measured = {0.0: {0.02: 0.991788, 1.0: 0.498053}, 0.98: {1.0: 0.005041}}[start][stop]
    places = np.linspace(start, stop, 2001)[:, None]
    shown = [
        np.mean([(draw_moments(None, 7, k, 4096, names) > places).mean(axis=1) for k in range(4)], axis=0)
        for names in ((), (SHUTTER_ENDS,))
    ]
    assert shown[0].mean() == pytest.approx(1.0 - 0.5 * (start + stop), abs=5e-5)
    assert shown[1].mean() == pytest.approx(measured, abs=1e-4)


def test_moments_share_the_samples_evenly():
    assert [count_moments(samples) for samples in (1, 7, 16, 34, 128)] == [1, 7, 16, 2, 16]


def test_a_moving_camera_sees_what_a_world_that_moves_the_other_way_shows(seed):
    """A camera that turns and walks in front of a strip, and the strip moved by the inverse.

    The same moments give the same image.
    """
    one = scene(quad((-1, -9, 0), (2, 0, 0), (0, 18, 0)), emission(1.0), perspective(8, 2, 1.0, (0, 0, 4)))
    start = one.camera.world_from_camera
    angle = 0.3
    turn = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    # About the view axis, so that turn and walk commute: the inverse of what lies between keys lies between inverses.
    stop = np.column_stack([turn @ start[:, :3], start[:, 3] + (0.0, 0.0, 1.0)])
    inverse = np.column_stack([turn.T, (0.0, 0.0, -1.0)])
    camera = blurred(one, Motion(camera=np.array([start, stop])), seed, count=2)
    world = blurred(one, Motion(objects={0: np.array([np.eye(4)[:3], inverse])}), seed, count=2)
    np.testing.assert_allclose(camera, world, atol=1e-4)
    assert camera.std(axis=2).max() > 0.1


@pytest.mark.parametrize("strategy", OTHER_ESTIMATORS)
def test_other_estimators_refuse_it_by_name(strategy):
    one = scene(quad((-1, -9, 0), (2, 0, 0), (0, 18, 0)), diffuse(0.5), orthographic(8, 2, 8.0, (0, 0, 5)))
    with pytest.raises(Refused, match="motion blur by"):
        make_renderer(
            replace(one, motion=Motion(objects={0: moved((0, 0, 0), (1, 0, 0))})), RenderOptions(strategy=strategy)
        )
