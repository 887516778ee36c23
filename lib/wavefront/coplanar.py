# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage of three departures: what rays meet where faces overlap in one plane.

Rays that leave a face meet the others at distance 0, all of them or those that single precision makes meet them; and of two faces of different
materials rays meet the other one.
"""

from __future__ import annotations

from collections.abc import Set
from typing import NamedTuple

import numpy as np

from ..scene.mesh import Mesh
from ..surfaces.surface import SurfacePoints
from ..vectors import cross, dot, gather
from .paths import Paths
from .raycaster import Hits
from .single_precision import corners_of, meet, place

FACES_IN_ONE_PLANE = "faces in one plane"
"""The departure that has rays skip only the face that they leave."""
ROUNDED_FACES = "rounding in one plane"
"""The departure that has them meet other faces in its plane only where single precision does."""
OTHER_FACE = "other of two faces"
"""The departure that has rays meet, of two faces in one plane, the one that the reference does not meet."""


class Left(NamedTuple):
    """What rays leave: the triangles (n,), -1 for none, the points (3, n), and the barycentrics u, v (2, n) of these."""

    triangle: np.ndarray
    point: np.ndarray
    uv: np.ndarray


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

    def met_by(self, left: Left, direction: np.ndarray) -> Met:
        """The faces at distance 0 that rays along `direction` (3, n) meet.

        Rays that leave no triangle meet nothing. Here the direction does not matter.
        """
        return self.at(left.triangle, left.point)

    def at(self, triangle: np.ndarray, point: np.ndarray) -> Met:
        """The other faces at `point` (3, n) on `triangle` (n,)."""
        ray, other = self._pairs(triangle)
        if ray.size == 0:
            return Met(ray, other, np.empty(0), np.empty(0))
        a, b, c = (np.take(self._mesh.vertices, row[other], axis=1) for row in self._mesh.triangles)
        along, across, away = b - a, c - a, point[:, ray] - a
        normal = cross(along, across)
        doubled = dot(normal, normal)
        u = dot(cross(away, across), normal) / doubled
        v = dot(cross(along, away), normal) / doubled
        inside = np.flatnonzero((u >= 0.0) & (v >= 0.0) & (u + v <= 1.0))
        return Met(ray[inside], other[inside], u[inside], v[inside])

    def _pairs(self, triangle: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The rays (k,) that leave `triangle` (n,), once for each other triangle (k,) in its plane."""
        start = self._start[triangle]
        count = np.where(triangle < 0, 0, self._start[triangle + 1] - start)
        ray = np.repeat(np.arange(triangle.size), count)
        number = np.arange(ray.size) - np.repeat(np.cumsum(count) - count, count)
        return ray, self._others[start[ray] + number]


class RoundedFaces(CoplanarFaces):
    """The same, met only where single precision puts the point that a ray leaves behind the other face.

    That is so at about half of the points of a plane that is not along two axes, and at all points of others. Behind the one face the
    path goes on: into a closed body, and out of it elsewhere.
    """

    def met_by(self, left: Left, direction: np.ndarray) -> Met:
        """The faces that rays along `direction` (3, n) meet, the nearest first."""
        ray, other = self._pairs(left.triangle)
        origin = place(corners_of(self._mesh, left.triangle[ray]), *left.uv[:, ray])
        hits = meet(corners_of(self._mesh, other), origin, direction[:, ray])
        order = np.lexsort((hits.distance, ray))
        met = order[hits.meets[order]]
        return Met(ray[met], other[met], *(x[met].astype(np.float64) for x in (hits.u, hits.v)))


def find_coplanar(mesh: Mesh, departures: Set[str]) -> CoplanarFaces | None:
    """The faces that overlap others, if rays meet them at distance 0 under `departures`."""
    if FACES_IN_ONE_PLANE in departures:
        return CoplanarFaces(mesh)
    return RoundedFaces(mesh) if ROUNDED_FACES in departures else None


def place_left(points: SurfacePoints, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The triangles (k,) that rays leave from the points at `index`, and the barycentrics (2, k) there."""
    return gather(points.triangle, index), np.stack([gather(points.u, index), gather(points.v, index)])


def with_other_faces(faces: CoplanarFaces, paths: Paths, hits: Hits) -> Hits:
    """The hits, where rays meet the other one of two faces in one plane.

    The two have different materials.
    """
    index = np.flatnonzero(hits.triangle >= 0)
    distance = hits.distance[index]
    point = np.take(paths.origin, index, axis=1) + np.take(paths.direction, index, axis=1) * distance
    met = faces.at(hits.triangle[index], point).first()
    there = Hits(met.triangle, distance[met.ray], met.u.astype(np.float32), met.v.astype(np.float32))
    return hits.replaced(index[met.ray], there)


def with_coplanar_hits(faces: CoplanarFaces, paths: Paths, hits: Hits) -> Hits:
    """The hits, with those at distance 0 for rays that leave triangles.

    Such rays meet other triangles in the plane of the one that they leave.
    """
    if paths.left is None or paths.left_uv is None:
        return hits
    met = faces.met_by(Left(paths.left, paths.origin, paths.left_uv), paths.direction).first()
    there = Hits(met.triangle, np.zeros(met.ray.size), met.u.astype(np.float32), met.v.astype(np.float32))
    return hits.replaced(met.ray, there)
