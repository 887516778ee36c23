# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive triangles as one light.

Which faces emit, their estimated power, and their exact emission at a sampled point.
"""

from __future__ import annotations

import numpy as np

from ..lights.light import Ball, Emitted, LightSample, Pair, bounding_ball, luminance
from ..lights.triangles import EmissiveTriangles
from ..sampling.warps import cosine_hemisphere
from ..surfaces.materials import PreparedMaterial
from ..surfaces.surface import SurfacePoints, SurfaceTables
from ..vectors import cross, dot, orthonormal_basis, to_world


class EmissiveMesh:
    """A light sampler of emissive faces, given by their indices `triangles` (t,).

    A sample has the material's own emission at the sampled point.
    """

    delta = False

    def __init__(
        self, tables: SurfaceTables, materials: list[PreparedMaterial], planes: np.ndarray, triangles: np.ndarray
    ) -> None:
        """`triangles` (t,) are the indices of those that emit; `planes` as in raycaster.py."""
        self._tables, self._materials = tables, materials
        mesh = tables.mesh
        a, b, c = mesh.triangles[:, triangles]
        corner = np.take(mesh.vertices, a, axis=1)
        edges = np.take(mesh.vertices, b, axis=1) - corner, np.take(mesh.vertices, c, axis=1) - corner
        self._normal, self._plane_of = planes[:3, triangles], np.full(mesh.triangle_count, -1, np.intp)
        self._plane_of[triangles] = np.arange(triangles.size)
        self._offset = float(planes[4].max())
        self.triangles, self._offsets = triangles, planes[4, triangles]
        normal = cross(*edges)
        flux = np.pi * np.sqrt(dot(normal, normal)) * self._estimates(triangles, corner, edges)  # both faces
        self._sampler = EmissiveTriangles(corner, *edges, triangles, flux)
        self.power = self._sampler.power

    def _estimates(self, triangles: np.ndarray, corner: np.ndarray, edges: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
        """Magnitude of the emission at each triangle's middle, also where it is negative.

        A floor keeps every face that emits.
        """
        third = np.full(triangles.size, 1.0 / 3.0)
        middle = corner + (edges[0] + edges[1]) / 3.0
        points = SurfacePoints(self._tables, triangles, third, third, middle, self._normal, self._normal)
        estimate = luminance(np.abs(self._radiance(points)))
        finite = np.isfinite(estimate)
        brightest = max(float(estimate[finite].max(initial=0.0)), 1e-30)
        # What is not finite shall be found and counted: it is taken for as bright as the brightest, or 1 W m^-2 sr^-1.
        return np.where(finite, np.maximum(estimate, 0.05 * brightest), max(brightest, 1.0))

    def _radiance(self, points: SurfacePoints) -> np.ndarray:
        radiance = np.zeros((3, points.size))
        material = np.take(self._tables.mesh.material_index, points.triangle)
        for k in np.unique(material):
            index = np.flatnonzero(material == k)
            radiance[:, index] = self._materials[k].emission(points.at(index))
        return radiance

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """A direction to a point on an emissive face; the distance ends just short of it."""
        found = self._sampler.sample(point, u1, u2)
        local = self._plane_of[found.triangle]
        position = point + found.wi * found.distance
        points = SurfacePoints(
            self._tables, found.triangle, found.b1, found.b2, position, np.take(self._normal, local, axis=1), -found.wi
        )
        # Both ends of the shadow ray may stand off their planes by the offset, which an edge-on face stretches.
        reach = found.distance * (1.0 - 2.0**-20) - 4.0 * self._offset / np.maximum(np.abs(found.facing), 1e-30)
        return LightSample(found.wi, reach, self._radiance(points), found.pdf)

    @property
    def extent(self) -> Ball:
        """The ball about the faces."""
        mesh = self._tables.mesh
        return bounding_ball(mesh.vertices[:, mesh.triangles[:, self.triangles].ravel()])

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Rays from faces chosen by power: uniform by area, cosine-weighted on either side.

        Their origins stand off the face.
        """
        which = self._sampler.place(*place)[0]
        turn, side = np.modf(2.0 * heading[0])
        local = cosine_hemisphere(turn, heading[1])
        facing = np.take(self._normal, which, axis=1) * np.where(side > 0.0, -1.0, 1.0)
        direction = to_world(local, *orthonormal_basis(facing), facing)
        return self.emit_along(direction, local[2] * (0.5 / np.pi), place)

    def emit_along(self, direction: np.ndarray, density: np.ndarray, place: Pair) -> Emitted:
        """Rays of given directions (3, n), from faces chosen by power.

        The directions were sampled with `density` (n,) per steradian.
        """
        which, b1, b2, position = self._sampler.place(*place)
        triangle = np.take(self.triangles, which)
        normal = np.take(self._normal, which, axis=1)
        radiance = self._radiance(SurfacePoints(self._tables, triangle, b1, b2, position, normal, direction))
        cosine = dot(normal, direction)
        weight = radiance * (np.abs(cosine) / (density * np.maximum(self._sampler.area_density(triangle), 1e-300)))
        origin = position + normal * np.copysign(self._offsets[which], cosine)
        return Emitted(origin, direction, weight, luminance(np.abs(radiance)))

    def pdf_of_hit(self, triangle: np.ndarray, distance: np.ndarray, cos_light: np.ndarray) -> np.ndarray:
        """Density per steradian with which `sample` gives a direction that hits `triangle`.

        `distance` is that of the hit.
        """
        return self._sampler.pdf_of_hit(triangle, distance, cos_light)
