# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: camera rays through the raster."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..sampling.warps import regular_polygon, uniform_disk
from ..scene.camera import Aperture, Camera
from ..vectors import dot, to_world


@dataclass(frozen=True)
class CameraRays:
    """Origins at the near plane and unit directions, (3, n); `reach` (n,), the distance to the far plane."""

    origin: np.ndarray
    direction: np.ndarray
    reach: np.ndarray


def camera_rays(camera: Camera, x: np.ndarray, y: np.ndarray, lens: tuple[np.ndarray, np.ndarray] | None) -> CameraRays:
    """Rays through raster points (x to the right, y up, in pixels), with two uniforms for the lens if it has an aperture."""
    a = camera.plane_from_raster
    plane_x = a[0, 0] * x + a[0, 1] * y + a[0, 2]
    plane_y = a[1, 0] * x + a[1, 1] * y + a[1, 2]
    zero, minus_one = np.zeros_like(plane_x), np.full_like(plane_x, -1.0)
    if camera.kind == "PERSPECTIVE":
        origin, direction = np.stack([zero, zero, zero]), np.stack([plane_x, plane_y, minus_one])
    else:
        origin, direction = np.stack([plane_x, plane_y, zero]), np.stack([zero, zero, minus_one])
    if camera.aperture is not None and lens is not None:
        origin, direction = _through_lens(camera.aperture, origin, direction, *lens)
    depth = 1.0 / np.sqrt(dot(direction, direction))  # the direction has depth 1, so this is the cosine to the axis
    direction *= depth
    axes, translation = camera.world_from_camera[:, :3].T, camera.world_from_camera[:, 3:]
    start, end = camera.clip_start / depth, camera.clip_end / depth
    world_direction = to_world(direction, *axes)
    return CameraRays(to_world(origin, *axes) + translation + world_direction * start, world_direction, end - start)


def _through_lens(
    aperture: Aperture, origin: np.ndarray, direction: np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rays from a point of the lens to the pinhole ray's point on the plane in focus, in camera space."""
    if aperture.blades >= 3:
        lens_x, lens_y = regular_polygon(u1, u2, aperture.blades, aperture.rotation)
    else:
        lens_x, lens_y = uniform_disk(u1, u2)
    offset = np.stack([lens_x * (aperture.radius / aperture.ratio), lens_y * aperture.radius, np.zeros_like(lens_x)])
    focus = origin + direction * aperture.focus_distance
    start = origin + offset
    return start, (focus - start) / aperture.focus_distance
