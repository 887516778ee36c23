# SPDX-License-Identifier: GPL-3.0-or-later
"""However it is sampled, it is the same image.

Tested are strategies, direct light, samplers, and pairs of these.
"""

import zlib
from functools import cache

import numpy as np
import pytest
from etalon.lib.scene.expressions import ZERO, Constant, Coordinates, Math, ValueToColor, VectorToValue
from etalon.lib.scene.lights import AreaLight, PointLight, SphereLight, SunLight
from etalon.lib.scene.materials import Diffuse, Glossy
from etalon.lib.scene.world import World
from etalon.tests.replicates import LEVEL, assert_same, blocks, replicates
from etalon.tests.scenes import (
    color,
    cube,
    emission,
    floor,
    glossy,
    icosphere,
    material,
    perspective,
    quad,
    scene,
    transparent,
)

AREA = AreaLight(
    "area", (1.5, -0.5, 2.5), (1.5, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", (6.0, 5.0, 4.0), np.pi
)
ELLIPSE = AreaLight(
    "ellipse", (-1.5, 0.5, 2.5), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), "ELLIPSE", (4.0, 8.0, 4.0), 1.5
)
SPHERE = SphereLight("sphere", (-1.2, -1.2, 1.5), 0.4, (5.0, 5.0, 9.0))
POINT = PointLight("point", (0.0, 2.0, 2.0), (2.0, 1.0, 0.5))
SUN = SunLight("sun", (0.6, 0.0, 0.8), 0.1, (1.0, 1.0, 1.0))
# A sky that is brighter towards +x +y +z: the mean component of the direction, made positive.
SKY = World(ValueToColor(Math("ADD", VectorToValue(Coordinates("GENERATED")), Constant(0.7), ZERO)), (64, 32))
CAMERA = perspective(10, 10, 0.5, (0.01, -3.0, 3.5), (0.0, 3.0, -3.1))


def stage(lights=(), world=0.0, alpha=0.3, bounces=2, lamp=False, veil=False, distribution="GGX"):
    """A sphere on a floor, and if wanted a glowing patch.

    One has a mixed material, the other a glossy one.
    """
    ball = icosphere(0.9, 2)
    ball = type(ball)(ball.vertices + np.array([[0.0], [0.0], [1.0]]), ball.triangles, 0)
    parts = [ball, floor(4.0, material=1)]
    mixed = material(
        Diffuse(color(0.3, 0.2, 0.1)), Glossy(distribution, color(0.5, 0.4, 0.4), Constant(float(np.sqrt(alpha))))
    )
    materials = [glossy(alpha, 0.8, 0.6, 0.7, distribution=distribution), mixed]
    if lamp:
        parts.append(quad((-2.0, 1.5, 0.3), (1.0, 0.3, 0.0), (0.0, 0.3, 1.0), 2))
        materials.append(emission(5.0, 7.0, 4.0))
    if veil:
        parts.append(quad((-1.0, -1.5, 1.5), (2.5, 0.0, 0.0), (0.0, 2.5, 0.0), len(materials)))
        materials.append(transparent(0.9, 0.6, 0.8))
    return scene(parts, materials, CAMERA, lights, world, bounces)


def image(the_scene, seed, offset, samples=64, count=10, **options):
    return blocks(replicates(the_scene, count, samples, seed=seed + offset, **options), 5)


@pytest.mark.parametrize("distribution", ["GGX", pytest.param("BECKMANN", marks=pytest.mark.slow)])
def test_strategies_agree(distribution, seed):
    """An area light, a bright sky, glossy and mixed surfaces, two bounces."""
    the_scene = stage([AREA], 0.5, distribution=distribution)
    visible = image(the_scene, seed, 0)
    for offset, strategy in enumerate(("d_cos", "cosine", "uniform"), start=1):
        assert_same(visible, image(the_scene, seed, offset, strategy=strategy), 0.02, level=LEVEL / 3)


LIGHTINGS = {
    "area": {"lights": [AREA]},
    "ellipse_with_spread": {"lights": [ELLIPSE]},
    "sphere": {"lights": [SPHERE]},
    "sky": {"world": SKY},
    "lamp": {"lamp": True},
    "behind_a_veil": {"lights": [AREA], "world": SKY, "lamp": True, "veil": True},
    "all": {"lights": [AREA, ELLIPSE, SPHERE, POINT, SUN], "world": SKY, "lamp": True},
}


# The last has all lights that the others have.
@pytest.mark.parametrize(
    "lighting",
    [
        *(pytest.param(name, marks=pytest.mark.slow) for name in list(LIGHTINGS)[:-1]),
        *list(LIGHTINGS)[-1:],
    ],
)
def test_direct_light_agrees(lighting, seed):
    """Every kind of light by light sampling alone and by BSDF sampling alone.

    Both are compared with the two together.
    """
    the_scene = stage(**LIGHTINGS[lighting])
    both = image(the_scene, seed, 0)
    assert_same(both, image(the_scene, seed, 1, direct="lights"), 0.03, level=LEVEL / 2)
    assert_same(both, image(the_scene, seed, 2, direct="bsdf", count=20), 0.12, level=LEVEL / 2)


def test_samplers_agree(seed):
    the_scene = stage([AREA, SPHERE], 0.3)
    assert_same(image(the_scene, seed, 0), image(the_scene, seed, 1, sampler="random", count=20), 0.02)


def test_a_number_of_samples_that_is_no_power_of_two(seed):
    the_scene = stage([AREA, SPHERE], 0.3)
    assert_same(image(the_scene, seed, 0), image(the_scene, seed, 1, samples=37), 0.02)


@pytest.mark.slow
def test_direct_light_inside_a_box(seed):
    """All light is indirect except for what the lamp shows.

    The strategies agree after many scatterings too.
    """
    box = scene(
        [cube(1.0, material=0), quad((-0.4, -0.4, 0.9), (0.0, 0.8, 0.0), (0.8, 0.0, 0.0), 1)],
        [material(Diffuse(color(0.7, 0.5, 0.3))), emission(3.0)],
        perspective(10, 10, 0.8, (0.03, -0.9, 0.1), (0.1, 1.0, -0.2)),
        bounces=3,
    )
    both = image(box, seed, 0)
    assert_same(both, image(box, seed, 1, direct="lights"), 0.03)
    assert_same(both, image(box, seed, 2, direct="bsdf", count=20), 0.05)


# Every two of roughness, direct light and strategy occur together, where they can: a hemisphere does not find narrow lobes, D cos finds
# them with weights of endless tail, and light sampling alone finds no mirror. Masking changes a lobe's value, not how light is found: the
# other two forms are tried where they change it most.
PAIRED = [
    ("correlated", 0.01, "mis", "visible"),
    ("correlated", 0.01, "bsdf", "visible"),
    ("correlated", 0.1, "lights", "visible"),
    ("correlated", 0.1, "mis", "d_cos"),
    ("correlated", 0.1, "bsdf", "d_cos"),
    ("correlated", 1.0, "lights", "d_cos"),
    *(
        ("correlated", 1.0, direct, strategy)
        for direct in ("mis", "lights", "bsdf")
        for strategy in ("cosine", "uniform")
    ),
    *(
        (masking, 1.0, "mis", strategy)
        for masking in ("separable", "torrance_sparrow")
        for strategy in ("visible", "d_cos")
    ),
]


@cache
def expected(masking, alpha):
    """The stage with all lights, and its image by visible normals and both ways of finding light."""
    the_scene = stage(**LIGHTINGS["all"], alpha=alpha)
    return the_scene, image(the_scene, zlib.crc32(f"{masking} {alpha}".encode()), 0, samples=256, masking=masking)


@pytest.mark.slow
@pytest.mark.parametrize(("masking", "alpha", "direct", "strategy"), PAIRED)
def test_every_pair_of_options(masking, alpha, direct, strategy, seed):
    the_scene, first = expected(masking, alpha)
    # Lights that only scattered rays find need more samples.
    samples, count = (256, 20) if direct == "bsdf" else (128, 10)
    second = image(the_scene, seed, 1, samples, count, masking=masking, direct=direct, strategy=strategy)
    assert_same(first, second, 0.05)
