# SPDX-License-Identifier: GPL-3.0-or-later
"""The origin and the unit of length used in single precision.

Both follow from where most objects are, and from their size.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..scene.mesh import Mesh

# Embree leaves out triangles with a coordinate beyond 1.8e18; squares of coordinates must stay below float32's 3.4e38, too.
_LARGEST = 1e15
# Farther than so many usual distances from the centre, faces do not count for the radius.
_REACH = 16.0
# The camera counts as so much of an object: it decides between two objects, and not against one.
_VIEWPOINT = 0.5


@dataclass(frozen=True)
class Frame:
    """Coordinates are x -> (x - center) scale; `center` (3, 1) in metres, `scale` in 1/m.

    `radius`, in metres, is half the diagonal of the bounds, or how far all but the farthest faces reach if that is less: by it light from
    afar is weighed against lamps.
    """

    center: np.ndarray
    scale: float
    radius: float


def find_frame(mesh: Mesh, viewpoint: np.ndarray | None = None) -> Frame:
    """The frame whose centre is the median of the faces; each object counts the same.

    The scale is one over their usual distance from it.

    The middle of the bounds lies where nothing is as soon as one face is far from all others, and the mean of all
    vertices as soon as a far object has more of them than the near ones. `viewpoint` (3,) is the camera's place.
    """
    corners = np.take(mesh.vertices, mesh.triangles[0], axis=1)
    weights = 1.0 / np.bincount(mesh.object_index)[mesh.object_index]
    if viewpoint is not None:
        corners = np.append(corners, np.reshape(viewpoint, (3, 1)), axis=1)
        weights = np.append(weights, _VIEWPOINT)
    if weights.size == 0:
        return Frame(np.zeros((3, 1)), 1.0, 0.0)
    center = np.array([[weighted_median(row, weights)] for row in corners])
    usual = weighted_median(np.abs(corners - center).max(axis=0), weights)
    largest = float(np.abs(mesh.vertices - center).max(initial=0.0))
    if largest == 0.0:
        return Frame(center, 1.0, 0.0)
    radius = 0.5 * float(np.linalg.norm(np.ptp(mesh.vertices, axis=1)))
    if usual == 0.0:
        return Frame(center, 1.0 / largest, radius)
    return Frame(center, min(1.0 / usual, _LARGEST / largest), min(radius, _REACH * usual))


def weighted_median(values: np.ndarray, weights: np.ndarray) -> float:
    """The first of the sorted `values` (n,) by which half of the `weights` (n,) is reached."""
    order = np.argsort(values, kind="stable")
    total = np.cumsum(weights[order])
    return float(values[order[np.searchsorted(total, 0.5 * total[-1])]])
