# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient occlusion against closed forms: form factors, distances, insides, and the object itself."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.stats as stats
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.sampling.cycles_pattern import cycles_pairs
from etalon.lib.scene.converters import Combine
from etalon.lib.scene.expressions import (
    ONE,
    WHITE,
    ZERO,
    AmbientOcclusion,
    ColorRamp,
    ColorToValue,
    Constant,
    Coordinates,
    Math,
    Mix,
    ValueToColor,
)
from etalon.lib.scene.lights import PointLight, SunLight
from etalon.lib.scene.materials import Diffuse, Emission, Glossy, Subsurface, Transparent, WeightedClosure
from etalon.lib.scene.occlusion import find_misuse, takes_one_ray, with_few_rays
from etalon.lib.scene.rays import EVERY, SHADOW
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import color, diffuse, floor, icosphere, material, orthographic, perspective, quad, scene

FAR = Constant(1e6)
ABOVE = orthographic(1, 1, 1e-3, (0.0, 0.0, 0.5))
AWAY = SunLight("sun", (0.0, -0.6, 0.8), 0.0, (np.pi,) * 3)
"""A wall in the half-space y > 0 does not shade the origin from it. A white floor has a radiance of 0.8."""


def occluded(**more):
    return material(Diffuse(ValueToColor(AmbientOcclusion(**{"distance": FAR, **more}))))


def shown(parts, wall, seed, lights=(AWAY,), camera=ABOVE, change=lambda made: made):
    made = scene(parts, [wall, diffuse(0.5)], camera, lights)
    return replicates(change(made), 16, 512, seed=seed)


def wall(distance, height, half):
    return quad((-half, distance, 0.0), (2.0 * half, 0.0, 0.0), (0.0, 0.0, height), 1)


def wall_factor(d, h, w):
    """The form factor of a rectangle from a point of the plane across it (Howell's catalogue, B-4), twice a corner."""
    slant = np.hypot(d, h)
    return (np.arctan(w / d) - d / slant * np.arctan(w / slant)) / np.pi


@pytest.mark.parametrize(("d", "h", "w"), [(0.5, 1.0, 0.7), (0.1, 2.0, 3.0)])
def test_a_wall_takes_its_form_factor(d, h, w, seed):
    images = shown([floor(), wall(d, h, w)], occluded(), seed)
    assert_mean(images, 0.8 * (1.0 - wall_factor(d, h, w)), 0.02)


def below_ceiling(wall, seed):
    lamp = PointLight("lamp", (0.3, 0.2, 0.4), (1.0, 1.0, 1.0))
    return shown([floor(), quad((-50.0, -50.0, 0.6), (100.0, 0.0, 0.0), (0.0, 100.0, 0.0), 1)], wall, seed, [lamp])


@pytest.mark.parametrize("reach", [0.61, 0.9, 3.0])
def test_a_ceiling_counts_where_it_is_near_enough(reach, seed):
    """Directions whose cosine is above height / distance meet it: 1 - (h / d)^2 of the hemisphere."""
    white = below_ceiling(diffuse(1.0), seed).mean()
    assert_mean(below_ceiling(occluded(distance=Constant(reach)), seed) / white, (0.6 / reach) ** 2, 0.03, 1e-6)


@pytest.mark.parametrize("reach", [0.0, -1.0, 0.59])
def test_nothing_within_the_distance_leaves_the_colour(reach, seed):
    white = below_ceiling(diffuse(1.0), seed)
    np.testing.assert_array_equal(below_ceiling(occluded(distance=Constant(reach)), seed), white)


@pytest.mark.grid(3)
@pytest.mark.parametrize(
    ("from_inside", "more", "share"),
    [
        (False, {}, 1.0),
        (False, {"inside": True}, 0.0),
        (False, {"inside": True, "only_local": True}, 0.0),
        (True, {}, 0.0),
        (True, {"inside": True}, 1.0),
        (True, {"distance": Constant(1e-3)}, 1.0),
    ],
)
def test_a_ball_occludes_its_inside_only(from_inside, more, share, seed):
    height = 0.0 if from_inside else 3.0
    camera = perspective(1, 1, 1e-3, (0.02, 0.03, height))
    light = PointLight("lamp", (0.1, 0.05, height), (10.0, 10.0, 10.0))
    white = shown([icosphere()], diffuse(1.0), seed, [light], camera)
    assert white.min() > 0.0
    images = shown([icosphere()], occluded(**more), seed, [light], camera)
    np.testing.assert_array_equal(images, share * white)


def one_object(made):
    mesh = made.mesh
    return replace(made, mesh=replace(mesh, objects=mesh.objects[:1], object_index=np.zeros_like(mesh.object_index)))


def unshadowing(made):
    things = made.mesh.objects
    return replace(made, mesh=replace(made.mesh, objects=(things[0], replace(things[1], rays=EVERY & ~SHADOW))))


@pytest.mark.grid(3)
@pytest.mark.parametrize(
    ("change", "more", "counts"),
    [
        (lambda made: made, {"only_local": True}, False),
        (one_object, {"only_local": True}, True),
        (unshadowing, {}, False),
        (unshadowing, {"only_local": True}, False),
    ],
    ids=["another object", "the same object", "an object without shadows", "another one without shadows"],
)
def test_only_faces_that_count_occlude(change, more, counts, seed):
    images = shown([floor(), wall(0.5, 1.0, 0.7)], occluded(**more), seed, change=change)
    assert_mean(images, 0.8 * (1.0 - counts * wall_factor(0.5, 1.0, 0.7)), 0.02)


def test_a_turned_normal_turns_the_hemisphere(seed):
    """About the horizontal, half of the rays start below the floor. Nothing is there, or half of a wide wall."""
    normal = Constant((0.0, 0.5, 0.0))  # it need not be of unit length
    np.testing.assert_allclose(shown([floor()], occluded(normal=normal), seed), 0.8, rtol=1e-6)
    images = shown([floor(), wall(0.1, 100.0, 100.0)], occluded(normal=normal), seed)
    assert_mean(images, 0.4, 0.02, level=1e-5)


SHARE = AmbientOcclusion(Constant(0.9))
RED, BLUE = color(0.9, 0.1, 0.2), color(0.05, 0.3, 0.8)
HALF = Constant(0.5)


@pytest.mark.grid(3)
@pytest.mark.parametrize(
    ("closures", "mean"),
    [
        ([(Diffuse(Mix(SHARE, RED, BLUE)), ONE)], lambda a, r, b: (1.0 - a) * r + a * b),
        (
            [(Diffuse(RED), Math("SUBTRACT", ONE, SHARE, ZERO)), (Diffuse(BLUE), Math("ADD", SHARE, ZERO, ZERO, True))],
            lambda a, r, b: (1.0 - a) * r + a * b,
        ),
        (
            [(Diffuse(ColorRamp(SHARE, (0.0, 1.0), ((0.9, 0.1, 0.2, 1.0), (0.05, 0.3, 0.8, 1.0)))), ONE)],
            lambda a, r, b: (1.0 - a) * r + a * b,
        ),
        ([(Diffuse(Mix(HALF, RED, ValueToColor(SHARE), "MULTIPLY")), ONE)], lambda a, r, b: r * (0.5 + 0.5 * a)),
        ([(Diffuse(Combine(SHARE, ONE, HALF)), HALF)], lambda a, r, b: np.array([0.5 * a, 0.5, 0.25])),
    ],
    ids=["mixed colours", "mixed shaders", "a straight ramp", "half multiplied", "a channel"],
)
def test_what_is_linear_has_the_mean_of_its_mean(closures, mean, seed):
    made = replace(material(), lobes=tuple(WeightedClosure(*one) for one in closures))
    white = below_ceiling(diffuse(1.0), seed).mean()
    expected = mean((0.6 / 0.9) ** 2, np.array(RED.value), np.array(BLUE.value))
    assert_mean(below_ceiling(made, seed) / white, expected, 0.03, 1e-6)


def counts(hidden, samples):
    """The chance of each number of hidden rays, (samples + 1,); `hidden` says of points of (0, 1)^2 whether their ray is.

    The points are those of Cycles' sequence, which begin at multiples of the largest power of two in `samples`.
    """
    apart = samples & -samples
    begin = np.arange(200000, dtype=np.uint32) * np.uint32(2**32 // 200000 // apart * apart)
    pairs = cycles_pairs(begin + np.arange(samples, dtype=np.uint32)[:, None], 16 + 4)
    return np.bincount(hidden(*pairs).sum(axis=0), minlength=samples + 1) / begin.size


def independent(share, samples):
    return stats.binom(samples, share).pmf(np.arange(samples + 1))


def by_rays(form, samples, seed, build):
    """Images of a white floor times `form` of the open share, over those of a white one, by so many rays."""
    made = form(AmbientOcclusion(Constant(0.9) if build is below_ceiling else FAR, samples=samples))
    return build(material(Diffuse(ValueToColor(made))), seed) / build(diffuse(1.0), seed).mean()


def beside_long_wall(wall, seed):
    return shown([floor(), quad((-5e3, 1e-3, 0.0), (1e4, 0.0, 0.0), (0.0, 0.0, 1e4), 1)], wall, seed)


def squared(share):
    return Math("MULTIPLY", share, share, ZERO)


def doubled(share):
    return Math("MULTIPLY", share, Constant(2.0), ZERO, True)


@pytest.mark.grid(4)
@pytest.mark.parametrize("samples", [1, 2, 3, 16])
@pytest.mark.parametrize(("form", "curve"), [(squared, np.square), (doubled, lambda x: np.minimum(2.0 * x, 1.0))])
def test_a_curve_has_the_mean_over_so_many_rays(samples, form, curve, seed):
    """Below a ceiling, rays are hidden whose points of the square are near its centre."""
    reach = 1.0 - (0.6 / 0.9) ** 2

    def hidden(u, v):
        return np.maximum(np.abs(2.0 * u - 1.0), np.abs(2.0 * v - 1.0)) ** 2 < reach

    chances = independent(reach, 1) if samples == 1 else counts(hidden, samples)
    exact = chances @ curve(1.0 - np.arange(samples + 1) / samples)
    assert_mean(by_rays(form, samples, seed, below_ceiling), exact, 0.02, 1e-6)


@pytest.mark.grid(3)
@pytest.mark.parametrize("samples", [2, 3, 4])
def test_few_rays_lie_about_the_axes_of_cycles(samples, seed):
    """A long wall at the point hides half of the hemisphere, what is beyond the diagonal of the square."""
    chances = counts(lambda u, v: v > u, samples)
    exact = chances @ np.square(1.0 - np.arange(samples + 1) / samples)
    assert abs(exact - independent(0.5, samples) @ np.square(1.0 - np.arange(samples + 1) / samples)) > 0.01
    assert_mean(by_rays(squared, samples, seed, beside_long_wall), exact, 0.02, 1e-3)


@pytest.mark.parametrize(
    ("closure", "weight", "one"),
    [
        (Diffuse(ValueToColor(SHARE)), SHARE, False),
        (Diffuse(ValueToColor(Math("POWER", SHARE, HALF, ZERO))), ONE, False),
        (Diffuse(ValueToColor(Math("MULTIPLY", SHARE, Constant(2.0), ZERO, True))), ONE, False),
        (Diffuse(ValueToColor(Math("SUBTRACT", SHARE, HALF, ZERO))), ONE, False),
        (Diffuse(ColorRamp(SHARE, (0.2, 1.0), ((0.0,) * 4, (1.0,) * 4))), ONE, False),
        (Diffuse(WHITE, SHARE), ONE, False),
        (Diffuse(ValueToColor(SHARE), HALF), ONE, False),
        (Glossy("MULTI_GGX", ValueToColor(SHARE), HALF), ONE, False),
        (Diffuse(ValueToColor(AmbientOcclusion(SHARE))), ONE, False),
        (Diffuse(ValueToColor(SHARE)), ONE, True),
        (Diffuse(ValueToColor(SHARE)), ZERO, True),
        (Diffuse(WHITE, HALF), SHARE, True),
        (Glossy("GGX", ValueToColor(SHARE), HALF), ONE, True),
        (Diffuse(Mix(ONE, ValueToColor(SHARE), Coordinates("OBJECT"), "MULTIPLY")), ONE, True),
        (Diffuse(ValueToColor(ColorToValue(Mix(ONE, ValueToColor(SHARE), RED, "MULTIPLY")))), ONE, True),
    ],
)
def test_one_ray_serves_what_is_linear(closure, weight, one):
    lobe = WeightedClosure(closure, weight)
    assert takes_one_ray(lobe) == one
    assert find_misuse(lobe) is None
    made = scene(floor(), replace(material(), lobes=(lobe,)), ABOVE, [AWAY])
    ReferenceRenderer(made, Options(threads=1)).render(0, 2)


def test_rays_are_spared_where_every_lobe_of_the_material_is_linear():
    share = AmbientOcclusion(FAR, samples=16)
    linear, other = WeightedClosure(Diffuse(ValueToColor(share))), WeightedClosure(Diffuse(WHITE, share))
    made = scene(floor(), replace(material(), lobes=(linear,)), ABOVE, [AWAY])
    made = replace(made, materials=(made.materials[0], replace(made.materials[0], lobes=(linear, other))))
    spared, whole = with_few_rays(made).materials
    assert spared.lobes == (WeightedClosure(Diffuse(ValueToColor(replace(share, samples=1)))),)
    assert whole is made.materials[1]


@pytest.mark.parametrize(
    ("closure", "weight", "where"),
    [
        (Emission(ValueToColor(SHARE)), ONE, "its emission"),
        (Transparent(), SHARE, "what lets light straight through"),
        (Subsurface(ValueToColor(SHARE)), ONE, "its subsurface scattering"),
    ],
)
def test_what_cycles_evaluates_without_rays_is_refused(closure, weight, where):
    lobe = WeightedClosure(closure, weight)
    assert find_misuse(lobe) == where
    made = scene(floor(), replace(material(), lobes=(lobe,)), ABOVE, [AWAY])
    with pytest.raises(Refused, match=f"ambient occlusion in {where} is not simulated"):
        ReferenceRenderer(made, Options(threads=1))


def test_light_tracing_refuses_it():
    with pytest.raises(EtalonError, match="ambient occlusion by light tracing"):
        LightTracingRenderer(scene(floor(), occluded(), ABOVE, [AWAY]), Options(threads=1))


def test_a_chain_of_nodes_may_be_long():
    share = AmbientOcclusion(distance=FAR)
    for _ in range(5000):
        share = Math("MULTIPLY", share, Constant(1.0), ZERO)
    assert takes_one_ray(WeightedClosure(Diffuse(color(1.0, 1.0, 1.0)), share))
    assert not takes_one_ray(WeightedClosure(Diffuse(color(1.0, 1.0, 1.0)), Math("MULTIPLY", share, share, ZERO)))
