# SPDX-License-Identifier: GPL-3.0-or-later
"""Panoramic cameras: from the camera plane to directions.

In camera space x is right, y up and -z forward.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..scene.camera import Camera
from ..vectors import cross, normalize

Seen = np.ndarray | bool
"""Where the camera sees anything at all, (n,) bool, or True for everywhere."""


def panorama_directions(camera: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, Seen]:
    """Unit directions (3, n) for points (x, y) of the camera plane, and where it sees.

    Elsewhere the directions mean nothing.
    """
    return _DIRECTIONS[camera.kind](camera, x, y)


def across(camera: Camera, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The two unit axes of the lens across each direction, (3, n).

    As in Cycles, the first is as close as possible to the view axis.
    For a mirror ball it is the axis to the right, and the second is mirrored.
    """
    is_ball = camera.kind == "MIRRORBALL"
    axis = np.array([[1.0], [0.0], [0.0]] if is_ball else [[0.0], [0.0], [-1.0]])
    first = normalize(axis - (axis * direction).sum(axis=0) * direction)
    second = cross(direction, first)
    return first, -second if is_ball else second


def _equirectangular(_: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, Seen]:
    level = np.cos(y)
    return np.stack([np.sin(x) * level, np.sin(y), -np.cos(x) * level]), True


def _central_cylindrical(_: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, Seen]:
    return normalize(np.stack([np.sin(x), y, -np.cos(x)])), True


def _equiangular_face(_: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, Seen]:
    return normalize(np.stack([np.tan(x), np.tan(y), np.full_like(x, -1.0)])), True


def _mirror_ball(_: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, Seen]:
    """The ball that reflects a viewer ahead of it: the axis mirrored at its normal (x, y, -z)."""
    square = x * x + y * y
    z = np.sqrt(np.maximum(1.0 - square, 0.0))
    return np.stack([2.0 * z * x, 2.0 * z * y, 1.0 - 2.0 * z * z]), square <= 1.0


def _fisheye(angle: Callable[[Camera, np.ndarray], np.ndarray]) -> Callable:
    """A fisheye that sees under the `angle` to the axis at a distance from the plane's centre."""

    def directions(camera: Camera, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, Seen]:
        radius = np.hypot(x, y)
        theta = angle(camera, radius)
        sine = np.sin(theta) / np.where(radius > 0.0, radius, 1.0)
        return np.stack([sine * x, sine * y, -np.cos(theta)]), np.abs(theta) <= 0.5 * camera.field_of_view

    return directions


def _polynomial(camera: Camera, radius: np.ndarray) -> np.ndarray:
    return np.polynomial.polynomial.polyval(radius, camera.polynomial)


def _equisolid(_: Camera, radius: np.ndarray) -> np.ndarray:
    # Beyond the whole sphere there is no angle; 2 pi is more than any field of view's half.
    return np.where(radius <= 2.0, 2.0 * np.arcsin(np.minimum(0.5 * radius, 1.0)), 2.0 * np.pi)


_DIRECTIONS = {
    "EQUIRECTANGULAR": _equirectangular,
    "CENTRAL_CYLINDRICAL": _central_cylindrical,
    "EQUIANGULAR_CUBEMAP_FACE": _equiangular_face,
    "MIRRORBALL": _mirror_ball,
    "FISHEYE_EQUIDISTANT": _fisheye(lambda _, radius: radius),
    "FISHEYE_EQUISOLID": _fisheye(_equisolid),
    "FISHEYE_LENS_POLYNOMIAL": _fisheye(_polynomial),
}
