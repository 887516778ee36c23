# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage of two departures: what rays meet where faces overlap in one plane.

Rays that leave a face meet the others at distance 0; and of two faces of different materials rays meet the other one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..scene.mesh import Mesh
from ..vectors import cross, dot
from .paths import Paths
from .raycaster import Hits

FACES_IN_ONE_PLANE = "faces in one plane"
"""The departure that has rays skip only the face that they leave."""
OTHER_FACE = "other of two faces"
"""The departure that has rays meet, of two faces in one plane, the one that the reference does not meet."""


class Met(NamedTuple):
    """Faces met at distance 0, (k,) each.

    The number of the ray, the triangle, and the barycentrics u, v of the point where it is met.
    """

    ray: np.ndarray
    triangle: np.ndarray
    u: np.ndarray
    v: np.ndarray

    def first(self) -> Met:
        """One face for each ray that meets any."""
        _, once = np.unique(self.ray, return_index=True)
        return Met(*(values[once] for values in self))


class CoplanarFaces:
    """The faces that overlap others, each with these others; read-only once made."""

    def __init__(self, mesh: Mesh, of_two_materials: bool = False) -> None:
        """`of_two_materials`: only pairs of which each has its own."""
        pairs = mesh.overlaps.pairs
        if of_two_materials:
            pairs = pairs[:, np.not_equal(*mesh.material_index[pairs])]
        both = np.concatenate([pairs, pairs[::-1]], axis=1)
        order = np.argsort(both[0], kind="stable")
        self._others = both[1][order].astype(np.int32)
        self._start = np.searchsorted(both[0][order], np.arange(mesh.triangle_count + 1))
        self._mesh = mesh

    def met_by(self, triangle: np.ndarray, point: np.ndarray) -> Met:
        """The faces at distance 0 that rays meet which leave `point` (3, n) on `triangle` (n,).

        The direction does not matter. Rays that leave no triangle (-1) meet nothing.
        """
        start = self._start[triangle]
        count = np.where(triangle < 0, 0, self._start[triangle + 1] - start)
        ray = np.repeat(np.arange(triangle.size), count)
        if ray.size == 0:
            return Met(ray, np.empty(0, np.int32), np.empty(0), np.empty(0))
        number = np.arange(ray.size) - np.repeat(np.cumsum(count) - count, count)
        other = self._others[start[ray] + number]
        a, b, c = (np.take(self._mesh.vertices, row[other], axis=1) for row in self._mesh.triangles)
        along, across, place = b - a, c - a, point[:, ray] - a
        normal = cross(along, across)
        doubled = dot(normal, normal)
        u = dot(cross(place, across), normal) / doubled
        v = dot(cross(along, place), normal) / doubled
        inside = np.flatnonzero((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0))
        return Met(ray[inside], other[inside], u[inside], v[inside])


def with_other_faces(faces: CoplanarFaces, paths: Paths, hits: Hits) -> Hits:
    """The hits, where rays meet the other one of two faces in one plane.

    The two have different materials.
    """
    index = np.flatnonzero(hits.triangle >= 0)
    distance = hits.distance[index]
    point = np.take(paths.origin, index, axis=1) + np.take(paths.direction, index, axis=1) * distance
    met = faces.met_by(hits.triangle[index], point).first()
    there = Hits(met.triangle, distance[met.ray], met.u.astype(np.float32), met.v.astype(np.float32))
    return hits.replaced(index[met.ray], there)


def with_coplanar_hits(faces: CoplanarFaces, left: np.ndarray, origin: np.ndarray, hits: Hits) -> Hits:
    """The hits, with those at distance 0 for rays that leave the triangles `left` (n,).

    Such rays meet other triangles in the plane of the one that they leave.
    """
    met = faces.met_by(left, origin).first()
    there = Hits(met.triangle, np.zeros(met.ray.size), met.u.astype(np.float32), met.v.astype(np.float32))
    return hits.replaced(met.ray, there)
