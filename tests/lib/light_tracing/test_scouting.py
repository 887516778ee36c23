# SPDX-License-Identifier: GPL-3.0-or-later
"""The scouting pass finds the light of caustics, and no other.

It also gives the worth of a camera path that finds it.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.light_tracing.scouting import NARROW, scout_caustics
from etalon.lib.lights.light import luminance
from etalon.lib.scene.lights import AreaLight, PointLight, SunLight
from etalon.lib.scene.materials import Diffuse, Glossy
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.light_tracing.traced import MATERIALS, ball_on_floor
from etalon.tests.replicates import assert_mean, assert_same, replicates
from etalon.tests.scenes import color, diffuse, floor, glossy, icosphere, material, perspective, quad, scene
from scipy.stats import chi2

SIZE = 8
LABELS = np.arange(SIZE)[:, None] // 4 * 2 + np.arange(SIZE) // 4
UP = AreaLight("up", (0, 0, 0.5), (2.0, 0, 0), (0, 2.0, 0), (0, 0, 1.0), "RECTANGLE", (3.0, 2.0, 1.0), np.pi)


def scouted(the_scene, seed, paths=1 << 15, **more):
    return scout_caustics(ReferenceRenderer(the_scene, Options(threads=1, seed=seed)).kernel, paths, **more)


def lit_by_a_ball(coat, bounces=1, light=UP):
    """A floor that a lamp turned away from it lights only by way of a ball above."""
    ball = icosphere(1.0, 3, 0, True)
    ball = replace(ball, vertices=ball.vertices + np.array([[0.0], [0.0], [2.4]]))
    camera = perspective(SIZE, SIZE, 0.3, (0.0, -4.0, 1.2), (0.0, 1.0, -0.35))
    return scene([ball, floor(3.0, material=1)], [coat, diffuse(0.7, 0.6, 0.5)], camera, [light], 0.0, bounces)


@pytest.mark.parametrize("alpha", [0.0, pytest.param(0.05, marks=pytest.mark.slow)])
def test_it_finds_all_light_of_a_scene_without_other_light(alpha, seed):
    """A lamp so wide that path tracing finds it.

    Bounces allow one reflection by the ball, then the floor.
    """
    the_scene = lit_by_a_ball(glossy(alpha, 0.9, 0.8, 0.7))
    traced = replicates(the_scene, 16, 512, seed=seed)
    found = scouted(the_scene, seed, 1 << 17).replicates(LABELS)
    traced = traced.reshape(16, 2, 4, 2, 4, 3).mean(axis=(2, 4)).reshape(16, 4, 3)
    assert_same(traced, found, 0.06)


def test_a_plane_mirror_shows_the_floor_a_second_lamp(seed):
    """A point at (0, 0, 1) of intensity I under a mirror at z = 2.

    The floor gets I a cos / D^2 of its image at (0, 0, 3), and nothing of the lamp itself.
    """
    mirror = quad((-9.0, -9.0, 2.0), (0.0, 18.0, 0.0), (18.0, 0.0, 0.0), 0)
    lamp = PointLight("point", (0.0, 0.0, 1.0), (2.0, 2.0, 2.0))
    camera = perspective(2, 2, 0.4, (0.0, 0.0, 1.5))  # sees 1.2 m of the floor
    built = scene([mirror, floor(3.0, material=1)], [glossy(0.0, 0.9, 0.8, 0.7), diffuse(0.6)], camera, [lamp], 0.0, 1)
    x, y = np.meshgrid(*[0.6 * (np.arange(200) - 99.5) / 100.0] * 2)
    irradiance = (2.0 * 3.0 / (x * x + y * y + 9.0) ** 1.5).mean()
    exact = np.array([0.9, 0.8, 0.7]) * irradiance * 0.6 / np.pi
    labels = np.zeros((2, 2), int)
    result = scouted(built, seed)
    assert_mean(result.replicates(labels), exact, 0.03)
    assert np.isinf(result.brightest(labels)).all()


def test_light_of_wide_lobes_alone_is_not_counted(seed):
    result = scouted(ball_on_floor(MATERIALS["glossy"]), seed)
    assert result.pixel.size == 0
    assert not result.image.any()


def test_a_mirror_without_wide_lobes_or_bounces_casts_no_caustic(seed):
    ball = lit_by_a_ball(glossy(0.0, 0.9))
    assert not scouted(replace(ball, materials=(ball.materials[0],) * 2), seed).pixel.size
    assert not scouted(lit_by_a_ball(glossy(0.0, 0.9), bounces=0), seed).pixel.size


def test_only_the_narrow_lobe_of_a_mixture_is_counted(seed):
    """A lobe that shares a material with a diffuse one.

    It sends as much light to the floor as alone.
    """
    alone = scouted(lit_by_a_ball(glossy(0.0, 0.5)), seed).replicates(LABELS)
    mixed = scouted(lit_by_a_ball(material(Diffuse(color(0.3)), Glossy("GGX", color(0.5)))), seed).replicates(LABELS)
    np.testing.assert_allclose(mixed, alone, rtol=1e-12)


def test_the_limit_of_narrow_is_the_callers(seed):
    the_scene = lit_by_a_ball(glossy(0.2, 0.9))
    assert NARROW == 0.1
    assert not scouted(the_scene, seed).pixel.size
    assert scouted(the_scene, seed, narrow=0.25).pixel.size


def test_the_sun_finds_a_small_ball_on_a_wide_floor(seed):
    """The floor is 4,000 times as large as the ball: rays that miss it would be all but lost."""
    ball = replace(icosphere(0.05, 3, 0, True), vertices=icosphere(0.05, 3).vertices + np.array([[0.0], [0.0], [0.05]]))
    sun = SunLight("sun", (0.6, 0.0, 0.8), 0.005, (1.0, 1.0, 1.0))
    camera = perspective(SIZE, SIZE, 0.3, (0.0, 0.0, 0.6))
    built = scene([ball, floor(3.0, material=1)], [glossy(0.0, 0.9), diffuse(0.6)], camera, [sun], 0.0, 2)
    result = scouted(built, seed, 1 << 15)
    mean, error = result.regions(np.zeros((SIZE, SIZE), int))
    assert result.pixel.size > 1000
    assert np.all(error < 0.1 * mean)
    radiance = 1.0 / (np.pi * np.sin(0.005) ** 2)
    np.testing.assert_allclose(result.brightest(LABELS).max(), radiance, rtol=1e-6)


def test_the_error_of_a_pass_is_that_of_its_batches(seed):
    """Passes with other seeds scatter as the batches of one say; a ratio of variances, at a level of 1e-4."""
    the_scene, passes = lit_by_a_ball(glossy(0.05, 0.9)), 64
    found = [scouted(the_scene, seed + k, 1 << 12).regions(LABELS) for k in range(passes)]
    means, errors = (np.stack(rows)[:, 3, 0] for rows in zip(*found, strict=True))
    ratio = means.var(ddof=1) / (errors**2).mean() * (passes - 1)
    low, high = chi2.ppf([5e-5, 1 - 5e-5], passes - 1)
    assert low < ratio < high


def test_image_and_regions_are_of_the_same_light(seed):
    result = scouted(lit_by_a_ball(glossy(0.05, 0.9)), seed)
    mean, _ = result.regions(LABELS)
    blocks = result.image.reshape(2, 4, 2, 4, 3).mean(axis=(1, 3)).reshape(4, 3)
    np.testing.assert_allclose(mean, blocks, rtol=1e-12)
    halves, _ = result.regions(np.where(LABELS == 3, 0, -1))
    np.testing.assert_allclose(halves, mean[3:], rtol=1e-12)
    assert result.brightness.max() == pytest.approx(luminance(np.array([3.0, 2.0, 1.0])))
