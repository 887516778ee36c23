# SPDX-License-Identifier: GPL-3.0-or-later
"""Replicates by light tracing.

Also the scenes that light tracing and path tracing must agree on.
"""

from dataclasses import replace

import numpy as np
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.scene.camera import Aperture
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.lights import AreaLight, Cone, PointLight, SphereLight, SpotLight, SunLight
from etalon.lib.scene.materials import Diffuse, Glass, Glossy, Metallic, Specular, Translucent
from etalon.tests.replicates import assert_same, blocks, replicates
from etalon.tests.scenes import (
    color,
    diffuse,
    floor,
    glass,
    glossy,
    icosphere,
    material,
    orthographic,
    perspective,
    scene,
)


def light_traced(the_scene, count, samples, **options):
    """Images (count, height, width, 3) by light tracing.

    One thread and no roulette unless told otherwise.
    """
    return replicates(the_scene, count, samples, LightTracingRenderer, **options)


def assert_agree(the_scene, seed, samples=256, precision=0.05, size=5, **options):
    """Path tracing and light tracing have the same mean in every block.

    The level is that of tests/replicates.py. Of path tracing, whose noise is a quarter of light tracing's, few samples
    are enough.
    """
    traced = replicates(the_scene, 10, 32, seed=seed, **options)
    lit = light_traced(the_scene, 10, samples, seed=seed + 1, **options)
    assert_same(blocks(traced, size), blocks(lit, size), precision)


AREA = AreaLight(
    "area", (1.5, -0.5, 3.5), (3.0, 0.0, 0.0), (0.0, -3.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", (6.0, 5.0, 4.0), np.pi
)
SKEWED = AreaLight(
    "skewed", (-1.5, 0.5, 2.5), (1.5, 0.0, 0.0), (0.5, -1.0, 0.0), (0.0, 0.0, -1.0), "ELLIPSE", (4.0, 8.0, 4.0), 0.8
)
DOWN = (0.0, 0.0, -1.0)
LIGHTS = {
    "rectangle": AREA,
    "rectangle_with_spread": replace(AREA, spread=0.7),
    "skewed_ellipse_with_spread": SKEWED,
    "beam": replace(AREA, spread=0.0),
    "point": PointLight("point", (0.0, -1.5, 3.5), (30.0, 20.0, 10.0)),
    "sphere": SphereLight("sphere", (-1.2, -1.2, 1.5), 0.4, (5.0, 5.0, 9.0)),
    "spot_with_radius": SpotLight(
        "spot",
        (0.3, -0.5, 3.5),
        0.3,
        (30.0, 20.0, 10.0),
        Cone(DOWN, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), np.cos(0.8), 0.5),
    ),
    "stretched_spot": SpotLight(
        "spot",
        (0.3, -0.5, 3.5),
        0.0,
        (30.0, 20.0, 10.0),
        Cone(DOWN, (2.0, 0.0, 0.0), (0.0, 1.0, 0.0), np.cos(0.8), 0.5),
    ),
    "sun": SunLight("sun", (0.6, 0.0, 0.8), 0.1, (1.0, 1.0, 1.0)),
    "sun_without_size": SunLight("sun", (0.0, -0.6, 0.8), 0.0, (1.0, 0.5, 0.5)),
}
MATERIALS = {
    "diffuse": diffuse(0.8, 0.7, 0.6),
    "oren_nayar": diffuse(0.8, 0.7, 0.6, roughness=0.7),
    "glossy": glossy(0.3, 0.8, 0.7, 0.6),
    "rough_glass": material(Glass(color(1.0, 0.9, 0.8), Constant(1.5), Constant(0.5))),
    "smooth_glass": glass(1.5, 0.9),
    "mirror": material(Metallic("GGX", "F82", color(0.9, 0.7, 0.5), color(0.5))),
    "diffuse_and_mirror": material(Diffuse(color(0.3)), Glossy("GGX", color(0.4))),
    "translucent": material(Translucent(color(0.7, 0.5, 0.3))),
    "layers": material(Diffuse(color(0.5)), Specular("MULTI_GGX", Constant(1.5), color(1.0), Constant(0.5))),
}
CAMERA = perspective(10, 10, 0.5, (0.01, -3.0, 3.5), (0.0, 3.0, -3.1))
LENS = Aperture(0.3, 5, 0.2, 1.3, 3.0)
CAMERAS = {
    "perspective": CAMERA,
    "perspective_with_lens": replace(CAMERA, aperture=LENS),
    "orthographic": orthographic(10, 10, 3.0, (0.01, -3.0, 3.5), (0.0, 3.0, -3.1)),
    "orthographic_with_lens": orthographic(10, 10, 3.0, (0.01, -3.0, 3.5), (0.0, 3.0, -3.1), LENS),
    "between_clip_planes": replace(CAMERA, clip_start=2.9, clip_end=4.5),
}


def ball_on_floor(coat, lights=(AREA,), world=0.0, bounces=3, camera=CAMERA, subdivisions=2, others=()):
    """A sphere, shaded smooth and of few faces, so that normals differ, on a grey floor.

    `others`: parts and their materials.
    """
    ball = icosphere(0.9, subdivisions, 0, True)
    ball = replace(ball, vertices=ball.vertices + np.array([[0.0], [0.0], [1.0]]))
    parts = [ball, floor(4.0, material=1), *(part for part, _ in others)]
    coats = [coat, diffuse(0.6, 0.5, 0.4), *(other for _, other in others)]
    return scene(parts, coats, camera, lights, world, bounces)
