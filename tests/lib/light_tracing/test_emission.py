# SPDX-License-Identifier: GPL-3.0-or-later
"""The light that leaves a light.

Tested are its flux in closed form, and the radiance that a ray which meets it finds.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.plan import make_plan
from etalon.lib.light_tracing.aim import Aim
from etalon.lib.light_tracing.emitters import ConstantSky
from etalon.lib.lights.build import light_sampler
from etalon.lib.lights.environment import EnvironmentSampler
from etalon.lib.lights.light import Aimable, Ball, bounding_ball, luminance
from etalon.lib.settings.reference import Options
from etalon.lib.vectors import dot
from etalon.lib.wavefront.kernel import Kernel
from etalon.tests.lib.light_tracing.traced import LIGHTS
from etalon.tests.lib.lights import examples
from etalon.tests.scenes import diffuse, emission, floor, icosphere, perspective, scene

ALL = LIGHTS | examples.LIGHTS
BALL = Ball(np.array([[0.1], [-0.2], [0.3]]), 1.7, 5.0)
COUNT = 40000
A = 9.0  # square metres of the rectangle


def emit(light, rng, ball=BALL):
    place, heading = rng.random((2, COUNT)), rng.random((2, COUNT))
    return light.emit(ball, tuple(place), tuple(heading))


def smoothstep_mean(cos_edge, blend):
    """Solid angle of a cone with a soft edge: smoothstep is 1/2 on the average of its edge."""
    width = (1.0 - cos_edge) * blend
    return 2.0 * np.pi * (1.0 - cos_edge - 0.5 * width)


FLUX = {
    "rectangle": np.pi * A * np.array([6.0, 5.0, 4.0]),
    "rectangle_with_spread": np.pi * A * np.array([6.0, 5.0, 4.0]),
    "skewed_ellipse_with_spread": np.pi * (np.pi / 4.0 * 1.5) * np.array([4.0, 8.0, 4.0]),
    "beam": np.pi * A * np.array([6.0, 5.0, 4.0]),
    "point": 4.0 * np.pi * np.array([30.0, 20.0, 10.0]),
    "sphere": np.pi * 4.0 * np.pi * 0.4**2 * np.array([5.0, 5.0, 9.0]),
    "spot_with_radius": np.pi * 0.3**2 * smoothstep_mean(np.cos(0.8), 0.5) * np.array([30.0, 20.0, 10.0]),
    "sun": np.pi * BALL.radius**2 * 2.0 * (1.0 - np.cos(0.1)) / np.sin(0.1) ** 2 * np.ones(3),
    "sun_without_size": np.pi * BALL.radius**2 * np.array([1.0, 0.5, 0.5]),
}


@pytest.mark.parametrize("name", FLUX)
def test_the_mean_weight_is_the_flux(name, rng):
    """Within 5 standard errors, or to rounding where every ray weighs the same."""
    weight = emit(light_sampler(LIGHTS[name], 1.0), rng).weight
    error = weight.std(axis=1) / np.sqrt(COUNT)
    assert np.all(np.abs(weight.mean(axis=1) - FLUX[name]) <= 5.0 * error + 1e-9 * FLUX[name])
    assert np.all(error <= 0.01 * FLUX[name])


@pytest.mark.parametrize("name", [name for name in ALL if not light_sampler(ALL[name], 1.0).delta])
def test_a_ray_back_meets_the_light_where_the_ray_left_it(name, rng):
    light = light_sampler(ALL[name], 1.0)
    rays = emit(light, rng)
    distance, radiance = light.intersect(rays.origin + 0.7 * rays.direction, -rays.direction)
    met = rays.brightness > 0.0
    assert met.mean() > (0.05 if name == "squeezed spot" else 0.5)  # most rays of that one leave outside its cone
    far = np.isinf(distance[met])
    np.testing.assert_allclose(distance[met][~far], 0.7, rtol=1e-9)
    np.testing.assert_allclose(luminance(radiance)[met], rays.brightness[met], rtol=1e-9)


@pytest.mark.parametrize("name", ["point", "stretched_spot", "beam", "sun_without_size"])
def test_no_ray_meets_a_light_without_size(name, rng):
    assert np.isinf(emit(light_sampler(LIGHTS[name], 1.0), rng).brightness).all()


PLACES = ((0.3, -0.5, 0.4, 0.4), (0.6, -0.5, 0.4, 0.3), (-1.5, 0.6, 0.4, 0.3))
TARGETS = [Ball(np.array(place)[:, None], radius, 0.0) for *place, radius in PLACES]


def flux_onto(rays, ball):
    """Weights (3, n) of the rays that pass a ball, 0 for the others."""
    beside = ball.center - rays.origin
    apart = beside - dot(beside, rays.direction) * rays.direction
    return rays.weight * ((dot(apart, apart) <= ball.radius**2) & (dot(beside, rays.direction) > 0.0))


@pytest.mark.grid(3)
@pytest.mark.parametrize("name", [name for name in ALL if isinstance(light_sampler(ALL[name], 1.0), Aimable)])
def test_aimed_rays_bring_the_same_flux_to_every_target(name, rng):
    """Two targets that overlap and one apart get the flux of rays that are not aimed.

    They agree within 5 standard errors, where 100 of these rays meet the target.
    """
    light = light_sampler(ALL[name], 1.0)
    direction, density = Aim(light.extent, TARGETS).sample(tuple(rng.random((2, COUNT))))
    aimed = light.emit_along(direction, density, tuple(rng.random((2, COUNT))))
    plain = light.emit(BALL, tuple(rng.random((2, 10 * COUNT))), tuple(rng.random((2, 10 * COUNT))))
    compared = 0
    for ball in TARGETS:
        of_aimed, of_plain = flux_onto(aimed, ball)[0], flux_onto(plain, ball)[0]
        if np.count_nonzero(of_plain) >= 100:
            error = np.hypot(of_aimed.std() / np.sqrt(COUNT), of_plain.std() / np.sqrt(10 * COUNT))
            assert abs(of_aimed.mean() - of_plain.mean()) <= 5.0 * error
            compared += 1
    assert compared > 0


def test_aimed_directions_have_the_density_that_they_state(rng):
    """The mean of 1 / density is the solid angle of the union of the cones.

    Here of one, and of one that is everywhere.
    """
    for radius, exact in ((0.5, 2.0 * np.pi * (1.0 - np.sqrt(1.0 - 0.25**2))), (2.5, 4.0 * np.pi)):
        at = Ball(np.array([[2.0], [0.0], [0.0]]), radius, 0.0)
        aim = Aim(Ball(np.zeros((3, 1)), 0.0, 0.0), [at, at])
        _, density = aim.sample(tuple(rng.random((2, 1000))))
        np.testing.assert_allclose(1.0 / density, exact, rtol=1e-9)
        assert aim.solid_angle == pytest.approx(2.0 * exact)


def test_light_from_afar_covers_the_ball_and_begins_outside(rng):
    rays = emit(light_sampler(LIGHTS["sun"], 1.0), rng)
    beside = rays.origin - BALL.center
    along = dot(beside, rays.direction)
    across = np.sqrt(dot(beside, beside) - along**2)
    np.testing.assert_allclose(along, -BALL.away, rtol=1e-9)
    assert across.max() <= BALL.radius * (1.0 + 1e-9)
    assert abs((across**2).mean() / BALL.radius**2 - 0.5) < 0.01  # uniform over the disc


def test_a_world_sends_its_radiance_from_everywhere(rng):
    """4 pi L through a disc of pi R^2.

    The table of an environment changes only how it is sampled.
    """
    flux = 4.0 * np.pi**2 * BALL.radius**2

    def radiance(direction):
        return np.stack([1.0 + direction[2], np.full(direction.shape[1], 0.5), 1.0 - direction[0]])

    table = emit(EnvironmentSampler(radiance, (32, 16)), rng).weight
    constant = emit(ConstantSky(np.array([[1.0], [0.5], [1.0]]), BALL), rng).weight
    np.testing.assert_allclose(constant.mean(axis=1), flux * np.array([1.0, 0.5, 1.0]), rtol=1e-9)
    error = table.std(axis=1) / np.sqrt(COUNT)
    assert np.all(np.abs(table.mean(axis=1) - flux * np.array([1.0, 0.5, 1.0])) <= 5.0 * error)


def test_emissive_faces_shine_from_both_sides(rng):
    """2 pi L A: an icosphere of known area, its rays leave half outwards."""
    lamp = icosphere(0.5, 1)
    built = scene(
        [lamp, floor(3.0, height=-2.0, material=1)],
        [emission(2.0, 3.0, 4.0), diffuse(0.5)],
        perspective(4, 4, 0.5, (0.0, 0.0, 3.0)),
    )
    kernel = Kernel(built, make_plan(built), Options())
    rays = emit(kernel.emissive[0], rng, bounding_ball(built.mesh.vertices))
    corners = [lamp.vertices[:, k] for k in lamp.triangles]
    area = 0.5 * np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0], axis=0), axis=0).sum()
    np.testing.assert_allclose(rays.weight.mean(axis=1), 2.0 * np.pi * area * np.array([2.0, 3.0, 4.0]), rtol=1e-9)
    outwards = dot(rays.origin, rays.direction) > 0.0
    assert abs(outwards.mean() - 0.5) < 0.02
    assert abs(dot(rays.origin / np.linalg.norm(rays.origin, axis=0), rays.direction)[outwards].mean() - 2 / 3) < 0.02


def test_a_light_without_area_sends_nothing(rng):
    closed = light_sampler(replace(LIGHTS["rectangle"], edge_v=(0.0, 0.0, 0.0)), 1.0)
    assert not emit(closed, rng).weight.any()
