# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: camera rays through the raster."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..sampling.warps import regular_polygon, uniform_disk
from ..scene.camera import PANORAMAS, Aperture, Camera
from ..vectors import dot, normalize, to_world
from .panorama import across, panorama_directions


@dataclass(frozen=True)
class CameraRays:
    """Camera rays: origins at the near plane and unit directions, (3, n).

    `reach` (n,) is the distance to the far plane.
    `index` (n,) are the raster points that have a ray, ascending; None where all have one.
    """

    origin: np.ndarray
    direction: np.ndarray
    reach: np.ndarray
    index: np.ndarray | None = None


def camera_rays(camera: Camera, x: np.ndarray, y: np.ndarray, lens: tuple[np.ndarray, np.ndarray] | None) -> CameraRays:
    """Rays through raster points (x to the right, y up, in pixels).

    `lens` has two uniforms for a point of the lens, used if the camera has an aperture.
    """
    a = camera.plane_from_raster
    plane_x = a[0, 0] * x + a[0, 1] * y + a[0, 2]
    plane_y = a[1, 0] * x + a[1, 1] * y + a[1, 2]
    if camera.kind in PANORAMAS:
        return _panorama(camera, plane_x, plane_y, lens)
    zero, minus_one = np.zeros_like(plane_x), np.full_like(plane_x, -1.0)
    if camera.kind == "PERSPECTIVE":  # all rays through one point, unless a lens spreads them
        origin, direction = np.zeros((3, 1)), np.stack([plane_x, plane_y, minus_one])
    else:
        origin, direction = np.stack([plane_x, plane_y, zero]), np.stack([zero, zero, minus_one])
    if camera.aperture is not None and lens is not None:
        origin, direction = _through_lens(camera.aperture, origin, direction, *lens)
    depth = 1.0 / np.sqrt(dot(direction, direction))  # the direction has depth 1, so this is the cosine to the axis
    direction *= depth
    return _in_world(camera, origin, direction, camera.clip_start / depth, camera.clip_end / depth)


def pixel_cone(camera: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the radius (n,) of the cones of pixels where rays through raster points begin, in metres, and its growth per metre.

    The growth is the mean change of the pinhole's unit direction from one pixel to the next (kernel/camera/camera.h). For an
    orthographic camera it is 0, and the radius is the side of a pixel, which must be a square.
    """
    if camera.kind != "PERSPECTIVE":  # panoramas are refused
        return np.full(x.shape, abs(camera.plane_from_raster[0, 0])), np.zeros(x.shape)
    pinhole = replace(camera, aperture=None)
    here, across_, up = (camera_rays(pinhole, x + dx, y + dy, None) for dx, dy in ((0, 0), (1, 0), (0, 1)))
    dx, dy = across_.direction - here.direction, up.direction - here.direction
    spread = 0.5 * (np.sqrt(dot(dx, dx)) + np.sqrt(dot(dy, dy)))
    start = here.origin - camera.world_from_camera[:, 3:]
    return spread * np.sqrt(dot(start, start)), spread


def _in_world(
    camera: Camera,
    origin: np.ndarray,
    direction: np.ndarray,
    start: np.ndarray | float,
    end: np.ndarray | float,
    index: np.ndarray | None = None,
) -> CameraRays:
    """Rays of camera space that begin and end at the distances `start` and `end`."""
    axes, translation = camera.world_from_camera[:, :3].T, camera.world_from_camera[:, 3:]
    world_direction = to_world(direction, *axes)
    reach = np.broadcast_to(end - start, direction.shape[1:])
    return CameraRays(to_world(origin, *axes) + translation + world_direction * start, world_direction, reach, index)


def _panorama(
    camera: Camera, plane_x: np.ndarray, plane_y: np.ndarray, lens: tuple[np.ndarray, np.ndarray] | None
) -> CameraRays:
    direction, seen = panorama_directions(camera, plane_x, plane_y)
    index = None
    if not np.all(seen):
        index = np.flatnonzero(seen)
        direction = np.take(direction, index, axis=1)
        lens = None if lens is None else (lens[0][index], lens[1][index])
    origin = np.zeros_like(direction)
    if camera.aperture is not None and lens is not None:
        lens_x, lens_y = lens_point(camera.aperture, *lens)
        first, second = across(camera, direction)
        origin = first * lens_x + second * lens_y
        direction = normalize(direction * camera.aperture.focus_distance - origin)
    return _in_world(camera, origin, direction, camera.clip_start, camera.clip_end, index)


def lens_point(aperture: Aperture, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A point of the lens, in metres, (n,) each."""
    if aperture.blades >= 3:
        lens_x, lens_y = regular_polygon(u1, u2, aperture.blades, aperture.rotation)
    else:
        lens_x, lens_y = uniform_disk(u1, u2)
    return lens_x * (aperture.radius / aperture.ratio), lens_y * aperture.radius


def _through_lens(
    aperture: Aperture, origin: np.ndarray, direction: np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rays from a point of the lens to where the pinhole ray meets the plane in focus.

    Both are in camera space.
    """
    lens_x, lens_y = lens_point(aperture, u1, u2)
    offset = np.stack([lens_x, lens_y, np.zeros_like(lens_x)])
    focus = origin + direction * aperture.focus_distance
    start = origin + offset
    return start, (focus - start) / aperture.focus_distance
