# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that overlap in one plane, within single precision.

Two planes count as one where single precision does not distinguish them.
First the planes are hashed, each triangle into all cells that its plane may lie in, given the precision of its
vertices. Triangles that share a cell are then searched for in the plane, by a grid with a level for each power of two
of their size. The remaining pairs are tested exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import blake2b

import numpy as np

from .overlap_pairs import overlap_area, overlap_in_plane
from .overlap_search import Boxes, near_pairs

# Planes are one where they differ by less than this, in units of the largest coordinate: a few steps of float32.
RESOLVED = 2.0**-22
# Cells of the hash: components of the normal, and the distance from the centre in units of the scene's radius.
_NORMAL_CELL, _DISTANCE_CELL = 2.0**-8, 2.0**-12
# The first component of a normal beyond this gives its sign. One of them is at least 0.577; no common angle has such a cosine.
_SIGN_FROM = 0.5567
# Offsets of the cells, so that planes through the axes lie well inside one.
_OFFSETS = np.array([0.382, 0.618, 0.271, 0.437])
_MOST_CELLS = 64
_MULTIPLIERS = np.array(
    [0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB, 0xD6E8FEB86659FD93], np.uint64
).astype(np.int64)
# What was found last, by the digest of the mesh.
_latest: dict[bytes, Overlaps] = {}


@dataclass(frozen=True)
class Overlaps:
    """Pairs (2, k) of triangles that overlap in one plane, and their shared areas.

    The smaller number of a pair comes first. The area (k,) is in m^2.
    """

    pairs: np.ndarray
    area: np.ndarray

    @property
    def count(self) -> int:
        """The number of pairs."""
        return self.pairs.shape[1]


@dataclass(frozen=True)
class _Planes:
    """The planes of the triangles.

    Per triangle: normal (3, t) of a fixed sign, distance (t,) from the centre, tolerance (t,), and the precision of
    normal and distance.
    """

    normal: np.ndarray
    distance: np.ndarray
    tolerance: np.ndarray
    normal_error: np.ndarray
    distance_error: np.ndarray


def find_overlaps(vertices: np.ndarray, triangles: np.ndarray) -> Overlaps:
    """All pairs of triangles that share a plane and an area of it.

    `triangles` (3, t) index the `vertices` (3, v). What was found last is kept: the comparisons of a batch often have one mesh.
    Triangles less than 1/4000 of the largest coordinate high are passed over: single precision does not tell their
    planes.
    """
    digest = blake2b(b"".join(repr((one.shape, one.dtype)).encode() for one in (vertices, triangles)))
    for one in (vertices, triangles):
        digest.update(np.ascontiguousarray(one))
    found = _latest.get(digest.digest())
    if found is None:
        found = _search(vertices, triangles)
        _latest.clear()
        _latest[digest.digest()] = found
    return found


def _search(vertices: np.ndarray, triangles: np.ndarray) -> Overlaps:
    if triangles.shape[1] < 2:
        return Overlaps(np.empty((2, 0), np.intp), np.empty(0))
    center = 0.5 * (vertices.min(axis=1) + vertices.max(axis=1))
    corners = np.stack([np.take(vertices, row, axis=1) for row in triangles])  # (3 corners, 3, t)
    planes = _planes(corners, center)
    radius = max(0.5 * float(np.linalg.norm(np.ptp(vertices, axis=1))), 1e-300)
    item, group = _hashed(planes, radius)
    axis = _dropped_axis(planes, item, group)
    flat = _projected(corners, item, axis)
    found = []
    for first, second in near_pairs(_boxes(flat, group, planes.tolerance[item])):
        allowed = np.maximum(planes.tolerance[item[first]], planes.tolerance[item[second]])
        kept = overlap_in_plane(_of(flat, first), _of(flat, second), allowed)
        first, second = first[kept], second[kept]
        kept = _share_a_plane(corners, planes, item[first], item[second])
        first, second = first[kept], second[kept]
        cosine = np.abs(planes.normal[axis[first], item[first]])
        area = overlap_area(_of(flat, first), _of(flat, second)) / cosine
        found.append((np.sort([item[first], item[second]], axis=0), area))
    pairs = np.concatenate([pairs for pairs, _ in found], axis=1) if found else np.empty((2, 0), np.intp)
    area = np.concatenate([area for _, area in found]) if found else np.empty(0)
    _, once = np.unique(pairs[0] * triangles.shape[1] + pairs[1], return_index=True)
    return Overlaps(pairs[:, once], area[once])


def _planes(corners: np.ndarray, center: np.ndarray) -> _Planes:
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
    return _Planes(normal, distance, tolerance, normal_error, tolerance + normal_error * away)


def _hashed(planes: _Planes, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (m,) and the number (m,) of the group that each is in, sorted by group.

    A group has triangles whose planes may be one.
    """
    keep = np.flatnonzero(planes.normal_error <= 0.5 * _NORMAL_CELL)
    values = np.vstack([planes.normal[:, keep] / _NORMAL_CELL, planes.distance[None, keep] / (_DISTANCE_CELL * radius)])
    errors = np.vstack(
        [
            np.tile(planes.normal_error[keep] / _NORMAL_CELL, (3, 1)),
            planes.distance_error[None, keep] / (_DISTANCE_CELL * radius),
        ]
    )
    values += _OFFSETS[:, None]
    low, high = np.floor(values - errors).astype(np.int64), np.floor(values + errors).astype(np.int64)
    spans = np.minimum(high - low + 1, _MOST_CELLS)
    counts = spans.prod(axis=0)
    item = np.repeat(np.arange(keep.size), counts)
    number = np.arange(item.size) - np.repeat(np.cumsum(counts) - counts, counts)
    key = np.zeros(item.size, np.int64)
    with np.errstate(over="ignore"):
        for k in range(4):
            span = spans[k, item]
            key = (key ^ (low[k, item] + number % span)) * _MULTIPLIERS[k]
            key ^= key >> np.int64(29)
            number = number // span
    order = np.argsort(key, kind="stable")
    key = key[order]
    starts = np.flatnonzero(np.append(True, key[1:] != key[:-1])) if key.size else np.empty(0, np.intp)
    sizes = np.diff(np.append(starts, key.size))
    group = np.repeat(np.arange(starts.size), sizes)
    several = np.repeat(sizes > 1, sizes)
    return keep[item[order[several]]], group[several]


def _dropped_axis(planes: _Planes, item: np.ndarray, group: np.ndarray) -> np.ndarray:
    """The axis (m,) along which each group is projected.

    It is the same for all triangles of a group, and far from lying in their plane.
    """
    if item.size == 0:
        return np.empty(0, np.intp)
    first = np.flatnonzero(np.append(True, group[1:] != group[:-1]))
    return np.repeat(np.argmax(np.abs(planes.normal[:, item[first]]), axis=0), np.diff(np.append(first, item.size)))


def _projected(corners: np.ndarray, item: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """The corners of the triangles (m, 3 corners * 2) in their planes, counter-clockwise.

    Each triangle has a row, from which pairs pick.
    """
    flat = np.empty((item.size, 3, 2))
    for dropped in range(3):
        here = np.flatnonzero(axis == dropped)
        for column, kept in enumerate(((dropped + 1) % 3, (dropped + 2) % 3)):
            flat[here, :, column] = np.take(corners[:, kept], item[here], axis=1).T
    along, across = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    clockwise = along[:, 0] * across[:, 1] < along[:, 1] * across[:, 0]
    flat[clockwise] = flat[clockwise][:, [0, 2, 1]]
    return flat.reshape(-1, 6)


def _of(flat: np.ndarray, index: np.ndarray) -> np.ndarray:
    """The triangles (3 corners, 2, n) in rows `index` (n,)."""
    return np.ascontiguousarray(flat[index].T).reshape(3, 2, -1)


def _boxes(flat: np.ndarray, group: np.ndarray, tolerance: np.ndarray) -> Boxes:
    """The boxes of the triangles in their planes, less what single precision does not resolve."""
    columns = np.ascontiguousarray(flat.T).reshape(3, 2, -1)
    low, high = (find(find(columns[0], columns[1]), columns[2]) for find in (np.minimum, np.maximum))
    low += 0.5 * tolerance
    high -= 0.5 * tolerance
    return Boxes(group, *low, *high)


def _share_a_plane(corners: np.ndarray, planes: _Planes, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Which pairs (n,) lie in one plane, bool."""
    # The plane of the one that tells it better, and the corners of the other.
    better = planes.normal_error[first] <= planes.normal_error[second]
    plane, other = np.where(better, first, second), np.where(better, second, first)
    normal, base, turned = planes.normal[:, plane], corners[0][:, plane], planes.normal_error[plane]
    allowed = np.maximum(planes.tolerance[first], planes.tolerance[second])
    shared = np.ones(first.size, bool)
    for corner in corners:
        away = corner[:, other] - base
        turn = turned * np.sqrt(np.einsum("kn,kn->n", away, away))
        shared &= np.abs(np.einsum("kn,kn->n", normal, away)) <= allowed + turn
    return shared
