# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera: where rays begin and go, the lens, and the clip planes.

Also which way up the image is.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.scene.camera import Aperture
from etalon.lib.wavefront.camera_rays import camera_rays
from etalon.tests.replicates import assert_mean, replicates
from etalon.tests.scenes import emission, orthographic, perspective, quad, scene
from scipy import stats

LEVEL = 1e-4
LENS = Aperture(radius=0.2, blades=0, rotation=0.0, ratio=1.0, focus_distance=3.0)
POSITION, FORWARD = (1.0, -2.0, 0.5), (0.3, 1.0, -0.2)


def make(kind, aperture=None):
    make_camera = perspective if kind == "PERSPECTIVE" else orthographic
    return make_camera(8, 6, 0.7, POSITION, FORWARD, aperture)


def in_camera(camera, points):
    """World points (3, n) in camera space."""
    return camera.world_from_camera[:, :3].T @ (points - camera.world_from_camera[:, 3:])


KINDS = pytest.mark.parametrize("kind", ["PERSPECTIVE", "ORTHOGRAPHIC"])


@KINDS
def test_pinhole(kind, rng):
    """A ray meets the plane at depth d where the affine map says, and is a unit vector."""
    camera = make(kind)
    x, y = rng.uniform(0.0, 8.0, 200), rng.uniform(0.0, 6.0, 200)
    rays = camera_rays(camera, x, y, None)
    np.testing.assert_allclose((rays.direction**2).sum(axis=0), 1.0, rtol=1e-14)
    plane = camera.plane_from_raster @ np.stack([x, y, np.ones(200)])
    origin, direction = in_camera(camera, rays.origin), camera.world_from_camera[:, :3].T @ rays.direction
    at = origin + direction * ((-2.0 - origin[2]) / direction[2])
    np.testing.assert_allclose(at[:2], plane * (2.0 if kind == "PERSPECTIVE" else 1.0), atol=1e-12)
    assert (direction[2] < 0.0).all()


@KINDS
def test_clip_planes_are_depths(kind, rng):
    """Origins lie at depth clip_start.

    `reach` ends at depth clip_end, also towards the corners.
    """
    camera = replace(make(kind), clip_start=0.4, clip_end=7.0)
    rays = camera_rays(camera, rng.uniform(0.0, 8.0, 100), rng.uniform(0.0, 6.0, 100), None)
    np.testing.assert_allclose(in_camera(camera, rays.origin)[2], -0.4, rtol=1e-12)
    np.testing.assert_allclose(in_camera(camera, rays.origin + rays.direction * rays.reach)[2], -7.0, rtol=1e-12)


@KINDS
def test_what_is_clipped_is_not_seen(kind, seed):
    """A wall before the near plane or beyond the far plane leaves the sky.

    Between them it is seen.
    """
    for start, end, seen in ((0.0, 10.0, True), (0.0, 1.9, False), (2.1, 10.0, False)):
        camera = (
            perspective(4, 4, 0.5, (0.0, 0.0, 2.0))
            if kind == "PERSPECTIVE"
            else orthographic(4, 4, 1.0, (0.0, 0.0, 2.0))
        )
        wall = quad((-9.0, -9.0, 0.0), (18.0, 0.0, 0.0), (0.0, 18.0, 0.0))
        camera = replace(camera, clip_start=start, clip_end=end)
        images = replicates(scene(wall, emission(3.0), camera, world=0.5), 1, 4, seed=seed)
        np.testing.assert_allclose(images, 3.0 if seen else 0.5, rtol=1e-12)


def test_row_0_is_on_top_and_column_0_on_the_left(seed):
    """A red patch up left, a green one down right."""
    parts = [
        quad((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0),
        quad((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 1),
    ]
    image = replicates(
        scene(parts, [emission(1.0, 0.0, 0.0), emission(0.0, 1.0, 0.0)], orthographic(2, 2, 2.0, (0.0, 0.0, 1.0))),
        1,
        16,
        seed=seed,
    )[0]
    np.testing.assert_allclose(image[0, 0], [1.0, 0.0, 0.0])
    np.testing.assert_allclose(image[1, 1], [0.0, 1.0, 0.0])
    assert not image[0, 1].any()
    assert not image[1, 0].any()


def test_pixels_are_boxes(seed):
    """A pixel is the mean over its own square: an edge a third of the way through it."""
    patch = quad((-9.0, -9.0, 0.0), (9.0 + 1.0 / 3.0, 0.0, 0.0), (0.0, 18.0, 0.0))
    image = replicates(scene(patch, emission(1.0), orthographic(4, 2, 4.0, (0.0, 0.0, 1.0))), 20, 256, seed=seed)
    # float32 in the ray query resolves some 1e-6 of the scene.
    assert_mean(image, np.array([1.0, 1.0, 1.0 / 3.0, 0.0])[None, :, None], 1e-3, rounding=1e-5)


@KINDS
@pytest.mark.parametrize("blades", [0, 3, 6])
def test_lens_rays_meet_in_the_plane_of_focus(kind, blades, rng):
    camera = make(kind, replace(LENS, blades=blades, rotation=0.3, ratio=1.5))
    x, y = np.full(500, 2.3), np.full(500, 4.1)
    rays = camera_rays(camera, x, y, tuple(rng.random((2, 500))))
    origin, direction = in_camera(camera, rays.origin), camera.world_from_camera[:, :3].T @ rays.direction
    np.testing.assert_allclose((direction**2).sum(axis=0), 1.0, rtol=1e-13)
    focus = origin + direction * ((-3.0 - origin[2]) / direction[2])
    sharp = camera_rays(replace(camera, aperture=None), x, y, None)
    sharp_direction = camera.world_from_camera[:, :3].T @ sharp.direction
    sharp_origin = in_camera(camera, sharp.origin)
    exact = sharp_origin + sharp_direction * ((-3.0 - sharp_origin[2]) / sharp_direction[2])
    np.testing.assert_allclose(focus, exact, atol=1e-12)


@KINDS
@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_moments_of_the_lens(kind, ratio, rng):
    """Uniform on a disk of radius R, squeezed in x.

    E x^2 = (R / ratio)^2 / 4, E y^2 = R^2 / 4, E xy = 0.
    """
    camera = make(kind, replace(LENS, ratio=ratio))
    count = 200_000
    rays = camera_rays(camera, np.full(count, 4.0), np.full(count, 3.0), tuple(rng.random((2, count))))
    x, y, _ = in_camera(camera, rays.origin)
    if kind == "ORTHOGRAPHIC":
        plane = camera.plane_from_raster @ [4.0, 3.0, 1.0]
        x, y = x - plane[0], y - plane[1]
    assert np.hypot(x * ratio, y).max() <= 0.2 + 1e-12
    for values, exact in ((x, 0.0), (y, 0.0), (x * x, (0.2 / ratio) ** 2 / 4.0), (y * y, 0.01), (x * y, 0.0)):
        assert abs(values.mean() - exact) < stats.norm.isf(0.5 * LEVEL / 5) * stats.sem(values)
    assert stats.kstest((x * ratio) ** 2 + y * y, "uniform", (0.0, 0.04)).pvalue > LEVEL


def test_blades_have_their_corners_where_blender_has_them(rng):
    """Vertices at rotation + (2 k + 1) pi / n from +x.

    The farthest points of the lens lie there.
    """
    blades, rotation = 5, 0.2
    camera = make("PERSPECTIVE", replace(LENS, blades=blades, rotation=rotation))
    count = 100_000
    rays = camera_rays(camera, np.full(count, 4.0), np.full(count, 3.0), tuple(rng.random((2, count))))
    x, y, _ = in_camera(camera, rays.origin) / 0.2
    angle = np.arctan2(y, x)[np.hypot(x, y) > 0.97]
    corner = (angle - rotation) / (np.pi / blades)
    distance = np.abs((corner - 1.0) / 2.0 - np.round((corner - 1.0) / 2.0))
    assert angle.size > 50
    assert distance.max() < 0.1
    # Uniform on the polygon: its second moment is (2 + cos(2 pi / n)) / 12 a direction, for circumradius 1.
    for values in (x * x, y * y):
        exact = (2.0 + np.cos(2.0 * np.pi / blades)) / 12.0
        assert abs(values.mean() - exact) < stats.norm.isf(0.25 * LEVEL) * stats.sem(values)


@KINDS
@pytest.mark.parametrize("depth", [2.0, 3.0])
def test_circle_of_confusion_rendered(kind, depth, seed):
    """A small patch at `depth` is smeared over a disk of radius R |f - d| / d.

    It is R |f - d| / f for orthographic cameras, measured in the plane of focus (perspective: seen from the pinhole).
    Tested are the total light and second moments of the image.
    """
    size, half = 0.07, 0.6
    if kind == "PERSPECTIVE":
        camera = perspective(60, 60, half / LENS.focus_distance, (0.0, 0.0, 0.0), aperture=LENS)
        scale = LENS.focus_distance / depth
        blur = LENS.radius * abs(LENS.focus_distance - depth) / depth
        spread = (size * scale) ** 2 / 12.0
        light = (size * scale) ** 2
    else:
        camera = orthographic(60, 60, 2.0 * half, (0.0, 0.0, 0.0), aperture=LENS)
        blur = LENS.radius * abs(LENS.focus_distance - depth) / LENS.focus_distance
        spread, light = size**2 / 12.0, size**2
    patch = quad((-size / 2, -size / 2, -depth), (size, 0.0, 0.0), (0.0, size, 0.0))
    step = 2.0 * half / 60
    at = (np.arange(60) + 0.5) * step - half
    images = replicates(scene(patch, emission(1.0), camera), 12, 32, seed=seed)[..., 0] * step * step / light
    total = images.sum(axis=(1, 2))
    second = (images.sum(axis=1) * at**2).sum(axis=1), (images.sum(axis=2) * at**2).sum(axis=1)
    assert_mean(total[:, None], 1.0, 0.03)
    for moment in second:  # Sheppard: a pixel adds its own variance, where the image is wide beside it
        assert_mean(moment[:, None], blur**2 / 4.0 + spread + step**2 / 12.0, 0.05, rounding=1e-3 if blur else 0.1)
