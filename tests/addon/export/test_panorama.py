# SPDX-License-Identifier: GPL-3.0-or-later
"""Panoramic cameras against Cycles' own.

One sample through each pixel's centre gives the point that the ray met.
"""

import numpy as np
import pytest
from etalon.lib.scene.camera import PANORAMAS
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.camera_rays import camera_rays
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.addon.export.conftest import ASIDE
from etalon.tests.addon.export.test_camera import randomize, room

pytestmark = pytest.mark.parametrize("kind", PANORAMAS)


def panorama(studio, rng, kind):
    """A panoramic camera with everything that its kind reads drawn at random."""
    room(studio)
    randomize(studio, rng, "PERSP")
    data = studio.camera.data
    data.type, data.panorama_type = "PANO", kind
    data.longitude_min, data.longitude_max = float(rng.uniform(-3.0, -1.0)), float(rng.uniform(0.5, 3.0))
    data.latitude_min, data.latitude_max = float(rng.uniform(-1.5, -0.5)), float(rng.uniform(0.1, 1.5))
    data.central_cylindrical_range_u_min, data.central_cylindrical_range_u_max = -2.0, float(rng.uniform(0.5, 3.0))
    data.central_cylindrical_range_v_min, data.central_cylindrical_range_v_max = -0.7, float(rng.uniform(0.1, 1.5))
    data.central_cylindrical_radius = float(rng.uniform(0.5, 2.0))
    data.fisheye_fov, data.fisheye_lens = float(rng.uniform(2.0, 5.0)), float(rng.uniform(6.0, 14.0))
    data.clip_start = 0.01


def through_centres(camera):
    """Cycles' own raster points in its first sample, (2, h, w)."""
    x, y = np.meshgrid(np.arange(camera.width) + 0.5, camera.height - 0.5 - np.arange(camera.height))
    return x + ASIDE, y + ASIDE


def check(studio):
    camera = studio.export().camera
    x, y = through_centres(camera)
    rays = camera_rays(camera, x.ravel(), y.ravel(), None)
    points = studio.probe("ShaderNodeNewGeometry", "Position").transpose(2, 0, 1).reshape(3, -1)
    seen = points.any(axis=0)  # outside its circle a lens is black in Cycles
    index = np.arange(seen.size) if rays.index is None else rays.index
    assert np.array_equal(np.flatnonzero(seen), index)
    assert np.allclose((rays.direction**2).sum(axis=0), 1.0)
    to = points[:, index] - camera.world_from_camera[:, 3:]
    to /= np.linalg.norm(to, axis=0)
    apart = np.abs(to - rays.direction).max()
    # Near the ball's rim the root of 1 - r^2 has lost half of float32's digits.
    assert apart < (5e-4 if camera.kind == "MIRRORBALL" else 2e-5)


@pytest.mark.parametrize("turn", range(2))
def test_rays_meet_what_cycles_sees(studio, rng, kind, turn):
    panorama(studio, rng, kind)
    check(studio)


def test_the_border_is_the_raster(studio, rng, kind):
    panorama(studio, rng, kind)
    render = studio.scene.render
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x = 0.23, 0.81
    render.border_min_y, render.border_max_y = 0.37, 0.9
    check(studio)


def test_clip_distances_count_along_the_ray(studio, rng, kind):
    """What lies nearer than one, or farther than the other, is not met."""
    panorama(studio, rng, kind)
    data = studio.camera.data
    studio.camera.location = (10.0, 10.0, 10.0)
    data.clip_start, data.clip_end = 0.01, 12.0
    camera = studio.export().camera
    x, y = through_centres(camera)
    rays = camera_rays(camera, x.ravel(), y.ravel(), None)
    assert np.allclose(rays.reach, 11.99)
    assert np.allclose(np.linalg.norm(rays.origin - camera.world_from_camera[:, 3:], axis=0), 0.01)
    points = studio.probe("ShaderNodeNewGeometry", "Position").transpose(2, 0, 1).reshape(3, -1)
    if rays.index is not None:
        points = points[:, rays.index]
    wall = np.min(np.where(rays.direction > 0, 20.0 - 10.0, -10.0) / rays.direction, axis=0)
    sure = np.abs(wall - 12.0) > 1e-3
    assert np.array_equal(np.isnan(points[0])[sure], (wall > 12.0)[sure])


def test_the_lens_blurs_as_cycles_does(studio, seed, kind):
    """A bright square out of focus.

    It shows the image of the lens, which a wrong axis would turn or mirror.
    """
    corners = [(0.75, 0.45, -4), (0.6, 0.45, -4), (0.6, 0.6, -4), (0.75, 0.6, -4)]
    square = studio.mesh("square", corners, [(0, 1, 2, 3)])
    square.materials.append(studio.probe_material("ShaderNodeNewGeometry", "Position", offset=1000.0))
    studio.add("square", square)
    data = studio.camera.data
    data.type, data.panorama_type = "PANO", kind
    data.dof.aperture_blades, data.dof.aperture_rotation, data.dof.aperture_ratio = 3, 0.4, 1.4
    crop_to(studio, np.array([[0.675], [0.525], [-4.0]]))
    data.dof.use_dof, data.dof.aperture_fstop, data.dof.focus_distance = True, 0.125, 1.5
    exported = studio.export()
    reference = ReferenceRenderer(exported, Options(seed=seed)).render(0, 512).radiance[..., 0]
    cycles = studio.cycles(1024)[..., 0]
    assert reference.shape == cycles.shape
    assert reference.sum() == pytest.approx(cycles.sum(), rel=0.05)
    apart, mirrored = (np.abs(image - cycles).sum() / cycles.sum() for image in (reference, reference[::-1]))
    assert apart < 0.2
    assert mirrored > 2.0 * apart


def crop_to(studio, target):
    """Render only the part of the image near `target` (3, 1), in camera space.

    It lies within 0.15 radians about it, on 24 pixels or so.
    """
    render = studio.scene.render
    render.resolution_x = render.resolution_y = 200
    camera = studio.export().camera
    x, y = (k.ravel() for k in np.meshgrid(np.arange(200) + 0.5, np.arange(200) + 0.5))
    rays = camera_rays(camera, x, y, None)
    near = (rays.direction * target).sum(axis=0) > np.cos(0.15) * np.linalg.norm(target)
    index = np.flatnonzero(near) if rays.index is None else rays.index[near]
    x, y = x[index] / 200, y[index] / 200
    render.resolution_x = render.resolution_y = int(24 / max(np.ptp(x), np.ptp(y)))
    render.use_border = render.use_crop_to_border = True
    render.border_min_x, render.border_max_x = x.min(), x.max()
    render.border_min_y, render.border_max_y = y.min(), y.max()
