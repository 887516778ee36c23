# SPDX-License-Identifier: GPL-3.0-or-later
"""Skies: where a direction lies in the table of a sky, and the disc of a sun."""

from __future__ import annotations

import math

import numpy as np

from ..scene.sky import Sky, SunDisc
from ..vectors import dot
from .context import InputEvaluator
from .images import ImageSet


def place_in_table(direction: np.ndarray, azimuth: float) -> tuple[np.ndarray, np.ndarray]:
    """Return (u, v) of directions (3, n) in the table of a sky.

    u and v are (n,) in 0..1; v counts from the bottom.
    """
    x, y, z = direction
    u = 0.5 - (np.arctan2(y, x) - azimuth) / (2.0 * np.pi)
    elevation = np.arcsin(np.clip(z, -1.0, 1.0))
    return u - np.floor(u), 0.5 + np.copysign(np.sqrt(np.abs(elevation) / (2.0 * np.pi)), elevation)


def table_directions(width: int, height: int, azimuth: float) -> np.ndarray:
    """Return unit vectors (height, width, 3) at the texels' centres of a sky's table.

    Row 0 is at the bottom.
    """
    angle = azimuth + 2.0 * np.pi * (0.5 - (np.arange(width) + 0.5) / width)
    root = 2.0 * (np.arange(height) + 0.5) / height - 1.0
    elevation = np.copysign(0.5 * np.pi * root**2, root)[:, None]
    return np.stack(
        np.broadcast_arrays(np.cos(elevation) * np.cos(angle), np.cos(elevation) * np.sin(angle), np.sin(elevation)),
        axis=2,
    )


def toward(elevation: float, azimuth: float) -> tuple[float, float, float]:
    """The unit vector at an elevation and an azimuth, radians."""
    level = math.cos(elevation)
    return level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation)


def limb_darkening(share: np.ndarray | float) -> np.ndarray | float:
    """The radiance of a sun at a share of its radius over that of its centre."""
    return 1.0 - 0.6 * (1.0 - np.sqrt(1.0 - np.square(share)))


def sky(node: Sky, read: InputEvaluator) -> np.ndarray:
    """Radiance (3, n) of a sky."""
    direction = read(node.vector)
    color = read.images.sample(node.image, *place_in_table(direction, node.azimuth), extension="EXTEND")[:3]
    if node.sun is not None:
        _add_sun(color, node.sun, node.azimuth, direction, read.images)
    return color


def _add_sun(color: np.ndarray, sun: SunDisc, azimuth: float, direction: np.ndarray, images: ImageSet) -> None:
    """Add the disc to `color` (3, n), or put it there."""
    center = np.array(toward(sun.elevation, azimuth))[:, None]
    apart, together = direction - center, direction + center
    # The tangent of half the angle between two vectors of one length, which keeps the digits of a small angle.
    square = dot(apart, apart) / dot(together, together)
    inside = np.flatnonzero(square < math.tan(0.25 * sun.diameter) ** 2)
    share = 2.0 * np.arctan(np.sqrt(square[inside])) / (0.5 * sun.diameter)
    rise = np.arcsin(np.clip(direction[2, inside], -1.0, 1.0)) - sun.elevation
    # From edge to edge is half the way through an image of two texels.
    disc = images.sample(sun.image, np.full(inside.size, 0.5), 0.5 + 0.5 * rise / sun.diameter, extension="EXTEND")[:3]
    disc *= limb_darkening(np.minimum(share, 1.0))
    if not sun.covers:
        disc += color[:, inside]
    color[:, inside] = np.maximum(disc, 0.0)  # a setting sun's blue is out of gamut
