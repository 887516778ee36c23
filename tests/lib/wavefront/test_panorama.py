# SPDX-License-Identifier: GPL-3.0-or-later
"""Panoramic cameras: each projection by what defines it.

Also the lens, and what a lens does not see.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.scene.camera import PANORAMAS, Aperture, Camera
from etalon.lib.wavefront.camera_rays import camera_rays
from etalon.tests.replicates import replicates
from etalon.tests.scenes import emission, floor, perspective, scene

POLYNOMIAL = (1e-3, 0.9, -0.05, 0.02, 0.01)
WORLD = perspective(8, 8, 0.7, (1.0, -2.0, 0.5), (0.3, 1.0, -0.2)).world_from_camera
KINDS = pytest.mark.parametrize("kind", PANORAMAS)
FISHEYES = [kind for kind in PANORAMAS if kind.startswith("FISHEYE")]


def make(kind, half=0.9, **fields):
    """A camera of 8 x 8 pixels over the plane from -half to half."""
    plane = np.array([[half / 4.0, 0.0, -half], [0.0, half / 4.0, -half]])
    polynomial = POLYNOMIAL if kind == "FISHEYE_LENS_POLYNOMIAL" else ()
    return replace(Camera(kind, 8, 8, plane, WORLD, 0.0, 1e6, polynomial=polynomial), **fields)


def seen(camera, rng, count=400):
    """Points of the camera plane (2, k) and unit directions of camera space (3, k).

    They belong to random rays.
    """
    raster = rng.uniform(0.0, 8.0, (2, count))
    rays = camera_rays(camera, *raster, None)
    if rays.index is not None:
        raster = raster[:, rays.index]
    plane = camera.plane_from_raster @ np.stack([*raster, np.ones(raster.shape[1])])
    direction = camera.world_from_camera[:, :3].T @ rays.direction
    np.testing.assert_allclose((direction**2).sum(axis=0), 1.0, rtol=1e-13)
    np.testing.assert_allclose(rays.origin - camera.world_from_camera[:, 3:], 0.0, atol=1e-15)
    return plane, direction


def test_equirectangular_planes_are_longitude_and_latitude(rng):
    (x, y), direction = seen(make("EQUIRECTANGULAR", 1.5), rng)
    np.testing.assert_allclose(np.arctan2(direction[0], -direction[2]), x, atol=1e-13)
    np.testing.assert_allclose(np.arcsin(direction[1]), y, atol=1e-13)


def test_a_central_cylinder_is_met_where_the_plane_says(rng):
    (x, y), direction = seen(make("CENTRAL_CYLINDRICAL", 3.0), rng)
    on_cylinder = direction / np.hypot(direction[0], direction[2])
    np.testing.assert_allclose(on_cylinder, [np.sin(x), y, -np.cos(x)], atol=1e-13)


def test_a_face_of_an_equiangular_cube_has_equal_angles(rng):
    (x, y), direction = seen(make("EQUIANGULAR_CUBEMAP_FACE", np.pi / 4.0), rng)
    np.testing.assert_allclose(np.arctan2(direction[0], -direction[2]), x, atol=1e-14)
    np.testing.assert_allclose(np.arctan2(direction[1], -direction[2]), y, atol=1e-14)


def test_a_mirror_ball_reflects(rng):
    """The half vector between the direction and the one back along the axis is the normal.

    It is the ball's normal; the rim sees what is behind.
    """
    (x, y), direction = seen(make("MIRRORBALL", 1.0), rng)
    half = np.array([[0.0], [0.0], [-1.0]]) + direction
    half /= np.linalg.norm(half, axis=0)
    np.testing.assert_allclose(half[:2], [x, y], atol=1e-12)
    assert (x * x + y * y <= 1.0).all()
    assert direction[2].max() > 0.8


@pytest.mark.parametrize("kind", FISHEYES)
def test_fisheyes_keep_the_azimuth_and_their_own_law(kind, rng):
    (x, y), direction = seen(make(kind), rng)
    theta = np.arctan2(np.hypot(direction[0], direction[1]), -direction[2])
    np.testing.assert_allclose(np.arctan2(direction[1], direction[0]), np.arctan2(y, x), atol=1e-12)
    radius = np.hypot(x, y)
    if kind == "FISHEYE_EQUIDISTANT":
        np.testing.assert_allclose(theta, radius, atol=1e-13)
    elif kind == "FISHEYE_EQUISOLID":  # the cone's solid angle is the disk's area
        np.testing.assert_allclose(2.0 * np.pi * (1.0 - np.cos(theta)), np.pi * radius**2, atol=1e-13)
    else:
        law = sum(c * radius**k for k, c in enumerate(POLYNOMIAL))
        np.testing.assert_allclose(theta, law, atol=1e-13)


@pytest.mark.parametrize("kind", FISHEYES)
def test_a_fisheye_ends_at_its_field_of_view(kind, rng):
    camera = make(kind, 2.5, field_of_view=2.0)
    _, direction = seen(camera, rng)
    theta = np.arccos(-direction[2])
    assert 0.9 < theta.max() <= 1.0
    assert direction.shape[1] < 400


@KINDS
def test_clip_distances_count_along_the_ray(kind, rng):
    camera = make(kind, 0.6, clip_start=0.4, clip_end=7.0)
    rays = camera_rays(camera, *rng.uniform(2.0, 6.0, (2, 50)), None)
    np.testing.assert_allclose(rays.origin - camera.world_from_camera[:, 3:], 0.4 * rays.direction, atol=1e-14)
    np.testing.assert_allclose(rays.reach, 6.6, rtol=1e-14)


@KINDS
def test_lens_rays_meet_the_sharp_ray_on_the_sphere_of_focus(kind, rng):
    """They start across the sharp ray, within the lens, and all meet at the distance of focus."""
    lens = Aperture(radius=0.2, blades=0, rotation=0.0, ratio=1.5, focus_distance=3.0)
    camera = make(kind, 0.6, aperture=lens)
    raster = rng.uniform(2.0, 6.0, (2, 300))
    sharp = camera_rays(camera, *raster, None)
    rays = camera_rays(camera, *raster, tuple(rng.random((2, 300))))
    offset = rays.origin - camera.world_from_camera[:, 3:]
    np.testing.assert_allclose((offset * sharp.direction).sum(axis=0), 0.0, atol=1e-14)
    assert np.linalg.norm(offset, axis=0).max() <= 0.2
    to = 3.0 * sharp.direction - offset
    np.testing.assert_allclose(np.cross(to, rays.direction, axis=0), 0.0, atol=1e-14)
    assert ((to * rays.direction).sum(axis=0) > 0.0).all()


def test_outside_its_circle_a_lens_is_black(seed):
    """Pixels that the circle leaves out see nothing, the sky neither.

    Those it cuts, in proportion: pi / 4 of the square.
    """
    camera = make("FISHEYE_EQUIDISTANT", 1.0, field_of_view=2.0)
    image = replicates(scene(floor(height=-50.0), emission(1.0), camera, world=1.0), 1, 4096, seed=seed)[0]
    assert image.mean() == pytest.approx(np.pi / 4.0, abs=2e-3)
    assert (image[3:5, 3:5] == 1.0).all()
    assert image[0, 0].max() < 0.05
