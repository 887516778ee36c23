# SPDX-License-Identifier: GPL-3.0-or-later
"""Light passes of the reference.

Scenes have passes with closed forms, and the passes' sum is the whole image.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.light_passes import light_passes
from etalon.lib.effects.plan import make_plan
from etalon.lib.film.light_passes import Family, LightPass
from etalon.lib.scene.expressions import Constant
from etalon.lib.scene.lights import SphereLight, SunLight
from etalon.lib.scene.materials import (
    Diffuse,
    Emission,
    Glass,
    Glossy,
    Metallic,
    Refraction,
    Specular,
    Translucent,
    Transparent,
)
from etalon.lib.scene.rays import SEEN
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.effect_cases import CASES
from etalon.tests.indoors import indoors
from etalon.tests.scenes import color, cube, floor, icosphere, material, orthographic, perspective, scene

ABOVE = orthographic(4, 4, 1.0, (0.05, 0.1, 5.0))
SUN = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (2.0, 1.0, 3.0))


def render(the_scene, seed, samples=16, **options):
    """One replicate with all passes."""
    renderer = ReferenceRenderer(the_scene, Options(seed=seed, threads=1, **options), passes=tuple(LightPass))
    return renderer.render(0, samples)


def means(the_scene, seed, **options):
    """The mean of each pass that is not black."""
    passes = render(the_scene, seed, **options).passes
    return {name: image.mean(axis=(0, 1)) for name, image in passes.items() if image.any()}


def assert_means(found, expected, rtol=1e-12):
    """The passes that hold light are the expected ones, with these means."""
    assert set(found) == set(expected)
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], np.broadcast_to(value, 3), rtol=rtol, err_msg=name)


# One effect in ten belongs to the default run.
@pytest.mark.parametrize(
    "effect", [pytest.param(name, marks=pytest.mark.slow if k % 10 else ()) for k, name in enumerate(CASES)]
)
def test_passes_add_up_to_an_image_that_they_do_not_change(effect, seed):
    for the_scene in [s for part in CASES[effect] for s in (*part, *map(indoors, part[:1]))]:
        plan = make_plan(the_scene)
        options = Options(seed=seed, threads=1)
        plain = ReferenceRenderer(the_scene, options, plan).render(0, 8)
        whole = ReferenceRenderer(the_scene, options, plan, passes=tuple(LightPass)).render(0, 8)
        np.testing.assert_array_equal(whole.radiance, plain.radiance)
        assert whole.rays == plain.rays
        scale = np.abs(plain.radiance).max()
        np.testing.assert_allclose(sum(whole.passes.values()), whole.radiance, rtol=1e-12, atol=1e-12 * scale)
        held = {name for name, image in whole.passes.items() if image.any()}
        assert held <= set(light_passes(the_scene, plan))


def test_sunlit_diffuse_plane_has_only_diffuse_direct_light(seed):
    """Radiance is albedo / pi times the irradiance."""
    plane = scene(floor(), material(Diffuse(color(0.8, 0.5, 0.2))), ABOVE, (SUN,), bounces=4)
    expected = np.array([0.8, 0.5, 0.2]) / np.pi * np.array([2.0, 1.0, 3.0])
    assert_means(means(plane, seed), {LightPass.DIFFUSE_DIRECT: expected})


@pytest.mark.parametrize(
    ("closure", "family"), [(Diffuse(color(0.8)), Family.DIFFUSE), (Glossy("GGX", color(0.8)), Family.GLOSSY)]
)
def test_glowing_room_is_a_series_by_passes(closure, family, seed):
    """Albedo a: emission 1, direct a, indirect a^2 + ... + a^(n + 1)."""
    room = scene(
        icosphere(),
        material(closure, Emission(color(1.0))),
        perspective(4, 4, 1.0, (0.1, 0.2, 0.3), (0.3, 0.5, -1.0)),
        bounces=3,
    )
    expected = {
        LightPass.EMISSION: 1.0,
        LightPass(f"{family} direct"): 0.8,
        LightPass(f"{family} indirect"): 0.8**2 + 0.8**3 + 0.8**4,
    }
    assert_means(means(room, seed, direct="bsdf", russian_roulette=False), expected)


def test_mixed_surface_is_parted_by_colour(seed):
    """Under a sky of 1 each lobe gives its own colour to its own pass.

    A mirror gives it to the glossy pass, a diffuse lobe to the diffuse one.
    """
    red, blue = color(0.4, 0.2, 0.0), color(0.0, 0.1, 0.6)
    plane = scene(floor(), material(Diffuse(red), Glossy("GGX", blue)), ABOVE, world=1.0)
    passes = render(plane, seed, samples=4096).passes
    glossy, diffuse = (passes[name].mean(axis=(0, 1)) for name in (LightPass.GLOSSY_DIRECT, LightPass.DIFFUSE_DIRECT))
    np.testing.assert_allclose(diffuse, [0.4, 0.2, 0.0], rtol=0.01)
    np.testing.assert_allclose(glossy, [0.0, 0.1, 0.6], rtol=0.01)
    assert diffuse[2] == 0.0
    assert glossy[0] == 0.0


def test_rough_lobes_are_parted_by_what_each_would_give_alone(seed):
    """Light sampling and lobe sampling meet in one mixture.

    Each pass is the image of its lobes alone.
    """
    lobes = {
        LightPass.DIFFUSE_DIRECT: Diffuse(color(0.5, 0.3, 0.1)),
        LightPass.GLOSSY_DIRECT: Glossy("GGX", color(0.2, 0.3, 0.4), Constant(0.5)),
    }
    lamp = SphereLight("lamp", (0.5, 0.0, 1.5), 0.4, (3.0, 3.0, 3.0))
    camera = replace(ABOVE, width=1, height=1)

    def lit(*closures):
        return scene(floor(), material(*closures), camera, (lamp,), world=0.2)

    several = ReferenceRenderer(lit(*lobes.values()), Options(seed=seed, threads=1), passes=tuple(LightPass))
    found = [several.render(k, 256).passes for k in range(16)]
    for name, closure in lobes.items():
        alone = ReferenceRenderer(lit(closure), Options(seed=seed + 1, threads=1))
        expected = np.array([alone.render(k, 256).radiance[0, 0] for k in range(16)])
        got = np.array([passes[name][0, 0] for passes in found])
        error = np.hypot(got.std(axis=0, ddof=1), expected.std(axis=0, ddof=1)) / 4.0
        np.testing.assert_array_less(np.abs(got.mean(axis=0) - expected.mean(axis=0)), 5.0 * error)


def test_glass_is_glossy_on_the_near_side_and_transmission_on_the_far_one(seed):
    """Seen straight down, an interface of index 1.5 reflects 0.04 of a sky of 1."""
    pane = scene(floor(), material(Glass(color(1.0), Constant(1.5))), ABOVE, world=1.0)
    passes = render(pane, seed, samples=4096).passes
    assert passes[LightPass.GLOSSY_DIRECT].mean() == pytest.approx(0.04, rel=0.02)
    assert passes[LightPass.TRANSMISSION_DIRECT].mean() == pytest.approx(0.96, rel=0.002)


def test_transparent_faces_pass_the_passes_on(seed):
    """Faces behind a filter of 0.5 count as if it were not there.

    These are emission, the sky and the first scattering.
    """
    filter_ = floor(0.6, 1.0, material=1)
    plane = scene(
        [floor(), filter_], [material(Diffuse(color(0.8))), material(Transparent(color(0.5)))], ABOVE, world=1.0
    )
    lamp = scene(
        [floor(), filter_], [material(Emission(color(3.0))), material(Transparent(color(0.5)))], ABOVE, world=1.0
    )
    assert_means(means(lamp, seed), {LightPass.EMISSION: 1.5})
    found = means(plane, seed, direct="bsdf", samples=1)
    assert set(found) == {LightPass.DIFFUSE_DIRECT}
    sky = scene(filter_, [material(), material(Transparent(color(0.5)))], ABOVE, world=1.0)
    assert_means(means(sky, seed), {LightPass.ENVIRONMENT: 0.5})


def test_lamps_that_the_camera_sees_are_emission(seed):
    """A sphere light that fills the view."""
    lamp = SphereLight("lamp", (0.0, 0.0, 2.0), 1.0, (3.0, 2.0, 1.0), rays=SEEN)
    seen = means(scene(floor(), material(), ABOVE, (lamp,)), seed)
    assert set(seen) == {LightPass.EMISSION}


@pytest.mark.parametrize(
    ("closure", "family"),
    [
        (Diffuse(color(0.5)), Family.DIFFUSE),
        (Translucent(color(0.5)), Family.DIFFUSE),
        (Glossy("BECKMANN", color(0.5), Constant(0.4)), Family.GLOSSY),
        (Metallic("GGX", base=color(0.5), roughness=Constant(0.4)), Family.GLOSSY),
        (Specular("GGX", Constant(1.5), color(1.0), Constant(0.4)), Family.GLOSSY),
        (Refraction(color=color(0.5), ior=Constant(1.3), roughness=Constant(0.4)), Family.TRANSMISSION),
    ],
)
def test_each_closure_has_one_family(closure, family, seed):
    """Cycles' count, in which translucent lobes are diffuse."""
    cover = scene(cube(0.3), material(closure), orthographic(1, 1, 0.1, (0.0, 0.0, 5.0)), world=1.0, bounces=2)
    held = {name for name, image in render(cover, seed).passes.items() if image.any()}
    assert held
    assert all(name.startswith(family) for name in held)


def test_a_family_named_wrongly_is_seen(monkeypatch, seed):
    """The error planted: diffuse lobes counted as glossy fail the closed form."""
    monkeypatch.setattr(Diffuse, "families", (Family.GLOSSY,))
    with pytest.raises(AssertionError):
        test_sunlit_diffuse_plane_has_only_diffuse_direct_light(seed)


def test_a_pixel_that_is_not_finite_is_so_in_every_pass(seed):
    """No pass keeps a number where the image has none."""
    glow = material(Emission(color(np.inf, 1.0, 1.0)), Diffuse(color(0.5)))
    rendering = render(scene(floor(), glow, ABOVE, (SUN,)), seed, direct="bsdf")
    assert (rendering.nonfinite > 0).all()
    assert all(np.isnan(image).all() for image in rendering.passes.values())
