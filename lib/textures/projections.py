# SPDX-License-Identifier: GPL-3.0-or-later
"""Projections of images: where a point or a direction lies in an image.

The result is (u, v) with (0, 0) at the lower left corner.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

Place = tuple[np.ndarray, np.ndarray]


def sphere(point: np.ndarray) -> Place:
    """(u, v) of points (3, n): longitude and latitude around the centre (1/2, 1/2, 1/2).

    u is 1/2 towards +y and grows towards -x; v is 0 at the lower pole and 1 at the upper one. u is 0 on the axis, and the centre
    itself is at (0, 0), as in Blender.
    """
    x, y, z = point - 0.5
    level = np.hypot(x, y)
    u = np.where(level > 0.0, 0.5 - np.arctan2(x, y) / (2.0 * np.pi), 0.0)
    v = 0.5 + np.arctan2(z, level) / np.pi
    return u, np.where((level > 0.0) | (z != 0.0), v, 0.0)


def tube(point: np.ndarray) -> Place:
    """Return (u, v) of points (3, n): longitude around the vertical axis, and the height z.

    The axis goes through (1/2, 1/2).

    u is 1/2 towards +y and grows towards -x. The axis itself is at (0, 0), as in Blender.
    """
    x, y = point[0] - 0.5, point[1] - 0.5
    off_axis = (x != 0.0) | (y != 0.0)
    return np.where(off_axis, 0.5 - np.arctan2(x, y) / (2.0 * np.pi), 0.0), np.where(off_axis, point[2], 0.0)


def mirror_ball(direction: np.ndarray) -> Place:
    """Return (u, v) of directions (3, n), of any length, on a mirror ball.

    The ball mirrors them to a viewer far away at -y.

    The ball's normal is half way between the direction and the one to the viewer. +y, behind the ball, has no single
    place; it is put at the middle, as in Blender.
    """
    x, y, z = direction
    length = np.sqrt(x * x + y * y + z * z)
    # sqrt(2 |d| (|d| - y)), which is twice the length times the sine of half the angle to +y.
    level = np.hypot(x, z)
    gap = np.where(y > 0.0, level * level / np.where(length + y > 0.0, length + y, 1.0), length - y)
    scale = np.sqrt(2.0 * length * gap)
    scale = np.where(scale > 0.0, scale, 1.0)
    return 0.5 + 0.5 * x / scale, 0.5 + 0.5 * z / scale


def box_faces(point: np.ndarray, normal: np.ndarray) -> Iterator[Place]:
    """Return (u, v) of points (3, n) on the faces of a box across x, y and z.

    `normal` (3, n) tells the two faces of a pair apart.

    The images of opposite faces are mirrored, so that each is seen the right way round from outside.
    """
    x, y, z = point
    yield np.where(normal[0] < 0.0, 1.0 - y, y), z
    yield np.where(normal[1] > 0.0, 1.0 - x, x), z
    yield np.where(normal[2] > 0.0, 1.0 - y, y), x


def box_weights(normal: np.ndarray, blend: float) -> np.ndarray:
    """Return weights (3, n) of a box's faces across x, y and z, of sum 1.

    They are for normals (3, n) and a width of the blend in 0..1.

    With a = |n| and the share s_ij = a_i / (a_i + a_j), face i counts alone where s_ij > (1 + blend) / 2 for both
    others. Between two faces the share grows linearly from (1 - blend) / 2 to (1 + blend) / 2. Where three meet, the
    weights are linear in a / sum(a). A normal with no choice, on an edge without a blend, belongs to x: so Blender.
    """
    a = np.abs(normal) / np.abs(normal).sum(axis=0)
    limit = 0.5 * (1.0 + blend)
    weights = np.zeros_like(a)
    left = np.ones(a.shape[1], bool)
    for i, j, k in ((0, 1, 2), (1, 0, 2), (2, 0, 1)):
        alone = left & (a[i] > limit * (a[i] + a[j])) & (a[i] > limit * (a[i] + a[k]))
        weights[i, alone] = 1.0
        left &= ~alone
    if blend <= 0.0:
        weights[0, left] = 1.0
        return weights
    for i, j, k in ((0, 1, 2), (1, 2, 0), (0, 2, 1)):
        pair = left & (a[k] < (1.0 - limit) * (a[i] + a[j]))
        share = a[i, pair] / (a[i, pair] + a[j, pair])
        weights[i, pair] = np.clip((share - 0.5 * (1.0 - blend)) / blend, 0.0, 1.0)
        weights[j, pair] = 1.0 - weights[i, pair]
        left &= ~pair
    weights[:, left] = ((2.0 - limit) * a[:, left] + (limit - 1.0)) / (2.0 * limit - 1.0)
    return weights
