# SPDX-License-Identifier: GPL-3.0-or-later
"""A Lambert plane under one light of each kind.

The irradiance has a closed form, averaged over each pixel's footprint.
"""

import numpy as np
import pytest
from etalon.lib.scene.expressions import (
    ZERO,
    Constant,
    Coordinates,
    EnvironmentTexture,
    Math,
    ValueToColor,
    VectorToValue,
)
from etalon.lib.scene.images import Image
from etalon.lib.scene.lights import AreaLight, Cone, PointLight, SphereLight, SpotLight, SunLight
from etalon.lib.scene.materials import Material
from etalon.lib.scene.rays import SCATTERED, SEEN
from etalon.lib.scene.world import World
from etalon.tests.replicates import assert_mean, assert_same, replicates
from etalon.tests.scenes import diffuse, emission, fan, fan_camera, floor, orthographic, quad, scene

ALBEDO = np.array([0.8, 0.5, 0.2])
SIZE, PIXELS = 2.0, 4
CAMERA = orthographic(PIXELS, PIXELS, SIZE, (0.0, 0.0, 0.9))
# Standard errors of the mean, relative, that the tests ask for; what is met is mostly far less.
PRECISION = {"mis": 0.01, "lights": 0.01, "bsdf": 0.09}
# The default run finds light by both ways together; each alone is a slow test.
DIRECT = pytest.mark.parametrize(
    "direct", ["mis", *(pytest.param(way, marks=pytest.mark.slow) for way in ("lights", "bsdf"))]
)


def lit(lights=(), parts=(), materials=(), **more):
    return scene([floor(3.0), *parts], [diffuse(*ALBEDO), *materials], CAMERA, lights, **more)


def over_pixels(irradiance, nodes=8):
    """Mean of irradiance(x, y) over each pixel, times albedo / pi.

    It is the image (PIXELS, PIXELS, 3), row 0 at the largest y.
    """
    x, w = np.polynomial.legendre.leggauss(nodes)
    step = SIZE / PIXELS
    at = -0.5 * SIZE + step * (np.arange(PIXELS)[:, None] + 0.5 * (x + 1.0))
    grid_x, grid_y = np.meshgrid(at.ravel(), at.ravel())
    value = irradiance(grid_x, grid_y).reshape(PIXELS, nodes, PIXELS, nodes)
    mean = np.einsum("ikjl,k,l->ij", value, 0.5 * w, 0.5 * w)[::-1]
    return mean[:, :, None] * ALBEDO / np.pi


def from_polygon(corners):
    """Irradiance on a plane of normal +z from a polygon of radiance 1.

    It is Lambert's sum over its edges; corners (k, 3) are seen from x, y, 0.
    """

    def irradiance(x, y):
        ray = np.array(corners, float)[:, :, None, None] - np.stack([x, y, np.zeros_like(x)])
        ray = ray / np.sqrt((ray**2).sum(axis=1, keepdims=True))
        total = 0.0
        for a, b in zip(ray, np.roll(ray, -1, axis=0), strict=True):
            normal = np.cross(a, b, axis=0)
            length = np.sqrt((normal**2).sum(axis=0))
            total = total + np.arctan2(length, (a * b).sum(axis=0)) * normal[2] / length
        return np.abs(0.5 * total)

    return irradiance


def rectangle(radiance=3.0, tilted=False, visible=False, shape="RECTANGLE"):
    """A light about (0.3, 0.2, 1.5), level or tilted about y, and its corners."""
    u, v = np.array([1.2, 0.0, 0.5 if tilted else 0.0]), np.array([0.0, -0.8, 0.0])
    normal = np.cross(u, v)
    normal /= np.linalg.norm(normal)
    center = np.array([0.3, 0.2, 1.5])
    rays = SEEN if visible else SCATTERED
    light = AreaLight(
        "area", tuple(center), tuple(u), tuple(v), tuple(normal), shape, (radiance,) * 3, np.pi, rays=rays
    )
    return light, [center + 0.5 * (a * u + b * v) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


@DIRECT
@pytest.mark.parametrize("tilted", [False, True])
def test_rectangle(direct, tilted, seed):
    light, corners = rectangle(tilted=tilted)
    assert light.normal[2] < 0.0
    images = replicates(lit([light]), 10, 256, direct=direct, seed=seed)
    assert_mean(images, 3.0 * over_pixels(from_polygon(corners)), PRECISION[direct])


@DIRECT
def test_disk(direct, seed):
    """Howell's configuration factor C-12.

    It is a disk of radius r at height h, seen from a parallel element at distance d off its axis.
    """
    r, h = 0.6, 1.2
    light = AreaLight(
        "disk", (0.2, -0.3, h), (2 * r, 0.0, 0.0), (0.0, -2 * r, 0.0), (0, 0, -1.0), "ELLIPSE", (2.0,) * 3, np.pi
    )

    def irradiance(x, y):
        d2 = (x - 0.2) ** 2 + (y + 0.3) ** 2
        return 0.5 * np.pi * (1.0 - (h * h + d2 - r * r) / np.sqrt((h * h + d2 + r * r) ** 2 - 4.0 * r * r * d2))

    images = replicates(lit([light]), 10, 256, direct=direct, seed=seed)
    assert_mean(images, 2.0 * over_pixels(irradiance), PRECISION[direct])


@DIRECT
def test_sphere(direct, seed):
    """A sphere wholly above the horizon: pi L (r / D)^2 cos, by projected solid angle."""
    center, r = np.array([0.3, 0.2, 1.0]), 0.5
    light = SphereLight("sphere", tuple(center), r, (2.0,) * 3)

    def irradiance(x, y):
        d2 = (x - center[0]) ** 2 + (y - center[1]) ** 2 + center[2] ** 2
        return np.pi * r * r * center[2] / d2**1.5

    images = replicates(lit([light]), 10, 256, direct=direct, seed=seed)
    assert_mean(images, 2.0 * over_pixels(irradiance), PRECISION[direct])


@DIRECT
def test_point(direct, seed):
    """I cos / D^2; no strategy but light sampling finds it, so that `direct` does not matter."""
    light = PointLight("point", (0.3, 0.2, 0.8), (1.0, 1.0, 1.0))
    exact = over_pixels(lambda x, y: 0.8 / ((x - 0.3) ** 2 + (y - 0.2) ** 2 + 0.64) ** 1.5)
    assert_mean(replicates(lit([light]), 10, 256, direct=direct, seed=seed), exact, 5e-4)


def test_spot(seed):
    """The same times smoothstep((cos - cos b) / ((1 - cos b) blend))."""
    edge, blend = np.cos(0.9), 0.5
    light = SpotLight(
        "spot", (0.3, 0.2, 0.8), 0.0, (1.0,) * 3, Cone((0, 0, -1.0), (1.0, 0, 0), (0, 1.0, 0), edge, blend)
    )

    def irradiance(x, y):
        d2 = (x - 0.3) ** 2 + (y - 0.2) ** 2 + 0.64
        s = np.clip((0.8 / np.sqrt(d2) - edge) / ((1.0 - edge) * blend), 0.0, 1.0)
        return 0.8 / d2**1.5 * s * s * (3.0 - 2.0 * s)

    assert_mean(replicates(lit([light]), 10, 256, seed=seed), over_pixels(irradiance, 48), 2e-3, rounding=1e-4)


@DIRECT
@pytest.mark.parametrize("angle", [0.0, 0.01, 0.4])
def test_sun(direct, angle, seed):
    """Irradiance times the cosine to the middle of the disk, however wide.

    The disk is above the horizon.
    """
    towards = np.array([0.6, 0.2, 0.7])
    towards /= np.linalg.norm(towards)
    light = SunLight("sun", tuple(towards), angle, (2.0,) * 3)
    if direct == "bsdf" and angle == 0.01:
        return  # a disk of 3e-4 sr is not for BSDF sampling
    images = replicates(lit([light]), 10, 256, direct=direct, seed=seed)
    mean = images.mean(axis=(1, 2), keepdims=True)
    assert_mean(mean, 2.0 * towards[2] * ALBEDO / np.pi, PRECISION[direct])


def test_several_lights_add_up(seed):
    """Of very unequal power, so that selection matters: the image is the sum of the images."""
    light, corners = rectangle()
    point = PointLight("point", (-0.5, -0.4, 0.6), (0.05, 0.05, 0.05))
    sun = SunLight("sun", (0.0, 0.0, 1.0), 0.1, (0.3, 0.3, 0.3))
    exact = 3.0 * over_pixels(from_polygon(corners)) + 0.3 * ALBEDO / np.pi
    exact = exact + 0.05 * over_pixels(lambda x, y: 0.6 / ((x + 0.5) ** 2 + (y + 0.4) ** 2 + 0.36) ** 1.5)
    assert_mean(replicates(lit([light, point, sun]), 10, 1024, seed=seed), exact, 0.01)


@pytest.mark.parametrize("far", [30.0, 1e5, 1e12])
def test_a_lamp_is_not_lost_beside_a_sun_however_far_the_scene_reaches(far, seed):
    point = PointLight("point", (0.3, 0.2, 0.8), (1.0, 1.0, 1.0))
    sun = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (0.3, 0.3, 0.3))
    exact = over_pixels(lambda x, y: 0.8 / ((x - 0.3) ** 2 + (y - 0.2) ** 2 + 0.64) ** 1.5) + 0.3 * ALBEDO / np.pi
    aside = quad((far, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    assert_mean(replicates(lit([point, sun], [aside]), 10, 1024, seed=seed), exact, 0.05)


@pytest.mark.parametrize("strength", [1.0, 1e6, 1e12])
def test_a_lamp_under_a_roof_is_not_lost_beside_a_bright_sun(strength, seed):
    """The roof keeps the sun out.

    All the light is the lamp's, which is chosen once in 32 times at least.
    """
    point = PointLight("point", (0.3, 0.2, 0.8), (1.0, 1.0, 1.0))
    sun = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (strength,) * 3)
    roof = quad((-9.0, -9.0, 1.0), (18.0, 0.0, 0.0), (0.0, 18.0, 0.0))
    exact = over_pixels(lambda x, y: 0.8 / ((x - 0.3) ** 2 + (y - 0.2) ** 2 + 0.64) ** 1.5)
    assert_mean(replicates(lit([point, sun], [roof]), 10, 1024, seed=seed), exact, 0.06)


@DIRECT
def test_half_shadow(direct, seed):
    """A black wall in the plane x = 0.3 hides from each side the light's other half, exactly."""
    light, corners = rectangle()
    wall = quad((0.3, -50.0, 0.0), (0.0, 100.0, 0.0), (0.0, 0.0, 50.0), 1)
    left, right = [np.array(c) for c in corners], [np.array(c) for c in corners]
    for k in range(4):
        left[k][0], right[k][0] = min(left[k][0], 0.3), max(right[k][0], 0.3)
    images = replicates(lit([light], [wall], [Material("black", ())]), 10, 256, direct=direct, seed=seed)
    exact = 3.0 * np.where(
        np.arange(PIXELS)[:, None] < 2, over_pixels(from_polygon(left)), over_pixels(from_polygon(right))
    )
    keep = [0, 1, 3]  # the third column of pixels stands astride the wall
    assert_mean(images[:, :, keep], exact[:, keep], 2.0 * PRECISION[direct])


@DIRECT
@pytest.mark.parametrize("tilted", [False, True])
def test_mesh_light_is_the_area_light(direct, tilted, seed):
    """An emissive quad, against the closed form of the area light.

    The floor sees one of its faces.
    """
    light, corners = rectangle(tilted=tilted)
    lamp = quad(corners[0], np.array(light.edge_u), np.array(light.edge_v), 1)
    images = replicates(lit((), [lamp], [emission(3.0)]), 10, 256, direct=direct, seed=seed)
    assert_mean(images, 3.0 * over_pixels(from_polygon(corners)), PRECISION[direct])


@DIRECT
def test_lamp_that_is_nearly_edge_on(direct, seed):
    """A vertical emissive strip whose face the floor sees at grazing angles only.

    It must not hide behind itself.
    """
    corners = [np.array([-3.0, -0.02, h]) for h in (0.0, 2.0)] + [np.array([3.0, 0.0, h]) for h in (2.0, 0.0)]
    lamp = quad(corners[0] + [0.0, 0.0, 1e-4], (0.0, 0.0, 2.0), (6.0, 0.02, 0.0), 1)
    above = [np.array([c[0], c[1], max(c[2], 1e-4)]) for c in corners]
    camera = orthographic(PIXELS, 1, 0.2, (0.0, -2.9, 0.9), (0.0, 0.0, -1.0))
    lamp_scene = scene([floor(3.0), lamp], [diffuse(*ALBEDO), emission(3.0)], camera)
    middle = [from_polygon(above)(np.array([[x]]), np.array([[-2.9]])).item() for x in (-0.075, -0.025, 0.025, 0.075)]
    exact = 3.0 * np.array(middle)[None, :, None] * ALBEDO / np.pi
    images = replicates(lamp_scene, 10, 256, direct=direct, seed=seed)
    assert_mean(images, exact, 0.05, rounding=1e-3)


def test_visible_lights_are_seen_and_seen_through(seed):
    """Seen by the camera, the light's radiance adds to what lies behind it, as in Cycles.

    Otherwise nothing of it is seen.
    """
    light, _ = rectangle(visible=True)
    camera = orthographic(1, 1, 0.01, (0.3, 0.2, 2.0), (0.0, 0.0, -1.0))
    below = orthographic(1, 1, 0.01, (0.3, 0.2, 0.1), (0.0, 0.0, 1.0))
    white = {"world": 0.5, "materials": [diffuse(*ALBEDO)], "geometry": [floor(3.0)]}
    front = replicates(scene(camera=below, lights=[light], **white), 2, 16, seed=seed)
    np.testing.assert_allclose(front, 3.0 + 0.5, rtol=1e-12)
    hidden, _ = rectangle()
    np.testing.assert_allclose(
        replicates(scene(camera=below, lights=[hidden], **white), 2, 16, seed=seed), 0.5, rtol=1e-12
    )
    behind = [replicates(scene(camera=camera, lights=[x], **white), 10, 64, seed=seed) for x in (light, hidden)]
    np.testing.assert_allclose(behind[0], behind[1], rtol=1e-12)  # the back of an area light is nothing at all


# Radiance 0.7 plus the mean component of the direction, positive everywhere.
SLOPED_SKY = World(ValueToColor(Math("ADD", VectorToValue(Coordinates("GENERATED")), Constant(0.7), ZERO)), (64, 32))
TILTS = np.radians([-60.0, -30.0, 0.0, 30.0, 60.0, 80.0])


def tilted_normals():
    """Normals of the fan's facets: the profile falls by tan(angle) towards +x."""
    return np.stack([np.sin(TILTS), np.zeros_like(TILTS), np.cos(TILTS)])


@DIRECT
def test_sloped_sky(direct, seed):
    """The integral of w cos over the hemisphere about n is (2 pi / 3) n."""
    sky = scene(fan(TILTS), diffuse(*ALBEDO), fan_camera(TILTS), world=SLOPED_SKY)
    exact = (0.7 + 2.0 / 9.0 * tilted_normals().sum(axis=0))[None, :, None] * ALBEDO
    assert_mean(replicates(sky, 10, 512, direct=direct, seed=seed), exact, 5e-3)


@DIRECT
def test_environment_map(direct, seed, rng):
    """Random texels, one of them a thousand times brighter.

    They are compared with a fine midpoint sum over directions, by Blender's mapping.
    """
    width, height = 16, 8
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = rng.random((height, width, 3)) ** 4
    pixels[5, 3, :3] = 80.0 if direct != "bsdf" else 4.0  # row 0 is the lowest
    world = World(EnvironmentTexture(Coordinates("GENERATED"), 0, "CLOSEST"), (width, height))
    env = scene(fan(TILTS), diffuse(*ALBEDO), fan_camera(TILTS), world=world, images=[Image("sky", pixels, "LINEAR")])
    theta = np.pi * (np.arange(800) + 0.5) / 800
    phi = np.pi - 2.0 * np.pi * (np.arange(1600) + 0.5) / 1600  # u = 1/2 - phi / 2 pi grows as phi falls
    sky = np.repeat(np.repeat(pixels[::-1, :, :3].astype(float), 100, axis=0), 100, axis=1)
    sine, cosine = np.sin(theta)[:, None], np.cos(theta)[:, None]
    exact = []
    for n in tilted_normals().T:
        cos = np.maximum(n[0] * sine * np.cos(phi) + n[1] * sine * np.sin(phi) + n[2] * cosine, 0.0)
        exact.append((sky * (cos * sine)[..., None]).sum(axis=(0, 1)) * 2.0 * np.pi**2 / 800 / 1600)
    exact = np.array(exact)[None] * ALBEDO / np.pi
    images = replicates(env, 10, 512, direct=direct, seed=seed)
    assert_mean(images, exact, 0.02, rounding=1e-4)


def test_one_constant_sky_is_the_same_as_an_environment(seed):
    """A world that depends on the direction in form only is sampled by the table.

    The image is that of the constant.
    """
    flat = Math("MULTIPLY", VectorToValue(Coordinates("GENERATED")), ZERO, ZERO)
    table = World(ValueToColor(Math("ADD", flat, Constant(0.6), ZERO)), (32, 16))
    images = [
        replicates(scene(fan(TILTS), diffuse(*ALBEDO), fan_camera(TILTS), world=w), 10, 256, seed=seed)
        for w in (table, 0.6)
    ]
    assert_same(*images, 2e-3)
    np.testing.assert_allclose(images[1], np.broadcast_to(0.6 * ALBEDO, images[1].shape), rtol=1e-12)
