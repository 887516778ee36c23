# SPDX-License-Identifier: GPL-3.0-or-later
"""Subsurface scattering: furnaces, and half spaces solved by Chandrasekhar.

Also which objects take part in a walk.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.bsdfs.lambert import Lambert
from etalon.lib.errors import Refused
from etalon.lib.film.light_passes import LightPass
from etalon.lib.scattering.subsurface import albedo_van_de_hulst
from etalon.lib.scene.expressions import ZERO, Constant
from etalon.lib.scene.lights import AreaLight
from etalon.lib.scene.links import Links
from etalon.lib.scene.materials import Glossy, Material, Subsurface, WeightedClosure
from etalon.lib.scene.rays import CAMERA
from etalon.lib.scene.volumes import Volume
from etalon.lib.settings.reference import Options
from etalon.lib.surfaces.subsurface import refract_below
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.lib.scattering.test_subsurface import MU, WEIGHT, h_function
from etalon.tests.replicates import assert_mean, assert_same, replicates
from etalon.tests.scenes import color, cube, diffuse, floor, icosphere, material, orthographic, quad, scene

ABOVE = orthographic(2, 2, 0.5, (0.03, 0.02, 5.0))
IOR = 1.4
SMOOTH = {"ior": Constant(IOR), "alpha": ZERO}
COLORS, RADII = (0.6, 0.3, 0.05), (0.05, 0.02, 0.1)
WAX = material(Subsurface(color(*COLORS), color(*RADII), **SMOOTH))
AREA = AreaLight("area", (0.4, 0.3, 3.0), (1.0, 0, 0), (0, -1.0, 0), (0, 0, -1.0), "RECTANGLE", (3.0, 2.0, 1.0), np.pi)


def of_half_space(albedo, cosine):
    """What leaves a half space that light enters with this cosine; isotropic scattering."""
    root = np.sqrt(1.0 - albedo)
    return 1.0 - root / (root + 0.5 * albedo * (WEIGHT * h_function(albedo) * MU / (cosine + MU)).sum())


def expected(cosine):
    """The same for the colours of the wax, by channel, under a smooth interface.

    Below an albedo of 0.2 it is scaled.
    """
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / IOR**2)
    albedo = [float(albedo_van_de_hulst(np.float64(one), np.float64(0.0))) for one in COLORS]
    return np.array([of_half_space(one, inside) for one in albedo])


@pytest.mark.parametrize("cosine", [1.0, 0.4])
def test_a_half_space_in_a_furnace_shows_what_chandrasekhar_says(cosine, seed):
    """Each channel has its own free path, and the walks of all channels are one.

    The interface bends the view, and takes nothing.
    """
    forward = (np.sqrt(1.0 - cosine**2), 0.0, -cosine)
    camera = orthographic(2, 2, 0.5, tuple(-5.0 * np.array(forward)), forward)
    images = replicates(scene(floor(20.0), WAX, camera, world=1.0), 8, 256, seed=seed)
    assert_mean(images, expected(cosine), 0.04)


def thin():
    """A closed slab, a tenth of a mean free path thick."""
    box = cube()
    return replace(box, vertices=box.vertices * np.array([[2.0], [2.0], [0.025]]))


@pytest.mark.parametrize("body", [icosphere(1.0, 2), thin()], ids=["sphere", "slab"])
def test_a_white_body_in_a_furnace_loses_nothing(body, seed):
    white = material(Subsurface(color(1.0), color(0.5), Constant(0.3), Constant(IOR), Constant(0.5)))
    images = replicates(scene(body, white, ABOVE, world=1.0), 4, 64, seed=seed)
    assert_mean(images, 1.0, 0.01, rounding=1e-3)


def test_light_that_gets_out_by_an_opening_is_lost(seed):
    """A square has no other side.

    Half of what a white one scatters once goes down for good, and the walk ends.
    """
    white = material(Subsurface(color(1.0), color(0.5), **SMOOTH))
    images = replicates(scene(floor(), white, ABOVE, world=1.0), 4, 64, seed=seed)
    assert 0.5 < images.mean() < 0.95


def test_light_that_enters_is_bent_as_snell_says(rng):
    wo = np.repeat(np.array([[0.6], [0.0], [0.8]]), 4, axis=1)
    down = refract_below(wo, 0.0, np.full(4, 1.5), *rng.random((2, 4)))
    np.testing.assert_allclose(down[:, 0], [-0.4, 0.0, -np.sqrt(1.0 - 0.16)], atol=1e-12)
    rough = refract_below(wo, 1.0, np.full(4, 1.5), *rng.random((2, 4)))
    np.testing.assert_allclose(np.linalg.norm(rough, axis=0), 1.0)
    assert (rough[2] < 0.0).all()
    assert not refract_below(-wo, 1.0, np.full(4, 1.5), *rng.random((2, 4))).any()


def lit(parts, materials, **more):
    options = {"camera": ABOVE, "lights": (AREA,), "bounces": 2}
    return scene(parts, materials, **{**options, **more})


@pytest.mark.slow
def test_light_and_lobe_sampling_find_the_same_light_where_walks_leave(seed):
    images = [
        replicates(lit(cube(), WAX), 8, 128, direct=direct, seed=seed + k) for k, direct in enumerate(("lights", "mis"))
    ]
    assert_same(*images, 0.1)


@pytest.mark.slow
def test_walks_stay_inside_their_own_object(seed):
    """A black core inside the wax, another object, changes nothing.

    As a part of the same object it takes light.
    """
    coats = [WAX, diffuse(0.0)]
    core = cube(0.9, material=1)
    alone, apart = (replicates(lit(parts, coats), 8, 128, seed=seed) for parts in ([cube()], [cube(), core]))
    np.testing.assert_allclose(apart, alone, rtol=1e-4, atol=1e-7)
    one = lit([cube(), replace(core, material=0)], coats)
    joined = replace(one.mesh, object_index=np.zeros_like(one.mesh.object_index), objects=one.mesh.objects[:1])
    other = replicates(replace(one, mesh=joined), 8, 128, seed=seed)
    assert abs(other.mean() / alone.mean() - 1.0) > 0.01


def test_a_small_body_in_a_large_scene_is_resolved(seed):
    """A cube of 2 mm, and a face a kilometre away: the same image as of the large cube alone."""

    def render(size, more=()):
        radius = color(*(size * one for one in RADII))
        coat = material(Subsurface(color(*COLORS), radius, **SMOOTH))
        camera = orthographic(2, 2, 0.5 * size, (0.03 * size, 0.02 * size, 5.0 * size))
        return replicates(scene([cube(size), *more], coat, camera, world=1.0), 2, 64, seed=seed)

    far = quad((1000.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    np.testing.assert_allclose(render(0.001, [far]), render(1.0), rtol=1e-2)


def test_channels_without_a_radius_reflect_where_they_arrive(seed):
    """Blue is Lambert's alone, and textures that reach 0 are asked at each point."""
    wax = lit(cube(), material(Subsurface(color(0.5, 0.4, 0.7), color(0.1, 0.1, 0.0), **SMOOTH)), world=1.0)
    plain = lit(cube(), diffuse(0.5, 0.4, 0.7), world=1.0)
    mine, other = (replicates(one, 8, 256, seed=seed, sampler="random") for one in (wax, plain))
    assert_same(mine[..., 2:], other[..., 2:], 0.05)
    assert abs(mine[..., 0].mean() / other[..., 0].mean() - 1.0) > 0.02


@pytest.mark.slow
def test_what_enters_is_chosen_beside_the_other_lobes(seed):
    """A mix is the sum of its parts, whatever the chances by which a path takes one of them."""

    def lobes(*pairs):
        return Material("mix", tuple(WeightedClosure(c, Constant(w)) for c, w in pairs))

    wax, gloss = WAX.lobes[0].closure, Glossy("GGX", color(0.8), Constant(0.6))
    parts = [replicates(lit(cube(), lobes(one), world=0.5), 8, 128, seed=seed) for one in ((wax, 0.3), (gloss, 0.6))]
    whole = replicates(lit(cube(), lobes((wax, 0.3), (gloss, 0.6)), world=0.5), 8, 128, seed=seed)
    assert_same(whole, sum(parts), 0.1)


def test_light_from_below_is_diffuse_to_the_passes(seed):
    """It is direct where it scatters once below the surface, walk and exit together.

    After that it is indirect.
    """
    passes = tuple(LightPass)
    wax = material(Subsurface(color(0.8), color(0.1), **SMOOTH))
    rendering = ReferenceRenderer(lit(cube(), wax, world=1.0), Options(seed=seed, threads=1), passes=passes).render(
        0, 64
    )
    found = {name for name, image in rendering.passes.items() if image.any()}
    assert found == {LightPass.DIFFUSE_DIRECT}
    np.testing.assert_allclose(rendering.passes[LightPass.DIFFUSE_DIRECT], rendering.radiance, rtol=1e-12)
    bowl = [cube(), floor(5.0, -1.5, 1)]
    below = orthographic(2, 2, 0.5, (2.0, 0.0, 5.0))
    image = ReferenceRenderer(
        lit(bowl, [wax, wax], camera=below, world=1.0), Options(seed=seed, threads=1), passes=passes
    ).render(0, 64)
    assert image.passes[LightPass.DIFFUSE_INDIRECT].any()


def test_light_is_linked_to_the_object_that_light_leaves(seed):
    near = replace(AREA, links=Links(receivers=0b10))
    the_scene = lit(cube(), WAX, lights=(near,))
    assert not replicates(the_scene, 1, 16, seed=seed).any()
    objects = tuple(replace(one, receiver=1) for one in the_scene.mesh.objects)
    assert replicates(replace(the_scene, mesh=replace(the_scene.mesh, objects=objects)), 1, 16, seed=seed).any()


def test_an_object_that_rays_do_not_meet_still_keeps_walks_inside(seed):
    """Ray visibility is about rays from outside.

    Hidden from all but the camera, the body looks as before.
    """
    the_scene = lit(cube(), WAX)
    hidden = tuple(replace(one, rays=CAMERA) for one in the_scene.mesh.objects)
    other = replace(the_scene, mesh=replace(the_scene.mesh, objects=hidden))
    images = [replicates(one, 2, 64, seed=seed) for one in (the_scene, other)]
    np.testing.assert_allclose(*images, rtol=1e-9)


def test_beside_a_volume_that_it_may_reach_into_it_is_refused():
    fog = replace(diffuse(0.5), volume=Volume((1.0, 1.0, 1.0)))
    with pytest.raises(Refused, match="object 'object 0': subsurface scattering where the object may reach"):
        ReferenceRenderer(lit([cube(), cube(0.5, (1.2, 0, 0), 1)], [WAX, fog]), Options())
    ReferenceRenderer(lit([cube(), cube(0.1, (1.2, 0, 0), 1)], [WAX, fog]), Options())


def test_different_normals_of_one_material_are_refused():
    tilted = Constant((0.6, 0.0, 0.8))
    both = material(Subsurface(color(0.5)), Subsurface(color(0.4), normal=tilted))
    with pytest.raises(Refused, match="several closures with different normals"):
        ReferenceRenderer(lit(cube(), both), Options())


def test_a_white_face_is_all_that_light_meets_where_it_leaves(monkeypatch, seed):
    """The error planted: a face that keeps a tenth of what leaves is seen."""
    kept = Lambert.sample
    monkeypatch.setattr(Lambert, "sample", lambda self, *u: (lambda w, x, p: (w, 0.9 * x, p))(*kept(self, *u)))
    images = replicates(scene(floor(20.0), WAX, ABOVE, world=1.0), 4, 256, seed=seed)
    assert images.mean() < 0.95 * expected(1.0).mean()
