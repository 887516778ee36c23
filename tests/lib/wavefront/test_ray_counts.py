# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders that use how often a path has scattered, or how long its last ray is.

Blender's Light Path node gives both.
"""

import numpy as np
import pytest
from etalon.lib.effects.facts import Facts
from etalon.lib.errors import Refused
from etalon.lib.scene.checks import SceneError, validate
from etalon.lib.scene.expressions import ZERO, Constant, Math, RayCount, ValueToColor
from etalon.lib.scene.lights import PointLight, SunLight
from etalon.lib.scene.materials import Diffuse, Emission, Metallic, Subsurface, Transparent
from etalon.lib.scene.rays import COUNTS, COUNTS_OF_ALL_RAYS
from etalon.lib.scene.world import World
from etalon.lib.wavefront.refuse import refuse_counts
from etalon.tests.replicates import assert_mean, assert_same, replicates
from etalon.tests.scenes import color, diffuse, floor, glass, material, orthographic, perspective, quad, scene
from scipy.integrate import dblquad

ABOVE = orthographic(2, 2, 1.0, (0.05, 0.1, 5.0))
UP = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (1.0, 1.0, 1.0))
MIRROR = material(Metallic("GGX", "F82", color(1.0), color(1.0)))
CLEAR = material(Transparent(color(1.0)))


def counted(name, scale=1.0):
    """A surface whose albedo is a count times `scale`."""
    return material(Diffuse(ValueToColor(Math("MULTIPLY", RayCount(name), Constant(scale), ZERO))))


def sheet(height, index):
    return quad((-3.0, -3.0, height), (6.0, 0.0, 0.0), (0.0, 6.0, 0.0), index)


def shown(the_scene, seed):
    return replicates(the_scene, 1, 8, seed=seed)[0]


@pytest.mark.parametrize(("name", "expected"), [("RAY_LENGTH", 0.5), ("RAY_DEPTH", 0.0), ("TRANSPARENT_DEPTH", 0.0)])
def test_a_face_that_the_camera_sees(name, expected, seed):
    """From 5 m above, with an albedo of a tenth of the count."""
    image = shown(scene(floor(3.0), counted(name, 0.1), ABOVE, [UP]), seed)
    np.testing.assert_allclose(image, expected / np.pi, rtol=1e-6, atol=1e-12)


@pytest.mark.parametrize(("name", "expected"), [("RAY_LENGTH", 0.5), ("RAY_DEPTH", 0.0), ("TRANSPARENT_DEPTH", 0.2)])
def test_a_face_behind_two_clear_sheets(name, expected, seed):
    """Passing is no scattering: lengths go on, depths stay, and sheets are counted."""
    parts = [floor(3.0), sheet(1.0, 1), sheet(3.0, 1)]
    image = shown(scene(parts, [counted(name, 0.1), CLEAR], ABOVE, [UP]), seed)
    np.testing.assert_allclose(image, expected / np.pi, rtol=1e-5, atol=1e-12)


@pytest.mark.parametrize(
    ("parts", "lamp", "expected"),
    [
        (
            [floor(3.0), sheet(7.0, 1)],
            6.0,
            {"RAY_DEPTH": 1, "GLOSSY_DEPTH": 1, "DIFFUSE_DEPTH": 0, "TRANSMISSION_DEPTH": 0, "RAY_LENGTH": 7.0},
        ),
        (
            [sheet(3.0, 0), floor(3.0, material=1)],
            1.5,
            {"RAY_DEPTH": 1, "GLOSSY_DEPTH": 0, "DIFFUSE_DEPTH": 0, "TRANSMISSION_DEPTH": 1, "RAY_LENGTH": 3.0},
        ),
    ],
    ids=["a ceiling in a mirror 7 m below it", "a floor 3 m below glass that bends nothing"],
)
def test_a_face_that_one_scattering_shows(parts, lamp, expected, seed):
    """It looks as one does whose albedo is a tenth of the count."""
    coat = MIRROR if lamp == 6.0 else glass(1.0)
    light = PointLight("point", (0.3, 0.2, lamp), (5.0, 4.0, 3.0))
    for name, count in expected.items():
        found, same = (
            shown(scene(parts, [coat, wall], ABOVE, [light], bounces=1), seed)
            for wall in (counted(name, 0.1), diffuse(0.1 * count))
        )
        np.testing.assert_allclose(found, same, rtol=1e-5, atol=1e-12, err_msg=name)
        assert bool(found.any()) == bool(count)


def test_a_wall_that_only_one_diffuse_bounce_sees_white(seed):
    """A wall with the diffuse depth for its albedo.

    It is black to the camera and lights the floor as a white one does.
    """
    room = [floor(3.0), quad((-1.0, 1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0), 1)]
    above = perspective(6, 6, 0.6, (0.0, -1.0, 4.0), (0.0, 1.0, -4.0))
    slanted = SunLight("sun", (0.0, -0.6, 0.8), 0.0, (1.0, 1.0, 1.0))

    def render(wall):
        return replicates(scene(room, [diffuse(0.8), wall], above, [slanted], bounces=1), 8, 256, seed=seed)

    grey = render(counted("DIFFUSE_DEPTH"))
    assert_same(grey, render(counted("RAY_DEPTH")), 0.02)
    floor_only = render(diffuse(1.0))[:, 3:]
    assert_same(grey[:, 3:], floor_only, 0.02)
    assert_same(render(counted("GLOSSY_DEPTH")), render(diffuse(0.0)), 0.02)


def veil(name, clear=0.2, scale=0.1):
    """A sheet that lets `clear` and `scale` times a count through."""
    counted_share = Math("MULTIPLY", RayCount(name), Constant(scale), ZERO)
    return material(Transparent(ValueToColor(Math("ADD", counted_share, Constant(clear), ZERO))))


@pytest.mark.parametrize(
    ("name", "counts"),
    [
        # Down to the floor the camera's ray meets the sheets at 3 m and 1 m, up from it the shadow ray those at 1 m and 3 m.
        ("RAY_DEPTH", (0, 0, 1, 1)),
        ("RAY_LENGTH", (2, 4, 1, 3)),
        ("TRANSPARENT_DEPTH", (0, 1, 2, 3)),
    ],
)
@pytest.mark.parametrize("light", [UP, PointLight("point", (0.0, 0.0, 4.5), (9.0, 9.0, 9.0))])
def test_light_passes_faces_by_the_count_that_its_ray_has_there(name, counts, light, seed):
    """Camera and shadow rays go upright through two sheets."""
    parts = [floor(3.0), sheet(1.0, 1), sheet(3.0, 1)]
    above = orthographic(1, 1, 1e-6, (0.0, 0.0, 5.0))
    clear = shown(scene(parts, [diffuse(0.8), CLEAR], above, [light]), seed)
    image = shown(scene(parts, [diffuse(0.8), veil(name)], above, [light]), seed)
    np.testing.assert_allclose(image, clear * np.prod([0.2 + 0.1 * k for k in counts]), rtol=1e-5)


@pytest.mark.parametrize("name", COUNTS_OF_ALL_RAYS)
@pytest.mark.parametrize("direct", ["bsdf", "lights"])
def test_faces_let_through_what_is_sampled_either_way_alike(name, direct, seed):
    """Two veils below a lamp, seen from below them, and a second scattering."""
    parts = [floor(3.0), sheet(1.0, 1), sheet(1.5, 1), quad((-1.0, -1.0, 2.5), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), 2)]
    inside = perspective(4, 4, 0.8, (0.0, 0.0, 0.9))
    room = scene(parts, [diffuse(0.8), veil(name), material(Emission(color(3.0)))], inside, bounces=1)
    weighed = replicates(room, 8, 256, seed=seed)
    assert_same(weighed, replicates(room, 8, 1024, seed=seed + 1, direct=direct), 0.05)


def glow(length_power):
    """A lamp whose radiance is 3 times a power of the ray's length."""
    power = Math("POWER", RayCount("RAY_LENGTH"), Constant(length_power), ZERO)
    return material(Emission(color(3.0), power))


@pytest.mark.parametrize("power", [1.0, 2.0])
@pytest.mark.parametrize("direct", ["mis", "bsdf", "lights"])
def test_a_lamp_that_falls_off_otherwise_lights_a_floor_as_quadrature_has_it(power, direct, seed):
    """From 2 m above, through a clear sheet, with the cosines at both ends and the square of the distance."""
    lamp = quad((-1.5, -0.5, 2.0), (3.0, 0.0, 0.0), (0.0, 1.0, 0.0), 2)
    looking = orthographic(1, 1, 1e-6, (0.3, 0.1, 0.9))
    room = scene([floor(3.0), sheet(1.0, 1), lamp], [diffuse(0.8), CLEAR, glow(power)], looking)
    images = replicates(room, 8, 4096 if direct == "bsdf" else 512, seed=seed, direct=direct)

    def irradiance(y, x):
        distance = np.sqrt((x - 0.3) ** 2 + (y - 0.1) ** 2 + 4.0)
        return 3.0 * distance**power * (2.0 / distance) ** 2 / distance**2

    assert_mean(images, 0.8 / np.pi * dblquad(irradiance, -1.5, 1.5, -0.5, 0.5)[0], 0.01)


def test_a_lamp_that_falls_off_otherwise_looks_as_bright_as_its_way_is_long(seed):
    parts = [floor(3.0), sheet(2.0, 1)]
    image = shown(scene(parts, [glow(1.0), CLEAR], ABOVE), seed)
    np.testing.assert_allclose(image, 15.0, rtol=1e-6)


@pytest.mark.parametrize(("kind", "name"), [(Emission, "RAY_DEPTH"), (Transparent, "DIFFUSE_DEPTH")])
def test_what_light_samples_and_shadow_rays_count_otherwise_is_refused(kind, name):
    closure = kind(ValueToColor(RayCount(name)))
    with pytest.raises(SceneError, match="depends on how often a path has scattered"):
        validate(scene(floor(), material(closure), ABOVE))


def test_what_only_surfaces_know_is_refused_elsewhere():
    with pytest.raises(SceneError, match="a world does not know"):
        validate(scene(floor(), diffuse(0.5), ABOVE, world=World(ValueToColor(RayCount("RAY_DEPTH")), (8, 4))))
    with pytest.raises(SceneError, match="nothing that rays count is called 'AGE'"):
        validate(scene(floor(), counted("AGE"), ABOVE))
    with pytest.raises(Refused, match="beside the subsurface scattering of"):
        refuse_counts(
            Facts(scene([floor(), sheet(1.0, 1)], [counted("RAY_DEPTH"), material(Subsurface())], ABOVE, [UP]))
        )


def test_every_count_has_a_row_in_the_tally():
    assert len(COUNTS) == 6
