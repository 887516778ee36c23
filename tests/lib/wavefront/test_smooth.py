# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth shading: normals mix over the triangle.

Light below the face's horizon is rejected by every way of sampling alike.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.scene.expressions import ZERO, Constant, Coordinates, Math, ValueToColor, VectorToValue
from etalon.lib.scene.lights import AreaLight, SphereLight, SunLight
from etalon.lib.scene.world import World
from etalon.tests.replicates import LEVEL, assert_mean, assert_same, blocks, replicates
from etalon.tests.scenes import Part, diffuse, floor, glossy, icosphere, orthographic, scene

# A sky that is sampled by its table although it is the same everywhere.
FLAT = Math("MULTIPLY", VectorToValue(Coordinates("GENERATED")), ZERO, ZERO)
SAMPLED_SKY = World(ValueToColor(Math("ADD", FLAT, Constant(1.0), ZERO)), (16, 8))


def tilted_floor(degrees, half=3.0):
    """A level floor whose shading normal leans towards +x everywhere."""
    flat = floor(half)
    normal = np.array([np.sin(np.radians(degrees)), 0.0, np.cos(np.radians(degrees))])
    return replace(flat, normals=np.repeat(normal[:, None], flat.vertices.shape[1], axis=1))


def towards(degrees):
    """The direction that leans by `degrees` towards +x."""
    return (float(np.sin(np.radians(degrees))), 0.0, float(np.cos(np.radians(degrees))))


ABOVE = orthographic(2, 2, 0.5, (0.03, 0.02, 2.0))


@pytest.mark.parametrize("tilt", [0.0, 10.0, 30.0])
@pytest.mark.parametrize("sun", [-60.0, 0.0, 40.0, 80.0, 95.0, 110.0])
def test_a_sun_shows_the_shading_normal(tilt, sun, seed):
    """albedo / pi times the cosine to the shading normal.

    Nothing at all comes from below the face or the shading normal.
    """
    light = SunLight("sun", towards(sun), 0.0, (1.0, 1.0, 1.0))
    image = replicates(scene(tilted_floor(tilt), diffuse(0.8), ABOVE, [light]), 1, 4, seed=seed)
    cos = np.cos(np.radians(sun - tilt)) if abs(sun) < 90.0 and abs(sun - tilt) < 90.0 else 0.0
    np.testing.assert_allclose(image, 0.8 / np.pi * max(cos, 0.0), rtol=1e-6, atol=1e-15)


@pytest.mark.grid(3)
@pytest.mark.parametrize("direct", ["mis", "lights", "bsdf"])
@pytest.mark.parametrize("world", [1.0, SAMPLED_SKY], ids=["constant", "sampled"])
@pytest.mark.parametrize("tilt", [10.0, 30.0, 60.0])
def test_the_part_of_the_sky_that_both_normals_see(direct, world, tilt, seed):
    """Lambert under a white sky: (1 + cos tilt) / 2, by any way of sampling.

    It is the integral of the cosine over the common hemisphere. (Cycles rejects by BSDF sampling only: its sampled sky
    gives more.)
    """
    images = replicates(scene(tilted_floor(tilt), diffuse(1.0), ABOVE, world=world), 10, 128, direct=direct, seed=seed)
    assert_mean(images.mean(axis=(1, 2), keepdims=True), (1.0 + np.cos(np.radians(tilt))) / 2.0, 0.01, rounding=1e-6)


@pytest.mark.grid(3)
@pytest.mark.parametrize("ground", [diffuse(0.8), glossy(0.2), glossy(0.5)], ids=["diffuse", "glossy", "rough"])
def test_lights_and_bsdf_agree(ground, seed):
    """A low sphere light and an area light, on a leaning normal; seen at a slant.

    Half of the sphere light is below the shading horizon.
    """
    lights = [
        SphereLight("low", (-2.5, 0.0, 0.6), 0.5, (3.0, 3.0, 3.0)),
        AreaLight(
            "area",
            (1.0, 0.0, 1.5),
            (1.0, 0.0, 0.0),
            (0.0, -1.0, 0.0),
            (0.0, 0.0, -1.0),
            "RECTANGLE",
            (3.0, 3.0, 3.0),
            np.pi,
        ),
    ]
    camera = orthographic(4, 4, 1.0, (-1.5, 0.0, 1.2), (1.5, 0.0, -1.2))
    the_scene = scene(tilted_floor(25.0), ground, camera, lights)
    both = blocks(replicates(the_scene, 10, 128, seed=seed), 4)
    for offset, direct in enumerate(("lights", "bsdf"), start=1):
        alone = blocks(replicates(the_scene, 20, 128, seed=seed + offset, direct=direct), 4)
        assert_same(both, alone, 0.03, level=LEVEL / 2)


def test_normals_mix_over_the_triangle(seed):
    """One triangle with three corner normals under a sun.

    The normal is the normalised barycentric mix, averaged over each pixel.
    """
    vertices = np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]).T
    normals = np.array([[0.0, 0.0, 1.0], [0.5, 0.0, 1.0], [-0.2, 0.6, 1.0]]).T
    normals = normals / np.sqrt((normals**2).sum(axis=0))
    triangle = Part(vertices, np.array([[0], [1], [2]]), 0, normals)
    sun = np.array([0.3, 0.2, 0.9])
    sun /= np.linalg.norm(sun)
    camera = orthographic(4, 4, 1.8, (1.0, 1.0, 5.0))
    image = replicates(
        scene(triangle, diffuse(0.8), camera, [SunLight("sun", tuple(sun), 0.0, (1.0,) * 3)]), 8, 64, seed=seed
    )
    node, weight = np.polynomial.legendre.leggauss(6)
    at = (1.0 - 0.9 + 0.45 * (np.arange(4)[:, None] + 0.5 * (node + 1.0))).ravel()
    x, y = np.meshgrid(at, at)
    u, v = x / 4.0, y / 4.0
    n = normals[:, 0, None, None] * (1.0 - u - v) + normals[:, 1, None, None] * u + normals[:, 2, None, None] * v
    cos = np.einsum("kij,k->ij", n, sun) / np.sqrt((n**2).sum(axis=0))
    exact = np.einsum("iajb,a,b->ij", cos.reshape(4, 6, 4, 6), 0.5 * weight, 0.5 * weight)[::-1]
    assert_mean(image, 0.8 / np.pi * exact[:, :, None], 1e-3, rounding=1e-6)


def test_a_smooth_sphere_is_the_sphere_s_own_normals(seed):
    """Corner normals of a fine icosphere.

    A Lambert ball under a sun along the view shows cos = sqrt(1 - r^2) / R.
    """
    sun = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (1.0, 1.0, 1.0))
    camera = orthographic(8, 8, 1.6, (0.0, 0.0, 5.0))
    images = replicates(scene(icosphere(1.0, 5, smooth=True), diffuse(1.0), camera, [sun]), 8, 64, seed=seed)
    node, weight = np.polynomial.legendre.leggauss(8)
    at = (0.2 * (np.arange(8)[:, None] + 0.5 * (node + 1.0)) - 0.8).ravel()
    x, y = np.meshgrid(at, at)
    inside = x * x + y * y < 0.9
    cos = np.sqrt(np.where(inside, 1.0 - x * x - y * y, 0.0)).reshape(8, 8, 8, 8)
    exact = np.einsum("iajb,a,b->ij", cos, 0.5 * weight, 0.5 * weight)
    whole = inside.reshape(8, 8, 8, 8).all(axis=(1, 3))
    assert whole.sum() > 40
    assert_mean(images[:, whole][:, :, None], exact[whole][:, None, None] / np.pi, 1e-3, rounding=5e-4)


def test_flat_and_smooth_in_one_mesh(seed):
    """Each face keeps its own kind: beside a leaning floor, a flat one."""
    light = SunLight("sun", towards(40.0), 0.0, (1.0, 1.0, 1.0))
    leaning, flat = tilted_floor(30.0, 0.5), floor(0.5)
    flat = Part(flat.vertices + np.array([[1.0], [0.0], [0.0]]), flat.triangles)
    camera = orthographic(2, 1, 1.8, (0.5, 0.03, 2.0))
    image = replicates(scene([leaning, flat], diffuse(0.8), camera, [light]), 1, 16, seed=seed)[0]
    np.testing.assert_allclose(image[0, 0], 0.8 / np.pi * np.cos(np.radians(10.0)), rtol=1e-6)
    np.testing.assert_allclose(image[0, 1], 0.8 / np.pi * np.cos(np.radians(40.0)), rtol=1e-6)


def test_the_back_of_a_smooth_face_turns_its_normals_over(seed):
    """Seen from below with a sun below: the same image as from above."""
    below = orthographic(2, 2, 0.5, (0.03, 0.02, -2.0), (0.0, 0.0, 1.0))
    sun = SunLight("sun", tuple(-np.array(towards(40.0))), 0.0, (1.0, 1.0, 1.0))
    image = replicates(scene(tilted_floor(30.0), diffuse(0.8), below, [sun]), 1, 4, seed=seed)
    np.testing.assert_allclose(image, 0.8 / np.pi * np.cos(np.radians(10.0)), rtol=1e-6)
