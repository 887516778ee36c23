# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a scene lies and how large it is does not matter.

Nothing leaks through a closed surface.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.scene.lights import AreaLight, PointLight, SphereLight, SunLight
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.replicates import assert_same, blocks, replicates
from etalon.tests.scenes import (
    cube,
    diffuse,
    emission,
    floor,
    glossy,
    icosphere,
    material,
    orthographic,
    perspective,
    quad,
    scene,
    transparent,
)

LIGHTS = [
    AreaLight(
        "area",
        (1.0, 0.0, 3.0),
        (1.0, 0.0, 0.0),
        (0.0, -1.0, 0.0),
        (0.0, 0.0, -1.0),
        "RECTANGLE",
        (5.0, 5.0, 5.0),
        np.pi,
    ),
    SphereLight("sphere", (-1.5, -1.0, 1.5), 0.3, (6.0, 7.0, 8.0)),
    PointLight("point", (-2.0, -1.0, 2.0), (2.0, 2.0, 2.0)),
    SunLight("sun", (0.6, 0.0, 0.8), 0.05, (0.3, 0.3, 0.3)),
]
CAMERA = perspective(16, 16, 0.5, (0.01, -3.0, 2.5), (0.0, 3.0, -2.2))
FAR = [(1e4, -1e4, 1e4), (1e5, 1e5, -1e5)]


def stage(camera=CAMERA, veil=True):
    parts = [icosphere(0.9, 3), floor(4.0, -1.0, 1), quad((-2.0, 1.5, -0.5), (1.0, 0.3, 0.0), (0.0, 0.3, 1.0), 2)]
    materials = [glossy(0.2, 0.8), diffuse(0.6, 0.5, 0.4), emission(3.0)]
    if veil:
        parts.append(floor(0.5, 1.5, 3))
        materials.append(transparent(0.9, 0.8, 0.7))
    return scene(parts, materials, camera, LIGHTS, 0.2, bounces=3)


def placed(the_scene, size=1.0, offset=(0.0, 0.0, 0.0)):
    """The scene `size` times as large and moved.

    Intensities grow with the square, so that radiance stays.
    """
    offset = np.array(offset, float)
    mesh = replace(the_scene.mesh, vertices=the_scene.mesh.vertices * size + offset[:, None])
    camera = the_scene.camera
    to_world = camera.world_from_camera.copy()
    to_world[:, 3] = to_world[:, 3] * size + offset
    plane = camera.plane_from_raster * (size if camera.kind == "ORTHOGRAPHIC" else 1.0)
    camera = replace(camera, world_from_camera=to_world, plane_from_raster=plane, clip_end=camera.clip_end * size)

    def at(v):
        return tuple(np.array(v) * size + offset)

    def grown(v, by=size):
        return tuple(np.array(v) * by)

    lights = []
    for light in the_scene.lights:
        if isinstance(light, AreaLight):
            light = replace(light, center=at(light.center), edge_u=grown(light.edge_u), edge_v=grown(light.edge_v))
        elif isinstance(light, SphereLight):
            light = replace(light, position=at(light.position), radius=light.radius * size)
        elif isinstance(light, PointLight):
            light = replace(light, position=at(light.position), intensity=grown(light.intensity, size * size))
        lights.append(light)
    return replace(the_scene, mesh=mesh, camera=camera, lights=tuple(lights))


def assert_alike(here, there):
    """The same random numbers give the same pixels, except for single rays at edges.

    These do not add up to anything.
    """
    scale = here.mean()
    different = np.abs(here - there) > 1e-4 * scale
    assert different.mean() < 0.02
    assert abs(there.mean() / here.mean() - 1.0) < 2e-4
    assert np.median(np.abs(here - there)) < 1e-6 * scale


@pytest.mark.grid(3)
@pytest.mark.parametrize(
    "camera", [CAMERA, orthographic(16, 16, 4.0, (0.01, -3.0, 2.5), (0.0, 3.0, -2.2))], ids=["persp", "ortho"]
)
@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), *FAR])
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e4])
def test_place_and_size_do_not_matter(camera, offset, size, seed):
    if size == 1.0 and not any(offset):
        return
    if size < 1.0 and any(offset):
        offset = tuple(1e-2 * x for x in offset)  # a millimetre scene 100 m and 1 km away: float64 itself ends beyond
    here = ReferenceRenderer(stage(camera), Options(seed=seed, threads=1)).render(0, 16).radiance
    there = ReferenceRenderer(placed(stage(camera), size, offset), Options(seed=seed, threads=1)).render(0, 16).radiance
    assert_alike(here, there)


def test_far_and_near_by_statistics(seed):
    """Other random numbers, block by block."""
    near = blocks(replicates(stage(), 10, 16, seed=seed), 8)
    far = blocks(replicates(placed(stage(), 10.0, FAR[1]), 10, 16, seed=seed + 1), 8)
    assert_same(near, far, 0.02)


OUTSIDE = [
    SunLight("sun", (0.3, 0.5, 0.81), 0.1, (1e3, 1e3, 1e3)),
    PointLight("point", (3.0, 3.0, 3.0), (1e5, 1e5, 1e5)),
    SphereLight("sphere", (-4.0, 0.0, 3.0), 1.0, (1e3, 1e3, 1e3)),
    AreaLight(
        "area",
        (0.0, 0.0, 4.0),
        (6.0, 0.0, 0.0),
        (0.0, -6.0, 0.0),
        (0.0, 0.0, -1.0),
        "RECTANGLE",
        (1e3, 1e3, 1e3),
        np.pi,
    ),
]
INSIDE = perspective(48, 48, 1.2, (0.11, -0.23, 0.07), (0.4, 0.7, -0.2))
BOXES = {"cube": cube(), "icosphere": icosphere(1.0, 3)}


@pytest.mark.grid(3)
@pytest.mark.parametrize("box", BOXES)
@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), *FAR])
@pytest.mark.parametrize("walls", ["black", "diffuse", "glossy"])
def test_nothing_leaks_into_a_closed_box(box, offset, walls, seed):
    """Lights and a sky of 1000 outside give exactly nothing inside.

    That holds for camera rays, scattered rays and shadow rays.
    """
    coat = {"black": material(), "diffuse": diffuse(0.9), "glossy": glossy(0.1)}[walls]
    closed = placed(scene(BOXES[box], coat, INSIDE, OUTSIDE, 1e3, bounces=4), 1.0, offset)
    assert not replicates(closed, 1, 8, seed=seed).any()


@pytest.mark.slow
@pytest.mark.parametrize("box", BOXES)
def test_nothing_leaks_in_ten_million_rays(box, seed):
    """The hit that lies on an edge to float32's last bit is one in a million.

    Even so, next to nothing comes in.
    """
    closed = scene(BOXES[box], diffuse(0.9), INSIDE, (), 1.0, bounces=8)
    rendering = ReferenceRenderer(closed, Options(seed=seed, russian_roulette=False)).render(0, 512)
    assert rendering.rays > 1e7
    assert rendering.radiance.mean() < 1e-6


@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), *FAR])
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e4])
@pytest.mark.parametrize(
    "towards",
    [(1.0, 1.0, 0.0), (1.0, 1.0, 1.0), (0.0, 0.0, 1.0), (1.0, -1.0, 0.3)],
    ids=["edge", "corner", "diagonal", "low_edge"],
)
def test_camera_rays_through_edges_and_corners(offset, size, towards, seed):
    """Every ray of the image runs into an edge, a corner or the diagonal of a side.

    It does to within rounding: none slips through.
    """
    camera = perspective(32, 32, 1e-7, (0.0, 0.0, 0.0), towards)
    closed = placed(scene(cube(), material(), camera, world=1e3), size, offset)
    assert not replicates(closed, 1, 4, seed=seed).any()


def test_edges_between_visible_quads_show_no_line(seed):
    """A floor of many sheets that share edges, over a bright world.

    The world shines through nowhere.
    """
    x = np.linspace(-1.0, 1.0, 23)
    vertices = np.stack([*(g.ravel() for g in np.meshgrid(x, x, indexing="ij")), np.zeros(23 * 23)])
    i = (np.arange(22)[:, None] * 23 + np.arange(22)).ravel()
    triangles = np.concatenate([np.stack([i, i + 23, i + 24]), np.stack([i, i + 24, i + 1])], axis=1)
    sheet = type(cube())(vertices, triangles)
    image = replicates(
        scene(sheet, material(), orthographic(32, 32, 1.9, (0.0, 0.0, 1.0)), world=1.0), 1, 64, seed=seed
    )
    assert not image.any()
