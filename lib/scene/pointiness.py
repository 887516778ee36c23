# SPDX-License-Identifier: GPL-3.0-or-later
"""How far vertices stick out of a mesh: the output Pointiness of Blender's Geometry node."""

from __future__ import annotations

import numpy as np

from ..vectors import dot, normalize

POINTINESS = "pointiness"
"""The name of the attribute, which Cycles keeps for itself."""

_EPSILON = np.finfo(np.float32).eps
_NEAR = np.float32(_EPSILON)  # of the squared distance
_NEAR_SUM = np.float32(3.0 * _EPSILON)


def pointiness(positions: np.ndarray, normals: np.ndarray, edges: np.ndarray, lengthless: float = 0.0) -> np.ndarray:
    """The pointiness (v,) of vertices at `positions` (3, v) float32, in object space.

    It is the angle between the normal and the mean direction of the edges, in half turns: 0.5 in a plane, more where the
    mesh is convex. Each vertex then has the mean of its own and its neighbours' values. `normals` (3, v) are the vertices',
    and `edges` (2, e) their ends. Vertices at one place are one vertex, with the sum of the normals; where these
    cancel the angle is a half turn, and without an edge 0. An edge between vertices at one place has `lengthless` for
    its direction; NaN gives the vertex a half turn. Source: `attr_create_pointiness` in Cycles' blender/mesh.cpp.
    """
    count = positions.shape[1]
    root = _merged(positions)
    first, second = ends = np.unique(np.sort(root[edges], axis=0), axis=1)
    normal = np.zeros((3, count), np.float32)
    for row, values in zip(normal, normals, strict=True):
        np.add.at(row, root, values)
    along = np.where(
        first == second, lengthless, normalize(positions[:, second].astype(np.float64) - positions[:, first])
    )
    degree = np.bincount(ends.ravel(), minlength=count)
    total = np.stack([np.bincount(first, row, count) - np.bincount(second, row, count) for row in along])
    cosine = dot(normalize(normal), total / np.maximum(degree, 1))
    cosine = np.where(normal.any(axis=0) & ~np.isnan(cosine), np.clip(cosine, -1.0, 1.0), -1.0)
    raw = np.where(degree > 0, np.arccos(cosine) / np.pi, 0.0)
    blurred = raw + np.bincount(first, raw[second], count) + np.bincount(second, raw[first], count)
    return (blurred / (degree + 1.0))[root]


def _merged(positions: np.ndarray) -> np.ndarray:
    """(v,) the vertex that stands for each, itself where it is alone.

    As in Cycles, vertices are near if the squared distance and the sums of their coordinates are. In the order of
    those sums each joins the next one that is near it.
    """
    from scipy.spatial import KDTree  # few scenes need it, and it takes a tenth of a second to load

    total = positions[0] + positions[1] + positions[2]
    order = np.lexsort((-np.arange(total.size), total))
    ordered, total = positions[:, order], total[order]
    # Candidates are a little more than what is near: the tree works in double precision.
    scaled = np.vstack([ordered / np.sqrt(np.float64(_NEAR)), total / np.float64(_NEAR_SUM)]).T
    pairs = KDTree(scaled).query_pairs(1.001, p=np.inf, output_type="ndarray")
    first, second = pairs.min(axis=1), pairs.max(axis=1)
    apart = ordered[:, first] - ordered[:, second]
    near = (dot(apart, apart) < _NEAR) & (total[second] - total[first] <= _NEAR_SUM)
    joined = np.full(total.size, total.size)
    np.minimum.at(joined, first[near], second[near])
    following = np.where(joined < total.size, joined, np.arange(total.size))
    while not np.array_equal(following, further := following[following]):
        following = further
    root = np.empty_like(order)
    root[order] = order[following]
    return root
