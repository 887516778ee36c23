# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of triangles in a plane: whether they overlap, and by what area."""

from __future__ import annotations

import numpy as np


def overlap_in_plane(first: np.ndarray, second: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Indices of the pairs of triangles that overlap by more than `depth` (n,).

    The triangles (3 corners, 2, n) are counter-clockwise.
    Two convex shapes are apart if and only if the line through an edge of one of them separates them.
    """
    left = np.arange(first.shape[2])
    for number in range(6):
        one, other = (first, second) if number < 3 else (second, first)
        start, edge = one[number % 3], one[(number + 1) % 3] - one[number % 3]
        inner = _cross(edge, other[0] - start)
        for corner in other[1:]:
            np.maximum(inner, _cross(edge, corner - start), out=inner)
        overlap = np.flatnonzero(inner > depth * np.hypot(edge[0], edge[1]))
        if overlap.size < left.size:
            # Most near pairs only touch, and one of the first edges tells.
            left, depth = np.take(left, overlap), np.take(depth, overlap)
            first, second = np.take(first, overlap, axis=2), np.take(second, overlap, axis=2)
    return left


def overlap_area(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Area (n,) that triangles (3 corners, 2, n) share.

    The first is clipped by the edges of the second (Sutherland and Hodgman 1974).
    """
    polygon, clip = _turned(first), _turned(second)
    for k in range(3):
        start, edge = clip[k], clip[(k + 1) % 3] - clip[k]
        height = np.stack([_cross(edge, corner - start) for corner in polygon])
        following, next_height = np.roll(polygon, -1, axis=0), np.roll(height, -1, axis=0)
        inside = height >= 0.0
        crosses = inside != (next_height >= 0.0)
        share = np.divide(height, height - next_height, out=np.zeros_like(height), where=crosses)
        crossing = polygon + share[:, None] * (following - polygon)
        polygon = _filled(np.stack([polygon, crossing], 1), np.stack([inside, crosses], 1))
    following = np.roll(polygon, -1, axis=0)
    # About one of its corners, so that far from the origin nothing is lost.
    origin = polygon[:1]
    return 0.5 * np.abs(_cross((polygon - origin).swapaxes(0, 1), (following - origin).swapaxes(0, 1)).sum(axis=0))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[0] * b[1] - a[1] * b[0]


def _turned(triangles: np.ndarray) -> np.ndarray:
    """The triangles (3, 2, n), counter-clockwise."""
    clockwise = _cross(triangles[1] - triangles[0], triangles[2] - triangles[0]) < 0.0
    return np.where(clockwise, triangles[[0, 2, 1]], triangles)


def _filled(points: np.ndarray, there: np.ndarray) -> np.ndarray:
    """The polygon of the points (m, 2 kinds, 2, n) that are `there` (m, 2, n).

    Each other point takes the place of the one before it.
    """
    slots = 2 * points.shape[0]
    points, there = points.reshape(slots, *points.shape[2:]), there.reshape(slots, *there.shape[2:])
    number = np.where(there, np.arange(there.shape[0])[:, None], -1)
    latest = np.maximum.accumulate(number, axis=0)
    latest = np.where(latest < 0, number.max(axis=0), latest)  # before the first comes the last
    filled = np.take_along_axis(points, np.maximum(latest, 0)[:, None], axis=0)
    return np.where(there.any(axis=0), filled, 0.0)
