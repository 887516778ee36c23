# SPDX-License-Identifier: GPL-3.0-or-later
"""Light tracing against closed forms.

They are irradiance on a Lambert plane, furnaces, and a box of lamps.
"""

import numpy as np
import pytest
from etalon.lib.scene.lights import PointLight, SphereLight, SunLight
from etalon.lib.scene.materials import Diffuse, Emission
from etalon.tests.lib.light_tracing.traced import light_traced
from etalon.tests.lib.wavefront.test_direct_light import ALBEDO, from_polygon, lit, over_pixels, rectangle
from etalon.tests.replicates import assert_mean
from etalon.tests.scenes import color, cube, diffuse, icosphere, material, perspective, scene


@pytest.mark.slow
def test_rectangle(seed):
    """Lambert's sum over the edges."""
    light, corners = rectangle(tilted=True)
    exact = 3.0 * over_pixels(from_polygon(corners))
    assert_mean(light_traced(lit([light]), 12, 4096, seed=seed), exact, 0.02)


@pytest.mark.slow
def test_point(seed):
    """I cos / D^2."""
    light = PointLight("point", (0.3, 0.2, 0.8), (1.0, 1.0, 1.0))
    exact = over_pixels(lambda x, y: 0.8 / ((x - 0.3) ** 2 + (y - 0.2) ** 2 + 0.64) ** 1.5)
    assert_mean(light_traced(lit([light]), 12, 4096, seed=seed), exact, 0.02)


@pytest.mark.slow
def test_small_sphere(seed):
    """pi L (r / D)^2 cos."""
    light = SphereLight("sphere", (0.3, 0.2, 1.0), 0.05, (200.0,) * 3)
    exact = over_pixels(lambda x, y: np.pi * 0.05**2 / ((x - 0.3) ** 2 + (y - 0.2) ** 2 + 1.0) ** 1.5)
    assert_mean(light_traced(lit([light]), 12, 4096, seed=seed), 200.0 * exact, 0.02)


@pytest.mark.parametrize("angle", [pytest.param(0.0, marks=pytest.mark.slow), 0.4])
def test_sun(angle, seed):
    """Irradiance times the cosine to the middle of the disk."""
    direction = np.array([0.3, -0.2, 0.8])
    direction /= np.linalg.norm(direction)
    light = SunLight("sun", tuple(direction), angle, (2.0, 2.0, 2.0))
    exact = 2.0 * direction[2] * ALBEDO / np.pi
    assert_mean(light_traced(lit([light]), 12, 4096, seed=seed), exact, 0.02)


@pytest.mark.slow
def test_a_white_sphere_vanishes_in_a_white_world(seed):
    """Radiance is 1 everywhere.

    That is where the camera sees the sphere, and where it sees the world past it.
    """
    sphere = scene(icosphere(1.5, 2), diffuse(1.0), perspective(6, 6, 0.8, (0.0, 0.0, 4.0)), world=1.0)
    assert_mean(light_traced(sphere, 12, 2048, seed=seed), 1.0, 0.02)


def test_walls_that_shine_and_reflect_add_up_to_a_geometric_series(seed):
    """A closed box of radiance L and albedo a: L (1 + a + a^2 + ...).

    There is one term for each scattering that the bounces allow.
    """
    albedo, radiance, bounces = 0.6, 2.0, 2
    walls = material(Diffuse(color(albedo)), Emission(color(radiance)))
    box = scene(cube(1.0), walls, perspective(4, 4, 0.8, (0.03, -0.9, 0.1), (0.1, 1.0, -0.2)), bounces=bounces)
    exact = radiance * sum(albedo**k for k in range(bounces + 2))
    assert_mean(light_traced(box, 12, 2048, seed=seed), exact, 0.02)
