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

    Where the second one is the triangle 0 <= x <= 1 - y, it is the integral of max(0, min(x, 1 - y)) dy along the edges
    of the first one, where these have 0 <= y <= 1 (Green's theorem).
    """
    along, across = second[1] - second[0], second[2] - second[0]
    doubled = _cross(along, across)
    scale = np.divide(1.0, doubled, out=np.zeros_like(doubled), where=doubled != 0.0)
    corners = [corner - second[0] for corner in first]
    x, y = [_cross(corner, across) * scale for corner in corners], [_cross(along, corner) * scale for corner in corners]
    within = [np.clip(values, 0.0, 1.0) for values in y]
    area = np.zeros_like(doubled)
    for k in range(3):
        j = (k + 1) % 3
        rise, run = y[j] - y[k], x[j] - x[k]
        slope = np.divide(run, rise, out=np.zeros_like(rise), where=rise != 0.0)
        start, end = x[k] + (within[k] - y[k]) * slope, x[j] + (within[j] - y[j]) * slope
        beyond = _mean_above(start - 1.0 + within[k], end - 1.0 + within[j])
        area += (within[j] - within[k]) * (_mean_above(start, end) - beyond)
    return np.abs(area * doubled)


def _mean_above(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The mean (n,) of max(0, t) over t from `start` to `end` (n,)."""
    above, above_end = np.maximum(start, 0.0), np.maximum(end, 0.0)
    length = end - start
    share = np.divide(above_end - above, length, out=np.ones_like(length), where=length != 0.0)
    return 0.5 * (above + above_end) * share


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[0] * b[1] - a[1] * b[0]
