# SPDX-License-Identifier: GPL-3.0-or-later
"""Warps of the unit square; each with the density it produces."""

from __future__ import annotations

import numpy as np


def circle(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cosine and sine of 2 pi u, for `u` in [0, 1].

    By t = tan(pi u), the tangent of the half angle: one tangent costs a fifth of a sine and a cosine, and a small u keeps
    the digits of its sine.
    """
    t = np.tan(np.pi * u)
    square = t * t
    scale = 1.0 / (1.0 + square)
    return (1.0 - square) * scale, t * scale * 2.0


def uniform_disk(u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Point of the unit disk, density 1 / pi: angle from u1, radius sqrt(u2)."""
    x, y = circle(u1)
    radius = np.sqrt(u2)
    return x * radius, y * radius


def cosine_hemisphere(u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """Return a direction (3, n) with density cos(theta) / pi.

    phi = 2 pi u1, theta = acos(sqrt(1 - u2)) (documents, example 1).
    """
    direction = np.empty((3, u1.shape[0]))
    x, y = circle(u1)
    radius = np.sqrt(u2)
    np.multiply(x, radius, out=direction[0])
    np.multiply(y, radius, out=direction[1])
    np.sqrt(1.0 - u2, out=direction[2])
    return direction


def concentric_disk(u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return uniform points x, y of the unit disk, onto which squares about the centre of (u1, u2) become circles.

    Shirley and Chiu 1997.
    """
    a, b = 2.0 * u1 - 1.0, 2.0 * u2 - 1.0
    wide = a * a > b * b
    radius, other = np.where(wide, a, b), np.where(wide, b, a)
    turn = 0.25 * np.pi * np.divide(other, radius, out=np.zeros_like(radius), where=radius != 0.0)
    near, far = radius * np.cos(turn), radius * np.sin(turn)
    return np.where(wide, near, far), np.where(wide, far, near)


def uniform_hemisphere(u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """Direction with density 1 / (2 pi), (3, n): phi = 2 pi u1, cos(theta) = 1 - u2."""
    direction = np.empty((3, u1.shape[0]))
    x, y = circle(u1)
    radius = np.sqrt(u2 * (2.0 - u2))
    np.multiply(x, radius, out=direction[0])
    np.multiply(y, radius, out=direction[1])
    np.subtract(1.0, u2, out=direction[2])
    return direction


def uniform_sphere(u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """Direction with density 1 / (4 pi), (3, n): phi = 2 pi u1, cos(theta) = 1 - 2 u2."""
    x, y = circle(u1)
    radius = 2.0 * np.sqrt(u2 * (1.0 - u2))
    return np.stack([x * radius, y * radius, 1.0 - 2.0 * u2])


def regular_polygon(u1: np.ndarray, u2: np.ndarray, sides: int, rotation: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a point that is uniform on a regular polygon of circumradius 1.

    Its vertices are at rotation + (2 k + 1) pi / sides.

    u1 picks the triangle (and is stretched again), the square root warp fills it.
    """
    scaled = u1 * sides
    side = np.minimum(np.floor(scaled), sides - 1)
    inner = scaled - side
    root = np.sqrt(u2)
    towards_first, towards_second = root * (1.0 - inner), root * inner
    angle = rotation + (2.0 * np.arange(sides + 1) - 1.0) * (np.pi / sides)
    corner_x, corner_y = np.cos(angle), np.sin(angle)
    first = side.astype(np.intp)
    x = towards_first * np.take(corner_x, first) + towards_second * np.take(corner_x, first + 1)
    y = towards_first * np.take(corner_y, first) + towards_second * np.take(corner_y, first + 1)
    return x, y
