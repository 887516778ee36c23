# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: rays against triangles, by Embree in float32, made good in float64.

The scene is moved to where most of it is and scaled to about unit size in float64 before it is rounded (frame.py), so that a scene far
from the origin, a tiny one, or one with something very far off, loses nothing. Embree decides which triangle is hit; the point itself is then
put on that triangle's plane in float64, and rays that leave it start off the plane by what float32 can resolve there.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from ..scene.mesh import Mesh
from ..vectors import cross, gather
from .frame import Frame, find_frame

_FLOAT32_STEP = 2.0**-23


@dataclass(frozen=True)
class Hits:
    """Closest hits, (n,) each.

    triangle: int32, -1 for a miss. distance: inf for a miss. u, v: Embree's barycentrics.
    """

    triangle: np.ndarray
    distance: np.ndarray
    u: np.ndarray
    v: np.ndarray

    def at(self, index: np.ndarray) -> Hits:
        """The hits at `index`, as copies."""
        return Hits(*(gather(array, index) for array in vars(self).values()))

    def replaced(self, index: np.ndarray, hits: Hits) -> Hits:
        """These hits with others in the places `index` (k,), as new arrays."""
        merged = astuple(self)  # copies
        for whole, part in zip(merged, vars(hits).values(), strict=True):
            whole[index] = part
        return Hits(*merged)


class Raycaster:
    """Embree over one mesh, in a `frame` of its own unless one is given.

    `radius` is the frame's, in metres.
    """

    def __init__(self, mesh: Mesh, frame: Frame | None = None) -> None:
        # Embree may crash on no triangles at all: one without extent, which nothing meets, stands in for them.
        empty = mesh.triangle_count == 0
        corners = np.zeros((3, 1)) if empty else mesh.vertices
        faces = np.zeros((1, 3), np.int32) if empty else np.ascontiguousarray(mesh.triangles.T, np.int32)
        frame = find_frame(mesh) if frame is None else frame
        self._center, self._scale, self.radius = frame.center, frame.scale, frame.radius
        unit = ((corners - self._center) * self._scale).T.astype(np.float32)
        self._scene = EmbreeScene()
        self._mesh = TriangleMesh(self._scene, np.ascontiguousarray(unit), faces)
        self.planes = _planes(mesh, self._center, np.abs(unit).max(axis=1) / self._scale)
        self._scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))  # builds the tree, before threads do

    def _origins(self, origin: np.ndarray) -> np.ndarray:
        rounded = np.empty((origin.shape[1], 3), np.float32)
        for k in range(3):
            row = origin[k] - self._center[k]
            row *= self._scale
            rounded[:, k] = row
        return rounded

    def closest(self, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray | None = None) -> Hits:
        """First triangle along each ray; `reach` (n,) ends a ray early."""
        directions = _rounded(direction)
        far = None if reach is None else (reach * self._scale).astype(np.float32)
        out = self._scene.run(self._origins(origin), directions, dists=far, output=True)
        triangle = out["primID"]
        distance = out["tfar"].astype(np.float64)  # a miss is float32's largest, which the scale would take past it
        distance /= self._scale
        distance[np.flatnonzero(triangle < 0)] = np.inf
        return Hits(triangle, distance, out["u"], out["v"])

    def occluded(self, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """Whether anything stands before distance `reach` (inf allowed), (n,) bool."""
        far = np.minimum(reach * self._scale, 1e37).astype(np.float32)
        return self._scene.run(self._origins(origin), _rounded(direction), dists=far, query="OCCLUDED") >= 0

    def on_plane(self, triangle: np.ndarray, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The point moved along the normal onto the plane of its triangle.

        Returns it with the geometric normal and the safe offset (n,).
        """
        plane = gather(self.planes, triangle)
        ng = plane[:3]
        height = plane[3]
        for k in range(3):
            height -= (point[k] - self._center[k]) * ng[k]
        placed = np.empty_like(point)
        for k in range(3):
            np.multiply(ng[k], height, out=placed[k])
            placed[k] += point[k]
        return placed, ng, plane[4]


def _rounded(direction: np.ndarray) -> np.ndarray:
    rounded = np.empty((direction.shape[1], 3), np.float32)
    for k in range(3):
        rounded[:, k] = direction[k]
    return rounded


def _planes(mesh: Mesh, center: np.ndarray, magnitude: np.ndarray) -> np.ndarray:
    """The planes of the triangles, (5, t).

    Rows: unit geometric normal (3), plane distance from `center`, offset that float32 can resolve.
    `magnitude` (v,) is each vertex's largest coordinate after centring.
    """
    a, b, c = mesh.triangles
    corner = np.take(mesh.vertices, a, axis=1)
    normal = cross(np.take(mesh.vertices, b, axis=1) - corner, np.take(mesh.vertices, c, axis=1) - corner)
    length = np.sqrt((normal * normal).sum(axis=0))
    normal /= np.where(length > 0.0, length, 1.0)
    planes = np.empty((5, mesh.triangle_count))
    planes[:3] = normal
    planes[3] = (normal * (corner - center)).sum(axis=0)
    planes[4] = 3.0 * _FLOAT32_STEP * np.maximum(np.maximum(magnitude[a], magnitude[b]), magnitude[c])
    return planes


def no_hits(hidden: np.ndarray) -> Hits:
    """Hits of rays of which only `hidden` (n,) is known: whether they do not leave the scene."""
    nowhere = np.zeros(hidden.size, np.float32)
    return Hits(np.where(hidden, np.int32(0), np.int32(-1)), np.where(hidden, 0.0, np.inf), nowhere, nowhere)
