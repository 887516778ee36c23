# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles that overlap in one plane, within single precision.

Two planes count as one where single precision does not distinguish them.
First the planes are hashed, each triangle into all cells that its plane may lie in, given the precision of its
vertices. Boxes about the triangles of one cell are then searched for those that overlap, by a grid with levels for
their sizes. Boxes have a third side, across the plane: many planes lie in one cell. The remaining pairs are tested exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import blake2b

import numpy as np

from .overlap_pairs import overlap_area, overlap_in_plane
from .overlap_planes import Planes, Rows, find_planes, group_planes, share_a_plane
from .overlap_search import Boxes, near_pairs

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
    planes = find_planes(corners, center)
    rows = group_planes(planes, max(0.5 * float(np.linalg.norm(np.ptp(vertices, axis=1))), 1e-300))
    flat, axis, boxes = _lay_flat(corners, planes, rows)
    corners = np.ascontiguousarray(corners.reshape(9, -1).T)
    found, shared = [np.empty(0, np.intp)], [np.empty(0)]
    for first, second in near_pairs(boxes):
        one, other = np.sort([rows.triangle[first], rows.triangle[second]], axis=0)
        allowed = np.maximum(planes.tolerance[one], planes.tolerance[other])
        kept = overlap_in_plane(_of(flat, first), _of(flat, second), allowed)
        kept = kept[share_a_plane(corners, planes, one[kept], other[kept])]
        first, second, one, other = first[kept], second[kept], one[kept], other[kept]
        cosine = np.abs(planes.normal[axis[first], one])
        shared.append(overlap_area(_of(flat, first), _of(flat, second)) / cosine)
        found.append(one * triangles.shape[1] + other)
    key = np.concatenate(found)
    order = np.argsort(key)
    return Overlaps(np.stack(np.divmod(key[order], triangles.shape[1])), np.concatenate(shared)[order])


def _lay_flat(corners: np.ndarray, planes: Planes, rows: Rows) -> tuple[np.ndarray, np.ndarray, Boxes]:
    """The corners of the triangles (m, 3 corners * 2) in their planes, counter-clockwise.

    Each triangle has a row, from which pairs pick. A group is projected along one axis (m,), which is far from lying in
    the plane of any. Also returns boxes about the triangles: less what single precision does not resolve in the
    plane, and more across it.
    """
    count = rows.group.size
    starts = np.flatnonzero(np.append(True, rows.group[1:] != rows.group[:-1]))[:count]
    normal = planes.normal[:, rows.triangle[starts]]
    dropped = np.argmax(np.abs(normal), axis=0)
    slope = normal / np.take_along_axis(normal, dropped[None], axis=0)
    axis = dropped.astype(np.int8)[rows.group]
    flat, low, high = np.empty((count, 6)), np.empty((3, count)), np.empty((3, count))
    for k in range(3):
        here = np.flatnonzero(axis == k)
        triangle, group = rows.triangle[here], rows.group[here]
        points = np.take(corners, triangle, axis=2)
        height = np.einsum("cjm,jm->cm", points, np.take(slope, group, axis=1))
        reach = planes.reach[triangle] / np.abs(planes.normal[k, triangle])
        low[2, here], high[2, here] = height.min(axis=0) - reach, height.max(axis=0) + reach
        x, y = points[:, (k + 1) % 3], points[:, (k + 2) % 3]
        clockwise = (x[1] - x[0]) * (y[2] - y[0]) < (y[1] - y[0]) * (x[2] - x[0])
        margin = 0.5 * planes.tolerance[triangle]
        for column, values in enumerate((x, y)):
            low[column, here], high[column, here] = values.min(axis=0) + margin, values.max(axis=0) - margin
            flat[here, column] = values[0]
            flat[here, 2 + column] = np.where(clockwise, values[2], values[1])
            flat[here, 4 + column] = np.where(clockwise, values[1], values[2])
    return flat, axis, Boxes(rows.group, rows.lowest, low, high)


def _of(flat: np.ndarray, index: np.ndarray) -> np.ndarray:
    """The triangles (3 corners, 2, n) in rows `index` (n,)."""
    return np.ascontiguousarray(flat[index].T).reshape(3, 2, -1)
