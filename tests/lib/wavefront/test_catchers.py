# SPDX-License-Identifier: GPL-3.0-or-later
"""Shadow catchers against closed forms, and against the same scene without them.

The camera does not see them, all other rays do.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.comparison.catchers import find_catcher_pixels, leave_out
from etalon.lib.effects.light_passes import light_passes
from etalon.lib.effects.plan import make_plan
from etalon.lib.errors import Refused
from etalon.lib.film.light_passes import LightPass
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.scene.lights import PointLight
from etalon.lib.scene.materials import Material
from etalon.lib.scene.volumes import Volume
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.coverage import caught_pixels, coverage
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import (
    cube,
    diffuse,
    emission,
    floor,
    glass,
    glossy,
    icosphere,
    orthographic,
    perspective,
    quad,
    scene,
    transparent,
)

LIGHT = np.array([3.0, 2.0, 0.5])
SIDE = (2.0, 0.0, 0.0), (0.0, 2.0, 0.0)


def catching(the_scene, *numbers):
    """The scene in which the objects with these numbers are shadow catchers."""
    objects = tuple(replace(one, catches_shadows=k in numbers) for k, one in enumerate(the_scene.mesh.objects))
    return replace(the_scene, mesh=replace(the_scene.mesh, objects=objects))


def shown(the_scene, seed, samples=64, **options):
    return ReferenceRenderer(the_scene, Options(seed=seed, threads=1, **options)).render(0, samples).radiance


def split_floor():
    """A floor that shines, its right half a catcher; three pixels see the left, both halves, and the right."""
    parts = quad((-2.0, -1.0, 0.0), *SIDE), quad((0.0, -1.0, 0.0), *SIDE)
    return catching(scene(parts, emission(*LIGHT), orthographic(3, 1, 3.0, (0.0, 0.0, 1.0))), 1)


def test_a_pixel_has_the_light_of_the_part_that_is_no_catcher(seed):
    left, middle, right = shown(split_floor(), seed)[0]
    assert left == pytest.approx(LIGHT)
    assert middle == pytest.approx(0.5 * LIGHT)
    assert not right.any()


def test_the_light_of_a_catcher_falls_on_other_objects(seed):
    """A patch faces the middle of a square that shines: closed form of the view factor."""
    patch = quad((-0.1, -0.1, 1.0), (0.0, 0.2, 0.0), (0.2, 0.0, 0.0), 1)
    camera = orthographic(1, 1, 1e-3, (0.0, 0.0, 0.5), (0.0, 0.0, 1.0))
    lit = catching(scene((floor(0.8), patch), [emission(*LIGHT), diffuse(0.6)], camera), 0)
    half = 0.8 / np.hypot(0.8, 1.0)
    factor = 4.0 / np.pi * half * np.arctan(half)
    assert_mean(replicates(lit, 8, 256, seed=seed), 0.6 * factor * LIGHT, 0.005)


@pytest.mark.parametrize("between", [glossy(0.0), glass(1.0)])
def test_a_catcher_in_a_mirror_or_behind_glass_is_an_ordinary_object(between, seed):
    """The mirror looks up and the glass lets the ray pass: either way it ends at a square that shines."""
    parts = [quad((-1.0, -1.0, 0.0), *SIDE, 1), floor(4.0, 3.0 if between == glossy(0.0) else -3.0)]
    camera = orthographic(1, 1, 1e-3, (0.1, 0.2, 1.0))
    seen = catching(scene(parts, [emission(*LIGHT), between], camera, bounces=3), 1)
    assert shown(seen, seed) == pytest.approx(np.broadcast_to(LIGHT, (1, 1, 3)), rel=1e-6)


def test_rays_that_only_pass_through_faces_end_at_a_catcher(seed):
    """The catcher may be behind a veil, or be one itself, before a wall that shines."""
    camera = orthographic(1, 1, 1e-3, (0.1, 0.2, 1.0))
    veiled = scene((floor(1.0, 0.5, 1), floor(1.0)), [emission(*LIGHT), transparent(0.5)], camera, bounces=2)
    assert shown(veiled, seed) == pytest.approx(np.broadcast_to(0.5 * LIGHT, (1, 1, 3)))
    assert not shown(catching(veiled, 1), seed).any()
    assert not shown(catching(veiled, 0), seed).any()


def test_what_a_volume_emits_before_a_catcher_is_seen(seed):
    """Two metres of a medium that adds the same radiance in each metre, as no light is absorbed."""
    glow = Material("glow", (), volume=Volume(emission=tuple(LIGHT)), only_bounds=True)
    camera = orthographic(1, 1, 1e-3, (0.1, 0.2, 9.0))
    seen = catching(scene((cube(1.0, (0.0, 0.0, 2.0), 1), floor(5.0)), [emission(*LIGHT), glow], camera), 1)
    assert shown(seen, seed) == pytest.approx(np.broadcast_to(2.0 * LIGHT, (1, 1, 3)), rel=1e-5)
    assert not caught_pixels(ReferenceRenderer(seen).kernel).any()


def over_floor():
    """A ball over a floor, under a lamp and a sky."""
    ball = icosphere(0.7, 2)
    ball = replace(ball, vertices=ball.vertices + np.array([[0.0], [0.0], [1.0]]))
    lamp = PointLight("lamp", (2.0, -1.0, 3.0), (20.0, 20.0, 20.0))
    camera = perspective(24, 16, 0.4, (0.0, -6.0, 3.0), (0.0, 6.0, -2.2))
    return scene((ball, floor(4.0, material=1)), [diffuse(0.7), diffuse(0.5)], camera, [lamp], (0.2, 0.3, 0.4), 3)


def test_pixels_of_other_objects_are_those_of_the_scene_without_catchers(seed):
    plain = over_floor()
    caught = catching(plain, 1)
    whole, matte = shown(plain, seed), shown(caught, seed)
    seen = dict(coverage(ReferenceRenderer(plain).kernel, 64, 0.0)["object"])
    ball, ground = (seen[f"object {k}"].toarray() for k in range(2))
    assert 20 < (ball == 1.0).sum() < 100 < (ground == 1.0).sum()
    np.testing.assert_allclose(matte[ball == 1.0], whole[ball == 1.0], rtol=1e-12)
    assert not matte[ground == 1.0].any()
    mixed = (ball > 0.0) & (ball < 1.0) & (ground > 0.0)
    assert (matte[mixed] < whole[mixed]).all()


def test_catchers_belong_to_no_region_and_their_pixels_are_found():
    kernel = ReferenceRenderer(split_floor()).kernel
    assert [name for name, _ in coverage(kernel, least=0.0)["object"]] == ["object 0"]
    found = find_catcher_pixels(kernel)
    assert (found.names, found.count, found.pixels.tolist()) == (("object 1",), 1, [[False, False, True]])
    assert leave_out(np.array([[True, False, False]]), found).tolist() == [[True, False, True]]
    moved = replace(split_floor(), camera=orthographic(3, 1, 3.0, (0.1, 0.0, 1.0)))
    assert find_catcher_pixels(ReferenceRenderer(moved).kernel).pixels.tolist() == [[False, True, True]]
    without = ReferenceRenderer(catching(split_floor())).kernel
    assert find_catcher_pixels(without) is None
    assert not caught_pixels(without).any()


def test_an_image_of_catchers_alone_is_refused():
    with pytest.raises(Refused) as caught:
        find_catcher_pixels(ReferenceRenderer(catching(split_floor(), 0, 1)).kernel)
    assert {one.owner for one in caught.value.refusals} == {"object 'object 0'", "object 'object 1'"}


@pytest.mark.parametrize(
    ("skin", "left"),
    [
        (diffuse(0.5), {LightPass.DIFFUSE_DIRECT, LightPass.EMISSION}),
        (emission(1.0), {LightPass.DIFFUSE_DIRECT}),
        (transparent(0.5), {LightPass.DIFFUSE_DIRECT}),
    ],
)
def test_passes_in_which_cycles_shows_catchers_are_not_compared(skin, left):
    parts = floor(material=0), floor(1.0, 1.0, 1), floor(1.0, 2.0, 2)
    made = catching(scene(parts, [skin, emission(2.0), diffuse(0.5)], over_floor().camera, world=1.0), 0)
    plan = make_plan(made)
    assert {name for name in light_passes(made, plan) if "indirect" not in name} == left


def test_light_tracing_refuses_them():
    with pytest.raises(Refused, match="shadow catchers by light tracing"):
        LightTracingRenderer(catching(over_floor(), 1), Options())
