# SPDX-License-Identifier: GPL-3.0-or-later
"""Volumes that absorb: Beer and Lambert's law.

It is tested along camera rays, refracted rays and shadow rays.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.light_tracing.render import LightTracingRenderer
from etalon.lib.scene.lights import AreaLight, PointLight, SphereLight, SunLight
from etalon.lib.scene.links import Links
from etalon.lib.scene.materials import Material
from etalon.lib.scene.rays import EVERY, GLOSSY, SEEN
from etalon.lib.scene.scene import Transport
from etalon.lib.scene.volumes import Volume
from etalon.lib.scene.world import World
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.replicates import assert_mean, assert_same, replicates
from etalon.tests.scenes import Part, color, cube, diffuse, floor, glass, orthographic, perspective, scene

SIGMA = np.array([0.2, 0.7, 1.6])
TINT = Volume(tuple(SIGMA))
ABOVE = orthographic(2, 2, 0.5, (0.03, 0.02, 10.0))
FOG = World(color(0.0), volume=TINT)


def bounds(*sigma):
    return Material("bounds", (), volume=Volume(sigma), only_bounds=True)


def flipped(part):
    return replace(part, triangles=part.triangles[::-1])


def together(*parts):
    """One object of several parts."""
    first = np.cumsum([0, *(part.vertices.shape[1] for part in parts)])
    triangles = [part.triangles + k for part, k in zip(parts, first, strict=False)]
    vertices = np.concatenate([part.vertices for part in parts], axis=1)
    return Part(vertices, np.concatenate(triangles, axis=1), parts[0].material)


def assert_exact(the_scene, exact, seed, **options):
    """The image is exact up to what single precision leaves of the lengths of rays.

    Rays set out a little off the faces.
    """
    images = replicates(the_scene, 1, 4, seed=seed, **options)
    np.testing.assert_allclose(images, np.broadcast_to(exact, images.shape), rtol=2e-5)


def test_a_slab_in_front_of_the_sky(seed):
    assert_exact(scene(cube(), bounds(*SIGMA), ABOVE, world=2.0), 2.0 * np.exp(-2.0 * SIGMA), seed)


def test_slanted_rays_have_a_longer_way(seed):
    """Through the middle of a wide slab of 2 m: exp(-2 sigma / cos)."""
    forward = np.array([0.6, 0.0, -0.8])
    camera = orthographic(2, 2, 1e-3, -10.0 * forward, forward)
    wide = replace(cube(), vertices=cube().vertices * np.array([[5.0], [5.0], [1.0]]))
    assert_exact(scene(wide, bounds(*SIGMA), camera, world=1.0), np.exp(-2.0 / 0.8 * SIGMA), seed)


def test_a_camera_inside(seed):
    camera = orthographic(2, 2, 0.5, (0.03, 0.02, 0.4))
    assert_exact(scene(cube(), bounds(*SIGMA), camera, world=1.0), np.exp(-1.4 * SIGMA), seed)


def test_a_camera_inside_by_its_near_plane(seed):
    """Camera rays begin at the near plane, in Cycles too."""
    camera = replace(ABOVE, clip_start=9.6)
    assert_exact(scene(cube(), bounds(*SIGMA), camera, world=1.0), np.exp(-1.4 * SIGMA), seed)


def test_volumes_that_overlap_add_up(seed):
    """A cube inside a cube, and one that reaches half out of it."""
    more = np.array([0.5, 0.1, 0.3])
    for inner, length in ((cube(0.5, material=1), 1.0), (cube(0.5, (0.0, 0.0, 1.0), 1), 1.0)):
        both = scene([cube(), inner], [bounds(*SIGMA), bounds(*more)], ABOVE, world=1.0)
        assert_exact(both, np.exp(-2.0 * SIGMA - length * more), seed)


def test_a_hollow_is_empty(seed):
    """The inner wall of a bottle is turned inwards, so that nothing is in it."""
    bottle = together(cube(), flipped(cube(0.5)))
    assert_exact(scene(bottle, bounds(*SIGMA), ABOVE, world=1.0), np.exp(-1.0 * SIGMA), seed)
    inside = orthographic(2, 2, 0.5, (0.03, 0.02, 0.2))
    assert_exact(scene(bottle, bounds(*SIGMA), inside, world=1.0), np.exp(-0.5 * SIGMA), seed)


@pytest.mark.parametrize("limit", [0, 1, 64])
def test_faces_that_only_bound_a_volume_count_as_no_transparent_ones(limit, seed):
    shells = [cube(0.1 * k) for k in range(1, 9)]
    stack = scene(shells, bounds(*(0.2 * SIGMA)), ABOVE, world=1.0, transparent_max_bounces=limit)
    camera = orthographic(2, 2, 0.1, (0.03, 0.02, 10.0))
    exact = np.exp(-0.04 * sum(range(1, 9)) * SIGMA)
    assert_exact(replace(stack, camera=camera), exact, seed)
    under = [floor(5.0, -3.0, 1), *shells]
    lit = scene(under, [bounds(*(0.2 * SIGMA)), diffuse(0.8)], camera, [SunLight("sun", (0, 0, 1.0), 0.0, (1.0,) * 3)])
    assert_exact(replace(lit, transport=Transport(0, limit)), 0.8 / np.pi * exact**2, seed)


def test_a_glass_block_absorbs_at_every_pass(seed):
    """R + (1 - R)^2 T / (1 - R T), with R of the index at normal incidence."""
    index, camera = 1.5, orthographic(2, 2, 0.5, (0.03, 0.02, 10.0))
    block = scene(cube(), replace(glass(index), volume=TINT), camera, world=1.0, bounces=40)
    mirror, through = ((index - 1.0) / (index + 1.0)) ** 2, np.exp(-2.0 * SIGMA)
    exact = mirror + (1.0 - mirror) ** 2 * through / (1.0 - mirror * through)
    assert_mean(replicates(block, 12, 256, seed=seed), exact, 0.01, rounding=1e-5)


@pytest.mark.parametrize("direct", ["mis", "lights", "bsdf"])
def test_fog_between_lamp_floor_and_camera(direct, seed):
    """A point light at 2 m over the floor, the camera at 3 m.

    Lambert's law, and exp(-5 sigma).
    """
    lamp = PointLight("lamp", (0.0, 0.0, 2.0), (3.0, 3.0, 3.0))
    camera = orthographic(2, 2, 1e-3, (0.0, 0.0, 3.0))
    misty = scene(floor(5.0), diffuse(0.8), camera, [lamp], FOG)
    assert_exact(misty, 0.8 / np.pi * 3.0 / 4.0 * np.exp(-5.0 * SIGMA), seed, direct=direct)


def test_fog_hides_the_sky_and_the_sun(seed):
    """Where a channel is not absorbed, light comes from however far."""
    clear = World(color(1.0), volume=Volume((0.0, 0.1, 1e-3)))
    sky = scene(floor(0.01, -5.0), diffuse(0.8), ABOVE, world=clear)
    assert_exact(sky, (1.0, 0.0, 0.0), seed)
    sun = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (1.0,) * 3)
    lit = scene(floor(5.0), diffuse(0.8), ABOVE, [sun], replace(clear, radiance=color(0.0)))
    assert_exact(lit, (0.8 / np.pi, 0.0, 0.0), seed)


def test_lamps_are_seen_through_what_is_before_them(seed):
    """Spheres of light at 3 m and 7 m before the camera, the nearer in a cube.

    Each is dimmed by what lies before it, not by what is behind.
    """
    camera = orthographic(1, 1, 1e-3, (0.0, 0.0, 10.0))
    near, far = (
        SphereLight(name, (0.0, 0.0, z), 0.5, (1.0,) * 3, rays=SEEN) for name, z in (("near", 6.5), ("far", 2.5))
    )
    box = cube(1.0, (0.0, 0.0, 6.5))
    lamps = scene([box, floor(5.0, material=1)], [bounds(*SIGMA), diffuse(0.0)], camera, [near, far])
    assert_exact(lamps, np.exp(-0.5 * SIGMA) + np.exp(-2.0 * SIGMA), seed)
    assert_exact(replace(lamps, world=FOG), np.exp(-3.5 * SIGMA) + np.exp(-9.0 * SIGMA), seed)


def test_all_ways_of_finding_a_lamp_agree(seed):
    """A broad lamp within fog and over a floor, under a slab that only bounds."""
    lamp = AreaLight("a", (0, 0, 3.0), (4.0, 0, 0), (0, -4.0, 0), (0, 0, -1.0), "RECTANGLE", (1.0,) * 3, np.pi)
    camera = perspective(2, 2, 0.2, (1.0, 0.0, 6.0))
    slab = replace(cube(0.5, (0.0, 0.0, 1.5)), vertices=cube(0.5, (0.0, 0.0, 1.5)).vertices * [[9.0], [9.0], [1.0]])
    fog = World(color(0.0), volume=Volume((0.05, 0.1, 0.2)))
    misty = scene([floor(5.0, 0.0, 1), slab], [bounds(*SIGMA), diffuse(0.8)], camera, [lamp], fog, bounces=1)
    images = {way: replicates(misty, 8, 128, direct=way, seed=seed) for way in ("mis", "lights", "bsdf")}
    assert_same(images["mis"], images["lights"], 0.02)
    assert_same(images["mis"], images["bsdf"], 0.05)


def test_light_tracing_refuses_volumes():
    with pytest.raises(Refused, match="volumes by light tracing"):
        LightTracingRenderer(scene(cube(), bounds(*SIGMA), ABOVE), Options())


OPEN = replace(cube(), triangles=cube().triangles[:, 1:])
REFUSED = {
    "its faces leave an opening": OPEN,
    "its faces point inwards": flipped(cube()),
    "its parts overlap, or point inwards": together(cube(), cube(0.5)),
    "its parts overlap": together(cube(), flipped(cube(0.5, (5.0, 0.0, 0.0)))),
}


@pytest.mark.parametrize("named", REFUSED)
def test_faces_that_enclose_nothing_are_refused(named):
    with pytest.raises(Refused, match=f"object 'object 0': the volume of material 'bounds', because {named}"):
        ReferenceRenderer(scene(REFUSED[named], bounds(*SIGMA), ABOVE), Options())
    ReferenceRenderer(scene(REFUSED[named], bounds(0.0, 0.0, 0.0), ABOVE), Options())  # it does nothing


def test_masks_and_links_that_rays_inside_would_miss_are_refused():
    box = scene(cube(), bounds(*SIGMA), ABOVE, [PointLight("lamp", (0.0, 0.0, 3.0), (1.0,) * 3)])
    (thing,) = box.mesh.objects
    masked = replace(box, mesh=replace(box.mesh, objects=(replace(thing, rays=EVERY & ~GLOSSY),)))
    with pytest.raises(Refused, match="an object that some rays do not meet"):
        ReferenceRenderer(masked, Options())
    linked = replace(box, lights=(replace(box.lights[0], links=Links(blockers=2)),))
    with pytest.raises(Refused, match="'lamp': shadow linking beside a volume"):
        ReferenceRenderer(linked, Options())
