# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera: one affine map from the raster to the camera plane.

Panoramas have a map from there to directions as well.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

PANORAMAS = (
    "EQUIRECTANGULAR",
    "CENTRAL_CYLINDRICAL",
    "EQUIANGULAR_CUBEMAP_FACE",
    "MIRRORBALL",
    "FISHEYE_EQUIDISTANT",
    "FISHEYE_EQUISOLID",
    "FISHEYE_LENS_POLYNOMIAL",
)


@dataclass(frozen=True)
class Aperture:
    """The lens for depth of field.

    `radius` in metres, `blades` 0 for a disk, `rotation` in radians.
    A lens point is drawn on the unit disk or on the regular polygon of circumradius 1, its x divided by `ratio`, then
    scaled by `radius`. The plane in focus lies at depth `focus_distance` along the view axis; for panoramas it is a
    sphere, and the lens lies across each ray.
    """

    radius: float
    blades: int
    rotation: float
    ratio: float
    focus_distance: float


@dataclass(frozen=True)
class Camera:
    """A pinhole, thin-lens, orthographic or panoramic camera.

    The raster has `width` x `height` pixels.
    Raster coordinates are x to the right and y up, in pixels, from the bottom left corner of the rendered region
    (a border crop is folded in). `plane_from_raster` (2, 3) maps (x, y, 1) to the camera plane (px, py). In camera
    space x is right, y up and -z forward. There the plane means, by `kind`:
    'PERSPECTIVE': the direction (px, py, -1). 'ORTHOGRAPHIC': metres, the origin (px, py, 0) and the direction
    (0, 0, -1).
    'EQUIRECTANGULAR': radians to the right and up. 'CENTRAL_CYLINDRICAL': radians to the right, and a slope.
    'EQUIANGULAR_CUBEMAP_FACE': the angles, in radians, of the direction's horizontal and vertical projections.
    'MIRRORBALL': a point of the unit disk, that is of a ball seen from afar. The fisheyes see under the angle theta to
    the axis
    'FISHEYE_EQUIDISTANT': theta = |p|; 'FISHEYE_EQUISOLID': 2 sin(theta / 2) = |p|; 'FISHEYE_LENS_POLYNOMIAL': the
    `polynomial` (ascending coefficients, radians) of |p|; beyond half the `field_of_view` (radians) they see nothing.
    `world_from_camera` (3, 4) is a rotation and a translation. The clip planes are depths along the view axis, for
    panoramas distances, and count for camera rays only.
    """

    kind: str
    width: int
    height: int
    plane_from_raster: np.ndarray
    world_from_camera: np.ndarray
    clip_start: float
    clip_end: float
    aperture: Aperture | None = None
    field_of_view: float = 2.0 * np.pi
    polynomial: tuple[float, ...] = ()


def smaller_camera(camera: Camera, width: int, height: int) -> Camera:
    """The camera with a raster of `width` x `height` pixels and the same view.

    Both divide its own.
    """
    plane = camera.plane_from_raster.copy()
    plane[:, 0] *= camera.width / width
    plane[:, 1] *= camera.height / height
    return replace(camera, width=width, height=height, plane_from_raster=plane)
