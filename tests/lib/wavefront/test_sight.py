# SPDX-License-Identifier: GPL-3.0-or-later
"""Masks of rays against closed forms.

What is hidden from a kind of ray is as if it were not there, and parts add up to the whole.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.bsdfs.classed import ClassedMixture
from etalon.lib.bsdfs.lambert import Lambert, LambertTransmission
from etalon.lib.bsdfs.mixture import Mixture
from etalon.lib.errors import EtalonError, SceneError
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.scene.checks import validate
from etalon.lib.scene.expressions import ONE, ZERO, Constant, Math, RayFlag, ValueToColor
from etalon.lib.scene.lights import AreaLight, PointLight
from etalon.lib.scene.materials import (
    Diffuse,
    Emission,
    Glass,
    Glossy,
    Material,
    Translucent,
    Transparent,
    WeightedClosure,
)
from etalon.lib.scene.rays import CAMERA, DIFFUSE, EVERY, GLOSSY, SCATTERED, SEEN, SHADOW, TRANSMISSION
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.tests.lib.wavefront.test_direct_light import ALBEDO, DIRECT, PRECISION, from_polygon, over_pixels
from etalon.tests.lib.wavefront.test_direct_light import lit as under
from etalon.tests.replicates import assert_mean, assert_same, replicates
from etalon.tests.scenes import color, diffuse, emission, floor, glass, material, orthographic, quad, scene

HALF = Constant(0.5)
POINT = PointLight("point", (0.3, -0.2, 1.5), (2.0, 3.0, 4.0))
EDGES = (1.2, 0.0, 0.0), (0.0, -0.8, 0.0)
AREA = AreaLight("area", (0.3, 0.2, 1.5), *EDGES, (0.0, 0.0, -1.0), "RECTANGLE", (3.0,) * 3, np.pi)
CORNERS = [
    np.array([0.3, 0.2, 1.5]) + 0.5 * (a * np.array(EDGES[0]) + b * np.array(EDGES[1]))
    for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
]
SCREEN = quad((-2.0, -2.0, 1.2), (4.0, 0.0, 0.0), (0.0, 4.0, 0.0), 1)


def masked(the_scene, *rays):
    """The scene with masks of rays for its objects."""
    objects = tuple(replace(one, rays=mask) for one, mask in zip(the_scene.mesh.objects, rays, strict=True))
    return replace(the_scene, mesh=replace(the_scene.mesh, objects=objects))


def from_point(x, y):
    """Irradiance by POINT at intensity 1: cos / distance^2."""
    px, py, h = POINT.position
    return h / ((x - px) ** 2 + (y - py) ** 2 + h**2) ** 1.5


def test_a_screen_without_shadow_hides_no_lamp(seed):
    """The lamp above the screen lights the floor as if the screen were not there.

    With its shadow, not at all.
    """
    screened = under([POINT], [SCREEN], [diffuse(0.5)])
    exact = over_pixels(from_point) * POINT.intensity
    shadowless = masked(screened, EVERY, EVERY & ~(SHADOW | CAMERA))
    assert_mean(replicates(shadowless, 4, 64, seed=seed), exact, 0.01, rounding=1e-3)
    assert not replicates(masked(screened, EVERY, EVERY & ~CAMERA), 2, 16, seed=seed).any()


@DIRECT
@pytest.mark.parametrize("rays", [SCATTERED, DIFFUSE])
def test_broad_lamps_shine_through_a_screen_without_shadow(direct, rays, seed):
    """This holds for any strategy.

    Scattered rays would meet the screen, so shadow rays alone decide.
    """
    screened = masked(under([AREA], [SCREEN], [diffuse(0.5)]), EVERY, rays)
    exact = 3.0 * over_pixels(from_polygon(CORNERS))
    assert_mean(replicates(screened, 8, 256, direct=direct, seed=seed), exact, PRECISION[direct], rounding=1e-3)


@DIRECT
def test_lamps_without_shadows_shine_through_everything(direct, seed):
    hidden = masked(under([replace(AREA, casts_shadow=False)], [SCREEN], [diffuse(0.5)]), EVERY, EVERY & ~CAMERA)
    exact = 3.0 * over_pixels(from_polygon(CORNERS))
    assert_mean(replicates(hidden, 8, 256, direct=direct, seed=seed), exact, PRECISION[direct], rounding=1e-3)


@DIRECT
def test_opaque_shadows_of_what_is_transparent(direct, seed):
    """A lamp above a clear screen lights nothing below it.

    A mirror there shows the lamp through the screen, and so does the sky.
    """
    clear = replace(material(Transparent(color(0.5))), transparent_shadows=False)
    screened = under([AREA], [SCREEN], [clear])
    assert not replicates(screened, 2, 64, direct=direct, seed=seed).any()
    shown = replace(
        screened, materials=(material(Glossy("GGX")), clear), camera=orthographic(1, 1, 0.01, (0.3, 0.2, 0.9))
    )
    np.testing.assert_allclose(replicates(shown, 2, 16, direct=direct, seed=seed), 0.5 * 3.0, rtol=1e-9)
    sky = replace(screened, lights=(), world=World(color(1.0), (1, 1)))
    wide = quad((-4000.0, -4000.0, 1.2), (8000.0, 0.0, 0.0), (0.0, 8000.0, 0.0), 1)
    sky = replace(sky, mesh=under([], [wide], [clear]).mesh)
    assert_mean(replicates(sky, 4, 256, direct=direct, seed=seed), 0.5 * ALBEDO, 0.01, rounding=1e-3)


def test_a_furnace_that_the_camera_does_not_see(seed):
    """Faces reflect it, and beside them the image is black."""
    world = World(color(0.7), (1, 1), SCATTERED)
    camera = orthographic(2, 1, 2.0, (0.0, 0.0, 3.0))
    plane = quad((-3.0, -3.0, 0.0), (3.0, 0.0, 0.0), (0.0, 6.0, 0.0))
    image = replicates(scene(plane, diffuse(0.4), camera, world=world), 2, 64, seed=seed)
    np.testing.assert_allclose(image[:, 0, 0], 0.4 * 0.7, rtol=1e-9)
    np.testing.assert_array_equal(image[:, 0, 1], 0.0)


COATED = material(Diffuse(color(0.4)), Glossy("GGX", color(0.5), HALF))
PARTS = {
    "coated": (COATED, {DIFFUSE: material(Diffuse(color(0.4))), GLOSSY: material(Glossy("GGX", color(0.5), HALF))}),
    "translucent": (
        material(Diffuse(color(0.4)), Translucent(color(0.3))),
        {DIFFUSE: material(Diffuse(color(0.4))), SCATTERED: material(Diffuse(color(0.4)), Translucent(color(0.3)))},
    ),
}
CAMERA_AT = orthographic(2, 2, 2.0, (2.0, 0.0, 2.0), (-1.0, 0.0, -1.0))
LOW = replace(AREA, center=(0.3, 0.2, -1.5), normal=(0.0, 0.0, 1.0))


@pytest.mark.grid(3)
@DIRECT
@pytest.mark.parametrize("name", PARTS)
def test_a_lamp_seen_by_one_kind_of_ray_lights_the_lobes_of_that_kind(name, direct, seed):
    """As if the material had no other lobes."""
    whole, parts = PARTS[name]
    for rays, part in parts.items():
        lights = [replace(light, rays=rays) for light in (AREA, LOW)]
        images = [
            replicates(scene(floor(3.0), one, CAMERA_AT, these), 12, 512, direct=direct, seed=seed)
            for one, these in ((whole, lights), (part, (AREA, LOW)))
        ]
        assert_same(*images, 0.15 if direct == "bsdf" else 0.03)


@pytest.mark.parametrize(
    "source", ["lamp", *(pytest.param(name, marks=pytest.mark.slow) for name in ("faces", "world"))]
)
def test_masks_that_part_the_rays_part_the_light(source, seed):
    """The light that each kind of ray alone finds adds up to all of it.

    The scene is a rough glass pane over a floor, from above.
    """
    pane = material(Glass(ior=Constant(1.4), roughness=Constant(0.9)), Diffuse(color(0.3)))
    geometry = [quad((-3.0, -3.0, 0.0), (6.0, 0.0, 0.0), (0.0, 6.0, 0.0))]
    if source == "faces":
        geometry += [quad(corner, (1.2, 0, 0), (0, 0.8, 0), 1) for corner in ((-0.3, -0.2, 1.5), (-0.3, -0.2, -1.5))]

    def render(rays, offset):
        lights = [replace(light, rays=rays) for light in (AREA, LOW)] if source == "lamp" else []
        world = World(color(0.7), (1, 1), rays) if source == "world" else 0.0
        one = scene(geometry, [pane, emission(3.0)], CAMERA_AT, lights, world)
        if source == "faces":
            one = masked(one, EVERY, rays | SHADOW, rays | SHADOW)
        return replicates(one, 16, 512, seed=seed + offset)

    parts = [render(rays, k) for k, rays in enumerate((DIFFUSE, GLOSSY, TRANSMISSION))]
    assert all(part.any() for part in parts)
    assert_same(sum(parts), render(SCATTERED, 10), 0.03)


def test_faces_hidden_from_diffuse_rays_light_no_diffuse_lobe(seed):
    """A rough mirror shows them.

    The weights of multiple importance sampling still sum to one for each kind.
    """
    panel = quad((-0.3, -0.2, 1.5), (1.2, 0.0, 0.0), (0.0, 0.8, 0.0), 1)

    def render(below, rays):
        one = scene([floor(3.0), panel], [below, emission(3.0)], CAMERA_AT)
        return replicates(masked(one, EVERY, rays), 12, 512, seed=seed)

    assert not render(diffuse(0.5), EVERY & ~(DIFFUSE | CAMERA)).any()
    shown = render(COATED, EVERY & ~(DIFFUSE | CAMERA)), render(PARTS["coated"][1][GLOSSY], EVERY & ~CAMERA)
    assert_same(*shown, 0.03)


@DIRECT
def test_two_panels_that_different_rays_see_light_the_floor_together(direct, seed):
    """Where no other light shines, too, each is sampled."""
    panels = [quad((x, -0.2, 1.5), (0.6, 0.0, 0.0), (0.0, 0.8, 0.0), 1) for x in (-0.3, 0.3)]

    def render(rays):
        one = scene([floor(3.0), *panels], [diffuse(0.5), emission(3.0)], CAMERA_AT)
        return replicates(masked(one, EVERY, EVERY & ~CAMERA, rays), 12, 512, direct=direct, seed=seed)

    assert_same(render(EVERY & ~(CAMERA | GLOSSY)), render(EVERY & ~CAMERA), 0.15 if direct == "bsdf" else 0.03)


def test_a_lamp_that_lights_only_what_the_camera_sees(seed):
    """A limit of 0 bounces leaves direct light, whatever else paths do.

    A limit of 1 leaves one bounce more.
    """
    room = [floor(3.0), quad((-1.0, 1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0))]
    for limit in (0, 1):
        limited = scene(room, diffuse(0.8), CAMERA_AT, [replace(POINT, max_bounces=limit)], bounces=4)
        short = scene(room, diffuse(0.8), CAMERA_AT, [POINT], bounces=limit)
        assert_same(replicates(limited, 8, 256, seed=seed), replicates(short, 8, 256, seed=seed + 1), 0.02)


def test_light_tracing_refuses_what_it_does_not_know(seed):
    for light, what in (
        (replace(AREA, rays=DIFFUSE), "ray visibility"),
        (replace(AREA, casts_shadow=False), "lights without shadows"),
        (replace(POINT, max_bounces=0), "limits of a light's bounces"),
    ):
        with pytest.raises(EtalonError, match=f"the scene: {what} by light tracing is not simulated"):
            LightTracingRenderer(scene(floor(), diffuse(0.5), CAMERA_AT, [light], bounces=2), Options())
    with pytest.raises(EtalonError, match="shadow visibility by light tracing"):
        LightTracingRenderer(masked(scene(floor(), diffuse(0.5), CAMERA_AT, [AREA]), EVERY & ~SHADOW), Options())


def test_lobes_of_one_class_sample_as_a_mixture_does(rng):
    """And those of different classes as if the others were not there."""
    u = rng.random((3, 64))
    mixture = Mixture([Lambert(), LambertTransmission()], [np.full((3, 1), 0.5), np.full((3, 1), 0.25)], 64)
    for classes in ([0, 1, 1, 1, 1], [0, 1, 1, 2, 2]):
        wi, weight, pdf, ray_class = ClassedMixture(mixture, np.array(classes)).sample_classes(*u)
        plain = mixture.sample(*u)
        for found, expected in zip((wi, weight, pdf), plain, strict=True):
            np.testing.assert_allclose(found, expected, rtol=1e-12)
        np.testing.assert_array_equal(ray_class, np.where(wi[2] < 0.0, classes[4], classes[1]))


def test_seen_lamps_are_seen_by_the_camera_alone(seed):
    below = orthographic(1, 1, 0.01, (0.3, 0.2, 0.1), (0.0, 0.0, 1.0))
    shown = scene(floor(3.0), diffuse(0.5), below, [replace(AREA, rays=CAMERA)])
    np.testing.assert_allclose(replicates(shown, 2, 16, seed=seed), 3.0, rtol=1e-12)
    lit = replace(shown, camera=CAMERA_AT)
    assert not replicates(lit, 2, 64, seed=seed).any()
    assert replicates(replace(lit, lights=(replace(AREA, rays=SEEN),)), 2, 64, seed=seed).any()


def flag(name):
    return ValueToColor(RayFlag(name))


MIRROR = material(Glossy("GGX"))
DOWN = orthographic(1, 1, 0.01, (0.0, 0.0, 3.0))
FLAGGED = {  # what the camera sees of a sky of that flag: directly, by a mirror, by a rough mirror, by Lambert
    "CAMERA": (1.0, 0.0, 0.0, 0.0),
    "SHADOW": (0.0, 0.0, 0.0, 0.0),
    "DIFFUSE": (0.0, 0.0, 0.0, 1.0),
    "GLOSSY": (0.0, 1.0, 1.0, 0.0),
    "REFLECTION": (0.0, 1.0, 1.0, 1.0),
    "SINGULAR": (0.0, 1.0, 0.0, 0.0),
    "TRANSMISSION": (0.0, 0.0, 0.0, 0.0),
}


@pytest.mark.grid(3)
@pytest.mark.parametrize("name", FLAGGED)
def test_a_sky_that_only_rays_of_a_kind_see(name, seed):
    world = World(flag(name), (8, 4))
    up = orthographic(1, 1, 0.01, (0.0, 0.0, 3.0), (0.0, 0.0, 1.0))
    coats = MIRROR, MIRROR, material(Glossy("GGX", roughness=HALF)), diffuse(1.0)
    for shown, coat, camera in zip(FLAGGED[name], coats, (up, DOWN, DOWN, DOWN), strict=True):
        image = replicates(scene(floor(3.0), coat, camera, world=world), 4, 256, seed=seed)
        full = replicates(scene(floor(3.0), coat, camera, world=1.0), 4, 256, seed=seed)
        np.testing.assert_allclose(image, shown * full, rtol=1e-9)


@pytest.mark.parametrize(("coat", "shown"), [(glass(1.0), "GLOSSY"), (material(Translucent()), "DIFFUSE")])
def test_transmitted_rays_are_glossy_or_diffuse_too(coat, shown, seed):
    """Below a pane the sky shows by transmission.

    It also shows by the family of the lobe that transmits.
    """
    below = orthographic(1, 1, 0.01, (0.0, 0.0, -1.0), (0.0, 0.0, 1.0))
    for name in ("TRANSMISSION", "GLOSSY", "DIFFUSE", "REFLECTION"):
        image = replicates(scene(floor(3.0), coat, below, world=World(flag(name), (8, 4))), 2, 64, seed=seed)
        np.testing.assert_allclose(image, float(name in ("TRANSMISSION", shown)), rtol=1e-9)


@DIRECT
def test_shadow_rays_pass_what_is_transparent_to_them_alone(direct, seed):
    """Glass is often made clear to lamps in this way.

    Opaque to all other rays, it takes nothing from the light below.
    """
    pane = Material(
        "pane",
        (
            WeightedClosure(Transparent(), RayFlag("SHADOW")),
            WeightedClosure(Diffuse(color(0.5)), Math("SUBTRACT", ONE, RayFlag("SHADOW"), ZERO)),
        ),
    )
    exact = 3.0 * over_pixels(from_polygon(CORNERS))
    images = replicates(under([AREA], [SCREEN], [pane]), 8, 256, direct=direct, seed=seed)
    assert_mean(images, exact, PRECISION[direct], rounding=1e-3)


def test_a_face_that_only_the_camera_sees_shine_lights_nothing(seed):
    panel = quad((-0.3, -0.2, 1.5), (1.2, 0.0, 0.0), (0.0, 0.8, 0.0), 1)
    glow = material(Emission(flag("CAMERA")))
    beneath = orthographic(1, 1, 0.01, (0.3, 0.2, 0.9))
    assert not replicates(scene([floor(3.0), panel], [diffuse(0.5), glow], beneath), 4, 64, seed=seed).any()
    above = orthographic(1, 1, 0.01, (0.0, 0.0, 3.0))
    image = replicates(scene([floor(3.0), panel], [diffuse(0.5), glow], above), 2, 16, seed=seed)
    np.testing.assert_allclose(image, 1.0, rtol=1e-12)


def test_colours_by_the_ray_that_meets_them(seed):
    """A wall that is white to diffuse rays and black to the camera.

    It lights the floor as a white one does.
    """
    room = [floor(3.0), quad((-1.0, 1.0, 0.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0), 1)]

    def render(coat):
        return replicates(scene(room, [diffuse(0.8), coat], CAMERA_AT, [POINT], bounces=1), 8, 256, seed=seed)

    assert_same(render(material(Diffuse(flag("DIFFUSE")))), render(diffuse(1.0)), 0.02)
    assert_same(render(material(Diffuse(flag("GLOSSY")))), render(diffuse(0.0)), 0.02)


def test_emission_by_kinds_that_light_samples_do_not_have_is_refused():
    glow = material(Emission(flag("DIFFUSE")))
    with pytest.raises(SceneError, match="its emission depends on the kind of ray"):
        validate(scene(floor(), glow, CAMERA_AT))
