# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether faces enclose a volume.

They do if they are closed, turned outwards, and have no part inside another.
"""

from __future__ import annotations

import numpy as np
import scipy

from ..vectors import cross, dot


def weld(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """The corners (3, t) int64 of the triangles, with vertices in one place made one.

    The vertices are (3, v).
    """
    _, welded = np.unique(vertices + 0.0, axis=1, return_inverse=True)
    return welded.reshape(-1)[triangles].astype(np.int64)


def directed_edges(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sorted keys of the edges of triangles with `corners` (3, t).

    Along their direction and against it, (3 t,) each.
    The two are equal exactly where the faces leave no opening.
    """
    a, b, c = corners
    start, end, count = np.concatenate([a, b, c]), np.concatenate([b, c, a]), int(corners.max(initial=0)) + 1
    return np.sort(start * count + end), np.sort(end * count + start)


def find_defect(vertices: np.ndarray, triangles: np.ndarray) -> str:
    """Why the faces (3, t) do not say what is inside them; '' where they do.

    `vertices` (3, v) are their corners.
    """
    used, inverse = np.unique(triangles, return_inverse=True)
    vertices, triangles = vertices[:, used], inverse.reshape(triangles.shape)
    corners = weld(vertices, triangles)
    if not np.array_equal(*directed_edges(corners)):
        return "its faces leave an opening"
    links = scipy.sparse.coo_array((np.ones(2 * corners.shape[1]), (np.tile(corners[0], 2), corners[1:].ravel())))
    size = int(corners.max()) + 1
    links.resize((size, size))
    parts, label = scipy.sparse.csgraph.connected_components(links, directed=False)
    label = label[corners[0]]
    centered = vertices - vertices.mean(axis=1, keepdims=True)
    a, b, c = (centered[:, row] for row in triangles)
    volume = np.bincount(label, dot(a, cross(b, c)), parts)
    if not volume.sum() > 0.0:
        return "its faces point inwards"
    places = np.stack([a, b, c])
    return _find_misplaced(places, label, volume) if parts > 1 else ""


def _find_misplaced(places: np.ndarray, label: np.ndarray, volume: np.ndarray) -> str:
    """Whether a part of the faces stands where its side is turned the wrong way.

    The part has corners `places` (3 corners, 3, t).
    A part turned outwards stands outside all others, one turned inwards, a hollow, inside one.
    """
    order = np.argsort(label, kind="stable")
    start = np.searchsorted(label[order], np.arange(volume.size))
    lowest = np.minimum.reduceat(places.min(axis=0)[:, order], start, axis=1)
    highest = np.maximum.reduceat(places.max(axis=0)[:, order], start, axis=1)
    first = places[0][:, order[start]]
    for k, point in enumerate(first.T[:, :, None]):
        around = np.all((lowest < point) & (highest > point), axis=0)
        around[k] = False
        turns = winding_number(point, places[:, :, around[label]]) if around.any() else 0.0
        if round(turns) != (volume[k] < 0.0):
            return "its parts overlap, or point inwards"
    return ""


def winding_number(point: np.ndarray, places: np.ndarray) -> float:
    """How often triangles enclose `point` (3, 1): 1 inside faces turned outwards.

    Their corners are `places` (3 corners, 3, t).
    Sum of signed solid angles over 4 pi (Van Oosterom and Strackee 1983, eq. 8).
    """
    a, b, c = places - point
    la, lb, lc = (np.sqrt(dot(x, x)) for x in (a, b, c))
    above = dot(a, cross(b, c))
    below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb
    return float(np.arctan2(above, below).sum() / (2.0 * np.pi))
