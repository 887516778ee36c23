# SPDX-License-Identifier: GPL-3.0-or-later
"""The camera, reduced to one affine map from the raster to the camera plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Aperture:
    """The lens for depth of field: `radius` in metres, `blades` 0 for a disk, `rotation` in radians.

    A lens point is drawn on the unit disk or on the regular polygon of circumradius 1, its x divided by `ratio`, then scaled
    by `radius`. The plane in focus lies at depth `focus_distance` along the view axis.
    """

    radius: float
    blades: int
    rotation: float
    ratio: float
    focus_distance: float


@dataclass(frozen=True)
class Camera:
    """A pinhole, thin-lens or orthographic camera for a raster of `width` x `height` pixels.

    Raster coordinates are x to the right and y up, in pixels, from the bottom left corner of the rendered region
    (a border crop is folded in). `plane_from_raster` (2, 3) maps (x, y, 1) to the camera plane: for 'PERSPECTIVE' the point at
    depth 1, so that the direction in camera space is (px, py, -1); for 'ORTHOGRAPHIC' metres, so that the origin is
    (px, py, 0) and the direction (0, 0, -1). `world_from_camera` (3, 4) is a rotation and a translation. The clip planes
    are depths along the view axis and count for camera rays only.
    """

    kind: str
    width: int
    height: int
    plane_from_raster: np.ndarray
    world_from_camera: np.ndarray
    clip_start: float
    clip_end: float
    aperture: Aperture | None = None
