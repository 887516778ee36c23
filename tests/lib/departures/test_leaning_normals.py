# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from below faces whose normals lean: what the departure lets through, by closed forms."""

import numpy as np
import pytest
from etalon.lib.scene.converters import VectorMath
from etalon.lib.scene.expressions import (
    BLACK,
    ONE,
    WHITE,
    ZERO,
    Bump,
    Constant,
    Coordinates,
    Math,
    SurfaceNormal,
    VectorToValue,
)
from etalon.lib.scene.lights import SunLight
from etalon.lib.scene.materials import Diffuse
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests import scenes
from etalon.tests.replicates import assert_mean, replicates

BELOW = frozenset(["light below the face"])


def slanted(slope, normal=None):
    """The bump of a height that grows by `slope` along x."""
    x = VectorToValue(VectorMath("MULTIPLY", Coordinates("POSITION"), Constant((3.0, 0.0, 0.0)), BLACK, ONE))
    return Bump(Math("MULTIPLY", x, Constant(slope), ZERO), ONE, ONE, normal)


def leaning_floor(way, angle):
    """A floor whose normals lean by `angle`, and its white material.

    The `way` is "smooth" shading, a "displacement" that only bumps, or a "bump" of the closure alone.
    """
    floor, bump = scenes.floor(), slanted(-np.tan(angle))
    if way == "smooth":
        normals = np.repeat([[np.sin(angle)], [0.0], [np.cos(angle)]], 4, axis=1)
        return scenes.Part(floor.vertices, floor.triangles, 0, normals), scenes.diffuse(1.0)
    return floor, scenes.material(Diffuse(WHITE, normal=SurfaceNormal(bump) if way == "displacement" else bump))


@pytest.mark.parametrize("way", ["smooth", "displacement", "bump"])
@pytest.mark.parametrize("height", [0.3, -0.3])
def test_a_sun_below_the_face_shows_only_with_the_departure(way, height):
    """Normals that lean by 0.5 under a sun `height` radians above the face show N.L = sin(0.5 + height).

    Of what is below the face nothing, except with the departure. A Bump node is held against the surface's normal, so
    that it shows nothing in any case.
    """
    floor, material = leaning_floor(way, 0.5)
    sun = SunLight("sun", (np.cos(height), 0.0, np.sin(height)), 0.0, (np.pi,) * 3)
    scene = scenes.scene(floor, material, scenes.orthographic(1, 1, 1.0, (0.0, 0.0, 5.0)), (sun,))
    full = np.sin(0.5 + height)
    for departures, counts in ((frozenset(), height > 0.0), (BELOW, height > 0.0 or way != "bump")):
        found = ReferenceRenderer(scene, Options(threads=1, departures=departures)).render(0, 16).radiance
        assert found == pytest.approx(np.full((1, 1, 3), full if counts else 0.0), rel=1e-6)


@pytest.mark.parametrize(("angle", "shown"), [(0.9, np.sin(0.6)), (0.2, 0.0)])
def test_a_bump_on_a_displaced_surface_is_held_against_its_normal(angle, shown):
    """With the departure light counts where the displacement's normal and the bump's see it on the same side.

    The sun is 0.3 below the face and the displacement's normal leans by 0.5, so that it sees the sun. The slope of a bump that
    turns it on to `angle` is cos 0.5 tan(angle - 0.5).
    """
    bump = slanted(-np.cos(0.5) * np.tan(angle - 0.5), SurfaceNormal(slanted(-np.tan(0.5))))
    material = scenes.material(Diffuse(WHITE, normal=bump))
    sun = SunLight("sun", (np.cos(0.3), 0.0, -np.sin(0.3)), 0.0, (np.pi,) * 3)
    scene = scenes.scene(scenes.floor(), material, scenes.orthographic(1, 1, 1.0, (0.0, 0.0, 5.0)), (sun,))
    for departures, expected in ((frozenset(), 0.0), (BELOW, shown)):
        found = ReferenceRenderer(scene, Options(threads=1, departures=departures)).render(0, 16).radiance
        assert found == pytest.approx(np.full((1, 1, 3), expected), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("way", ["smooth", "displacement"])
def test_how_light_is_sampled_does_not_matter_without_the_departure(way, seed):
    """A floor whose normals lean by 0.5 in a uniform world: all ways give (1 + cos 0.5) / 2.

    Both strategies sample the world. With light from below the face each way gives an answer of its own, light
    sampling the whole half-space of the normal.
    """
    lean = 0.5
    floor, material = leaning_floor(way, lean)
    # White in every direction to twelve digits, but no constant.
    direction = VectorToValue(Coordinates("GENERATED"))
    one = Math("ADD", Math("MULTIPLY", direction, Constant(1e-12), Constant(0.0)), Constant(1.0), Constant(0.0))
    scene = scenes.scene(floor, material, scenes.orthographic(2, 2, 1.0, (0.0, 0.0, 5.0)), world=World(one))
    book = 0.5 * (1.0 + np.cos(lean))
    for direct, departed in (("mis", None), ("bsdf", book), ("lights", 1.0)):
        assert_mean(replicates(scene, 8, 256, direct=direct, seed=seed), book, precision=5e-3)
        shown = replicates(scene, 8, 256, direct=direct, seed=seed, departures=BELOW)
        if departed is None:
            assert (shown.mean(axis=0) > book + 0.01).all()
            assert (shown.mean(axis=0) < 0.99).all()
        else:
            assert_mean(shown, departed, precision=5e-3)
