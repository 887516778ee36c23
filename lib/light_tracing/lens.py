# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera's importance.

It is where the camera sees a point, and how much a pixel counts of the light that leaves the point towards the camera.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..lights.light import Pair
from ..scene.camera import Camera
from ..vectors import dot, to_local, to_world
from ..wavefront.camera_rays import lens_point


@dataclass(frozen=True)
class Sight:
    """How the camera sees points: `index` (n,) of those in the image.

    pixel (n,): the number of the pixel, row by row from the top. direction (3, n): unit vectors to the camera; reach (n,): distance to
    the near plane. importance (n,), m^-2: by what the radiance of a surface across the view, times its area, is multiplied in the pixel's mean.
    """

    index: np.ndarray
    pixel: np.ndarray
    direction: np.ndarray
    reach: np.ndarray
    importance: np.ndarray


def sight(camera: Camera, point: np.ndarray, lens: Pair | None) -> Sight:
    """See points (3, n) through a point of the lens, which two uniforms (n,) each choose.

    A pixel is the mean of the radiance over its square of the raster. By the change of variables from the raster to the surface its
    importance is 1 / (A cos^3 d^2) for a perspective camera and 1 / (A cos) for an orthographic one, with the area A of a pixel on the
    camera plane, the distance d from the lens and the cosine to the view axis (Veach 1997, chapters 4 and 8).
    """
    axes = camera.world_from_camera[:, :3].T
    seen = to_local(point - camera.world_from_camera[:, 3:], *axes)
    depth = -seen[2]
    ahead = (depth > camera.clip_start) & (depth < camera.clip_end)
    along = np.where(ahead, depth, 1.0)  # what is not ahead is left out below
    start = np.zeros_like(seen)
    focus = None
    if lens is not None and camera.aperture is not None:
        start[0], start[1] = lens_point(camera.aperture, *lens)
        focus = camera.aperture.focus_distance
    if camera.kind == "PERSPECTIVE":
        ray = (seen - start) / along
        plane = ray[:2].copy()
        if focus is not None:  # the pinhole's ray meets this one on the plane in focus
            plane += start[:2] / focus
    else:
        ray = np.zeros_like(seen)
        ray[2] = -1.0
        if focus is not None:
            ray[:2] = -start[:2] / focus
        plane = seen[:2] - start[:2] - ray[:2] * along
    secant2 = dot(ray, ray)  # the ray has depth 1
    matrix = camera.plane_from_raster
    area = abs(np.linalg.det(matrix[:, :2]))
    x, y = np.linalg.solve(matrix[:, :2], plane - matrix[:, 2:])
    column, row = np.floor(x), camera.height - 1.0 - np.floor(y)
    inside = ahead & (column >= 0.0) & (column < camera.width) & (row >= 0.0) & (row < camera.height)
    index = np.flatnonzero(inside)
    secant2, along, ray = secant2[index], along[index], np.take(ray, index, axis=1)
    secant = np.sqrt(secant2)
    # cos^-3 d^-2 with d = depth / cos is 1 / (cos depth^2).
    importance = secant / (area * along * along) if camera.kind == "PERSPECTIVE" else secant / area
    pixel = (row[index] * camera.width + column[index]).astype(np.intp)
    direction = to_world(-ray / secant, *axes)
    return Sight(index, pixel, direction, (along - camera.clip_start) * secant, importance)
