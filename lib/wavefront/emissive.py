# SPDX-License-Identifier: GPL-3.0-or-later
"""Emissive triangles as one light.

Which faces emit, their estimated power, and their exact emission at a sampled point.
"""

from __future__ import annotations

import numpy as np

from ..lights.by_place import LEAST_GAIN, LightGrid, shares_of
from ..lights.cells import Places
from ..lights.face_groups import DividedFaces, divide_faces
from ..lights.light import Ball, Emitted, LightSample, Pair, bounding_ball, luminance, power_of
from ..lights.triangles import EmissiveTriangles, TriangleSample
from ..sampling.warps import cosine_hemisphere
from ..scene.mesh import Mesh
from ..scene.rays import COUNTS
from ..surfaces.materials import PreparedMaterial
from ..surfaces.surface import SurfacePoints, SurfaceTables
from ..vectors import cross, dot, orthonormal_basis, to_world

# The normals of closed faces, times their areas, add up to nothing; of open ones to more than this part of what they are without sign.
_OPEN = 0.02
# Places in the scene at which is asked whether a choice by place pays.
_PLACES = 1024


class EmissiveMesh:
    """A light sampler of emissive faces, given by their indices `triangles` (t,).

    A sample has the material's own emission at the sampled point. `parts` are up to `most_parts` groups of near faces.
    """

    delta = False

    def __init__(
        self,
        tables: SurfaceTables,
        materials: list[PreparedMaterial],
        planes: np.ndarray,
        triangles: np.ndarray,
        most_parts: int = 1,
    ) -> None:
        """`triangles` (t,) are the indices of those that emit; `planes` as in raycaster.py."""
        self._tables, self._materials = tables, materials
        mesh = tables.mesh
        corner, edge1, edge2 = _with_edges(mesh, mesh.triangles[:, triangles])
        self._normal, self._plane_of = planes[:3, triangles], np.full(mesh.triangle_count, -1, np.intp)
        self._plane_of[triangles] = np.arange(triangles.size)
        self._offset = float(planes[4].max())
        self.triangles, self._offsets = triangles, planes[4, triangles]
        normal = cross(edge1, edge2)
        fluxes = np.pi * np.sqrt(dot(normal, normal)) * self._estimates(triangles, corner, edge1, edge2)  # both faces
        self.flux = fluxes.sum(axis=1)
        self.power = power_of(self.flux)
        flux = self.power * shares_of(fluxes.T)
        self._sampler = EmissiveTriangles(corner, edge1, edge2, triangles, flux)
        corners = np.stack([corner, corner + edge1, corner + edge2])
        self._divided: DividedFaces | None = divide_faces(corners, flux, most_parts)
        self.parts = self._divided.groups.parts
        areas = np.abs(normal).sum()
        self._is_closed = bool(np.abs(normal.sum(axis=1)).sum() < _OPEN * areas)

    def choose_by_place(self, grid: LightGrid, number: int) -> bool:
        """Have samples in cells choose among the parts by the chances of `grid`, and return True, where that pays.

        `number` is that of this light in the grid. It pays by what the grid says, and where the faces are closed: they hide
        what is behind them, so that the near ones are those that are seen.
        """
        chances, gain = grid.within.get(number, (None, 0.0))
        mesh, divided = self._tables.mesh, self._divided
        self._divided = None  # its memory is for other things
        pays = gain > LEAST_GAIN or self._is_closed
        if chances is not None and divided is not None and pays:
            corners = _with_edges(mesh, divided.strips.turned(mesh.triangles[:, self.triangles]))
            self._sampler = EmissiveTriangles(*corners, self.triangles, divided.power, divided.strips)
            self._sampler.choose_by_place(divided.pieces, divided.groups, chances)
            return True
        return False

    def _estimates(self, triangles: np.ndarray, corner: np.ndarray, edge1: np.ndarray, edge2: np.ndarray) -> np.ndarray:
        """Magnitude (3, t) of the emission at each triangle's middle, also where it is negative.

        A floor keeps every face that emits.
        """
        third = np.full(triangles.size, 1.0 / 3.0)
        middle = corner + (edge1 + edge2) / 3.0
        points = SurfacePoints(self._tables, triangles, third, third, middle, self._normal, self._normal)
        points.tally = _tally(np.full(triangles.size, bounding_ball(self._tables.mesh.vertices).radius))
        radiance = np.abs(self._radiance(points))
        estimate = luminance(radiance)
        finite = np.isfinite(estimate)
        brightest = max(float(estimate[finite].max(initial=0.0)), 1e-30)
        # What is not finite shall be found and counted: it is taken for as bright as the brightest, or 1 W m^-2 sr^-1.
        floored = np.where(finite, np.maximum(estimate, 0.05 * brightest), max(brightest, 1.0))
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            scaled = radiance * (floored / estimate)
        return np.where(finite & np.isfinite(scaled), scaled, floored)

    def _radiance(self, points: SurfacePoints) -> np.ndarray:
        radiance = np.zeros((3, points.size))
        material = np.take(self._tables.mesh.material_index, points.triangle)
        for k in np.unique(material):
            index = np.flatnonzero(material == k)
            radiance[:, index] = self._materials[k].emission(points.at(index))
        return radiance

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """A direction to a point on an emissive face; the distance ends just short of it."""
        return self._to(self._sampler.sample(point, u1, u2), point)

    def sample_from(self, cell: np.ndarray, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """As `sample`, of faces that are chosen by the chances of the cells (n,)."""
        return self._to(self._sampler.sample(point, u1, u2, cell), point)

    def _to(self, found: TriangleSample, point: np.ndarray) -> LightSample:
        """The samples as directions from the points (3, n)."""
        local = self._plane_of[found.triangle]
        position = point + found.wi * found.distance
        points = SurfacePoints(
            self._tables, found.triangle, found.b1, found.b2, position, np.take(self._normal, local, axis=1), -found.wi
        )
        points.tally = _tally(found.distance)
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

    def pdf_of_hit(
        self,
        triangle: np.ndarray,
        distance: np.ndarray,
        cos_light: np.ndarray,
        cell: np.ndarray | None = None,
        weights: tuple[np.ndarray, np.ndarray] | None = None,
    ) -> np.ndarray:
        """Density per steradian with which a direction that hits `triangle` is sampled.

        By `sample`, or by `sample_from` with the cells (n,); then `weights` are the hit's u and v. `distance` is that of the hit.
        """
        return self._sampler.pdf_of_hit(triangle, distance, cos_light, cell, weights)


def _tally(length: np.ndarray) -> np.ndarray:
    """What rays of these lengths (n,) count, (counts, n): of the counts, emission may depend on the length alone."""
    counts = np.zeros((len(COUNTS), length.size))
    counts[COUNTS.index("RAY_LENGTH")] = length
    return counts


def _with_edges(mesh: Mesh, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The first corner of triangles (3, t) of vertices, and the edges to the second and third, (3, t) each."""
    first, second, third = (np.take(mesh.vertices, corner, axis=1) for corner in corners)
    return first, second - first, third - first


def places_on(mesh: Mesh, faces: np.ndarray) -> Places:
    """Places that are spread evenly over the area of `faces` (t,), at least one of them."""
    first, edge1, edge2 = _with_edges(mesh, mesh.triangles[:, faces])
    normal = cross(edge1, edge2)
    length = np.sqrt(dot(normal, normal))
    summed = np.cumsum(length)
    number = np.arange(_PLACES)
    face = np.searchsorted(summed, (number + 0.5) / _PLACES * summed[-1])
    face = np.minimum(face, summed.size - 1)
    root, along = np.sqrt((0.5 + number * 0.7548776662466927) % 1.0), (0.5 + number * 0.5698402909980532) % 1.0
    position = first[:, face] + edge1[:, face] * (1.0 - root) + edge2[:, face] * (root * along)
    return Places(position, normal[:, face] / np.maximum(length[face], 1e-300))
