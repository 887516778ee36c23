# SPDX-License-Identifier: GPL-3.0-or-later
"""Planes of triangles, and groups of triangles whose planes may be one, within single precision."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

# Planes are one where they differ by less than this, in units of the largest coordinate: a few steps of float32.
RESOLVED = 2.0**-22
# Cells of the hash: components of the normal, and the least for the distance from the centre, in units of the scene's radius.
_NORMAL_CELL, _DISTANCE_CELL = 2.0**-8, 2.0**-12
# The cells of distances are no smaller than this many times their median precision: most triangles shall be in few cells.
_DISTANCE_ERRORS = 8.0
# The first component of a normal beyond this gives its sign. One of them is at least 0.577; no common angle has such a cosine.
_SIGN_FROM = 0.5567
# Offsets of the cells, so that planes through the axes lie well inside one.
_OFFSETS = np.array([0.382, 0.618, 0.271, 0.437])
_MOST_CELLS = 64
_MULTIPLIERS = np.array([0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB, 0xD6E8FEB86659FD93], np.uint64)
# Room for rounding, and for the normals of one cell, which differ by up to two cells.
_ROOM = 1.05


@dataclass(frozen=True)
class Planes:
    """The planes of the triangles.

    Per triangle: normal (3, t) of a fixed sign, distance (t,) from the centre, tolerance (t,), the precision of
    normal and distance, and `reach` (t,): triangles farther apart, along their normal, than the sum of theirs do not
    share a plane.
    """

    normal: np.ndarray
    distance: np.ndarray
    tolerance: np.ndarray
    normal_error: np.ndarray
    distance_error: np.ndarray
    reach: np.ndarray

    @property
    def resolved(self) -> np.ndarray:
        """Which triangles single precision tells the plane of, (t,) bool."""
        return self.normal_error <= 0.5 * _NORMAL_CELL


@dataclass(frozen=True)
class Rows:
    """Triangles in groups whose planes may be one; a triangle has a row in each group that it is in.

    Per row: the triangle (m,), its group (m,), sorted, and in which components the group's cell is the
    lowest of those that the triangle is in, as bits (m,) uint8.
    """

    triangle: np.ndarray
    group: np.ndarray
    lowest: np.ndarray


def find_planes(corners: np.ndarray, center: np.ndarray) -> Planes:
    """The planes of triangles (3 corners, 3, t); distances are from `center` (3,)."""
    a, b, c = corners
    edges = b - a, c - b, a - c
    normal = np.cross(edges[0], -edges[2], axis=0)
    doubled = np.sqrt(np.einsum("kt,kt->t", normal, normal))
    normal /= np.where(doubled > 0.0, doubled, 1.0)
    first = np.where(np.abs(normal[0]) > _SIGN_FROM, 0, np.where(np.abs(normal[1]) > _SIGN_FROM, 1, 2))
    normal *= np.sign(np.take_along_axis(normal, first[None], axis=0))
    longest = np.sqrt(np.max([np.einsum("kt,kt->t", e, e) for e in edges], axis=0))
    tolerance = RESOLVED * np.abs(corners).max(axis=(0, 1))
    with np.errstate(divide="ignore"):
        normal_error = np.where(
            doubled > 0.0, 2.0 * tolerance * longest / np.where(doubled > 0.0, doubled, 1.0), np.inf
        )
    middle = (a + b + c) / 3.0 - center[:, None]
    away = np.sqrt(np.einsum("kt,kt->t", middle, middle))
    distance = np.einsum("kt,kt->t", normal, middle)
    reach = np.full(tolerance.size, np.inf)
    np.multiply(normal_error, longest, out=reach, where=doubled > 0.0)
    reach = _ROOM * (tolerance + reach)
    return Planes(normal, distance, tolerance, normal_error, tolerance + normal_error * away, reach)


def group_planes(planes: Planes, radius: float) -> Rows:
    """Rows of the triangles whose planes may be one, without groups of one.

    Planes are hashed, and each triangle is in all cells that its plane may lie in. Two triangles share one cell
    that is, in each component, the lowest of one of them.
    """
    keep = np.flatnonzero(planes.resolved)
    if keep.size == 0:
        return Rows(keep, np.empty(0, np.int32), np.empty(0, np.uint8))
    low, high = _cells_of_planes(planes, keep, radius)
    spans = np.minimum(high - low + 1, _MOST_CELLS)
    counts = spans.prod(axis=0)
    item = np.repeat(np.arange(keep.size, dtype=np.int32), counts)
    number = (np.arange(item.size) - np.repeat(np.cumsum(counts) - counts, counts)).astype(np.int32)
    key, lowest = np.zeros(item.size, np.uint64), np.zeros(item.size, np.uint8)
    for k in range(4):
        number, step = np.divmod(number, np.take(spans[k].astype(np.int32), item))
        key = (key ^ (np.take(low[k], item) + step).view(np.uint64)) * _MULTIPLIERS[k]
        key ^= key >> np.uint64(29)
        lowest |= (step == 0).view(np.uint8) << np.uint8(k)
    order = np.argsort(key, kind="stable")
    key = key[order]
    starts = np.flatnonzero(np.append(True, key[1:] != key[:-1]))
    sizes = np.diff(np.append(starts, key.size))
    order = order[np.repeat(sizes > 1, sizes)]
    sizes = sizes[sizes > 1]
    return Rows(keep[item[order]], np.repeat(np.arange(sizes.size, dtype=np.int32), sizes), lowest[order])


def _cells_of_planes(planes: Planes, index: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """The lowest and highest cells (4, k) that the planes at `index` (k,) may lie in.

    The cells of distances double in size, and then have each two cells in one, until they are large enough.
    """
    normal_error, distance_error = planes.normal_error[index], planes.distance_error[index]
    cell = _DISTANCE_CELL * radius
    doublings = max(0, math.ceil(math.log2(_DISTANCE_ERRORS * float(np.median(distance_error)) / cell)))
    values = np.vstack([planes.normal[:, index] / _NORMAL_CELL, planes.distance[None, index] / cell])
    values += _OFFSETS[:, None]
    errors = np.stack([*[normal_error / _NORMAL_CELL] * 3, distance_error / cell])
    low, high = np.floor(values - errors).astype(np.int64), np.floor(values + errors).astype(np.int64)
    half = 2**doublings // 2  # so that the plane through the centre stays well inside one
    for ends in (low, high):
        ends[3] = (ends[3] + half) >> doublings
    return low, high


def share_a_plane(corners: np.ndarray, planes: Planes, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Which pairs (n,) of triangles (t, 9) lie in one plane, (n,) bool."""
    # The plane of the one that tells it better, and the corners of the other.
    better = planes.normal_error[first] <= planes.normal_error[second]
    plane, other = np.where(better, first, second), np.where(better, second, first)
    normal, base, turned = planes.normal[:, plane], corners[plane, :3].T, planes.normal_error[plane]
    allowed = np.maximum(planes.tolerance[first], planes.tolerance[second])
    others = np.ascontiguousarray(corners[other].T).reshape(3, 3, -1)
    shared = np.ones(first.size, bool)
    for corner in others:
        away = corner - base
        turn = turned * np.sqrt(np.einsum("kn,kn->n", away, away))
        shared &= np.abs(np.einsum("kn,kn->n", normal, away)) <= allowed + turn
    return shared
