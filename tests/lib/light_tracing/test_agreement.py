# SPDX-License-Identifier: GPL-3.0-or-later
"""Light tracing and path tracing are estimators of one image.

They agree in every block, light by light and lobe by lobe.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.bsdfs.specular import SmoothDielectric
from etalon.lib.light_tracing import adjoint
from etalon.lib.scene.lights import SphereLight, SunLight
from etalon.lib.scene.materials import Diffuse
from etalon.lib.scene.rays import CAMERA, EVERY, SEEN
from etalon.lib.vectors import dot
from etalon.tests.lib.light_tracing.traced import (
    AREA,
    CAMERAS,
    LIGHTS,
    MATERIALS,
    assert_agree,
    ball_on_floor,
    light_traced,
)
from etalon.tests.lib.wavefront.test_strategies import LIGHTINGS, SKY, stage
from etalon.tests.scenes import color, cube, diffuse, emission, glass, icosphere, material, perspective, quad, scene


def of(table, *quick):
    """Names of the table's entries; the default run takes the `quick` ones."""
    return [pytest.param(name, marks=() if name in quick else pytest.mark.slow) for name in table]


@pytest.mark.parametrize("name", of(LIGHTS, "spot_with_radius"))
def test_every_light_gives_the_same_image(name, seed):
    assert_agree(ball_on_floor(MATERIALS["glossy"], [LIGHTS[name]]), seed, precision=0.08)


@pytest.mark.slow
@pytest.mark.parametrize("name", of(MATERIALS, "rough_glass"))
def test_every_lobe_gives_the_same_image(name, seed):
    assert_agree(ball_on_floor(MATERIALS[name]), seed, precision=0.08)


@pytest.mark.parametrize("name", of(CAMERAS, "perspective_with_lens"))
def test_every_camera_gives_the_same_image(name, seed):
    assert_agree(ball_on_floor(MATERIALS["diffuse"], camera=CAMERAS[name]), seed, precision=0.08)


@pytest.mark.slow
@pytest.mark.parametrize("lighting", of(["lamp", "behind_a_veil", "all"], "behind_a_veil"))
def test_worlds_lamps_and_veils_give_the_same_image(lighting, seed):
    assert_agree(stage(**LIGHTINGS[lighting]), seed, precision=0.08)


@pytest.mark.parametrize("bounces", of([0, 1, 2], 1))
def test_bounces_mean_the_same_paths(bounces, seed):
    assert_agree(ball_on_floor(MATERIALS["diffuse"], bounces=bounces), seed, precision=0.08)


@pytest.mark.slow
def test_a_mirror_shows_the_same_sky(seed):
    """The sphere belongs to path tracing, what it sends to the floor to light tracing."""
    assert_agree(ball_on_floor(MATERIALS["mirror"], world=SKY), seed, precision=0.08)


@pytest.mark.slow
def test_the_camera_sees_the_same_lamps(seed):
    lights = [SphereLight("shown", (-0.8, -0.5, 1.8), 0.3, (2.0,) * 3, rays=SEEN), replace(AREA, radiance=(1.0,) * 3)]
    assert_agree(ball_on_floor(MATERIALS["diffuse"], lights), seed, precision=0.08)


@pytest.mark.slow
def test_the_camera_does_not_see_hidden_objects(seed):
    the_scene = ball_on_floor(MATERIALS["glossy"])
    ball, ground = the_scene.mesh.objects
    mesh = replace(the_scene.mesh, objects=(replace(ball, rays=EVERY & ~CAMERA), ground))
    assert_agree(replace(the_scene, mesh=mesh), seed, precision=0.08)


@pytest.mark.slow
def test_roulette_and_plain_random_numbers_give_the_same_image(seed):
    box = scene(
        [cube(1.0, material=0), quad((-0.4, -0.4, 0.9), (0.0, 0.8, 0.0), (0.8, 0.0, 0.0), 1)],
        [material(Diffuse(color(0.7, 0.5, 0.3))), emission(3.0)],
        perspective(10, 10, 0.8, (0.03, -0.9, 0.1), (0.1, 1.0, -0.2)),
        bounces=6,
    )
    assert_agree(box, seed, precision=0.08, russian_roulette=True, sampler="random")


@pytest.mark.slow
def test_light_through_a_glass_ball_makes_the_same_caustic(seed):
    """A lamp wider than the ball, so that path tracing finds it.

    There are two refractions, then the floor.
    """
    the_scene = ball_on_floor(glass(1.5), [replace(AREA, radiance=(6.0,) * 3)], subdivisions=3, bounces=2)
    assert_agree(the_scene, seed, samples=512, precision=0.08)


def assert_seen(the_scene, seed, **more):
    with pytest.raises(AssertionError, match="difference"):
        assert_agree(the_scene, seed, **more)


@pytest.mark.slow
def test_a_forgotten_factor_of_refraction_is_seen(monkeypatch, seed):
    """A lamp within glass: without 1 / eta^2 the floor is 2.25 times too bright.

    Two crossings of a closed body would cancel it.
    """
    lamp = replace(icosphere(0.4, 1, 2), vertices=icosphere(0.4, 1).vertices + np.array([[0.0], [0.0], [1.0]]))
    the_scene = ball_on_floor(glass(1.5), [], bounces=1, others=[(lamp, emission(5.0))])
    assert_agree(the_scene, seed, precision=0.08)
    monkeypatch.setattr(
        SmoothDielectric, "widening", lambda self, wi: np.where(wi[2] < 0.0, np.abs(self._wo[2] / wi[2]), 1.0)
    )
    assert_seen(the_scene, seed)


@pytest.mark.slow
def test_a_forgotten_factor_of_shading_normals_is_seen(monkeypatch, seed):
    """Veach 1997, section 5.3, on a sphere of 20 faces that is shaded smooth.

    Forgotten, |on.n| stands in the weight, as in path tracing.
    """
    sun = SunLight("sun", (0.8, 0.0, 0.6), 0.0, (1.0, 1.0, 1.0))
    the_scene = scene(icosphere(1.0, 0, 0, True), diffuse(0.8), perspective(6, 6, 0.2, (0.0, 0.0, 4.0)), [sun])
    assert_agree(the_scene, seed, samples=1024, size=1, precision=0.05)
    original = adjoint._cosines

    def forgotten(points, here, frame):
        ratio = np.abs(dot(here.n, here.wo)) / np.maximum(np.abs(dot(here.n, points.wo)), 1e-9)
        return np.where(original(points, here, frame) > 0.0, ratio, 0.0)

    monkeypatch.setattr(adjoint, "_cosines", forgotten)
    assert_seen(the_scene, seed, samples=1024, size=1)


@pytest.mark.slow
def test_lobes_of_the_wrong_side_are_seen(monkeypatch, seed):
    """Lobes are evaluated for the direction to the camera.

    Those that are made for the light's side have other weights.
    """
    the_scene = ball_on_floor(MATERIALS["rough_glass"])
    monkeypatch.setattr(adjoint, "see_from", lambda points, wo: points)
    assert_seen(the_scene, seed)


def test_the_image_does_not_depend_on_the_number_of_threads(seed):
    the_scene = ball_on_floor(MATERIALS["glossy"])
    one, two = (light_traced(the_scene, 1, 700, seed=seed, threads=threads) for threads in (1, 2))
    np.testing.assert_array_equal(one, two)


def test_replicates_differ(seed):
    first, second = light_traced(ball_on_floor(MATERIALS["glossy"]), 2, 16, seed=seed)
    assert not np.array_equal(first, second)
