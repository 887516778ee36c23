# SPDX-License-Identifier: GPL-3.0-or-later
"""What is known at points of the surface: normals, texture coordinates, tangents.

Each is computed when it is first asked for.
"""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import numpy as np

from ..errors import SceneError
from ..scene.materials import Tangent
from ..scene.mesh import Mesh
from ..textures.context import Context
from ..vectors import any_perpendicular, basis_across, cross, dot, gather, normalize, put, rotate_about
from .tangents import CornerFrames, uv_tangents
from .undisplaced import undisplaced_mesh


class SurfaceTables:
    """Per-object matrices and per-triangle data that points look up."""

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        self._frames: dict[str, CornerFrames] = {}
        self.all_flat = mesh.corner_normals.shape[2] == 0 or not mesh.smooth.any()
        self.all_smooth = not self.all_flat and bool(mesh.smooth.all())
        if not self.all_flat:
            self.corner_normals = np.ascontiguousarray(mesh.corner_normals.reshape(9, -1))

    @cached_property
    def object_from_world(self) -> np.ndarray:
        """Inverse object matrices, rows by rows, (12, objects)."""
        inverses = []
        for item in self.mesh.objects:
            full = np.vstack([item.world_from_object, [0.0, 0.0, 0.0, 1.0]])
            if abs(np.linalg.det(full[:3, :3])) == 0.0:
                raise SceneError(f"object '{item.name}' has a scale of zero; give it one that can be inverted")
            inverses.append(np.linalg.inv(full)[:3].reshape(12))
        return np.ascontiguousarray(np.array(inverses).T)

    @cached_property
    def world_from_object(self) -> np.ndarray:
        """Linear parts of the object matrices, (9, objects)."""
        return np.ascontiguousarray(
            np.array([item.world_from_object[:, :3].reshape(9) for item in self.mesh.objects]).T
        )

    @cached_property
    def object_info(self) -> np.ndarray:
        """Location, colour, alpha, index and random number of each object, (9, objects)."""
        rows = [(*o.world_from_object[:, 3], *o.color, o.index, o.random) for o in self.mesh.objects]
        return np.ascontiguousarray(np.array(rows, np.float64).T)

    @cached_property
    def step(self) -> float:
        """A millionth of the scene's extent."""
        extent = float(np.ptp(self.mesh.vertices, axis=1).max()) if self.mesh.triangle_count else 1.0
        return 1e-6 * max(extent, 1e-6)

    @cached_property
    def undisplaced(self) -> SurfaceTables:
        """Those of the mesh as it was before it was displaced."""
        return SurfaceTables(undisplaced_mesh(self.mesh))

    def normal_map_frame(self, uv_map: str, triangle: np.ndarray) -> np.ndarray:
        """Return the tangent, the bitangent's sign and the normal at the corners of triangles (n,).

        They are (3 corners, 7, n), in object space.
        """
        if uv_map not in self._frames:
            matrices = self.object_from_world, self.world_from_object
            # Of two threads that are here at once, the second gets what the first one made.
            self._frames.setdefault(uv_map, CornerFrames(self.mesh, uv_map, *matrices, not self.all_flat))
        return self._frames[uv_map].at(triangle)


class OcclusionRays(Protocol):
    """Casts the rays of ambient occlusion."""

    def open_share(
        self,
        points: SurfacePoints,
        chance: np.ndarray,
        normal: np.ndarray,
        distance: np.ndarray,
        only_local: bool,
        samples: int,
    ) -> np.ndarray:
        """Return the share of rays that meet nothing within `distance` metres, (n,), of so many.

        `chance` (3, n): the uniforms that choose the rays about the unit `normal`, and how far off the face they start.
        """
        ...


class BevelProbes(Protocol):
    """Averages the normals about points."""

    def averaged_normal(
        self, points: SurfacePoints, chance: np.ndarray, radius: np.ndarray, samples: int
    ) -> np.ndarray:
        """Return the mean normals (3, n) within `radius` (n,) metres, by so many samples.

        `chance` (2, n): a uniform that chooses the probes, and the least density of the path's directions so far.
        """
        ...


class SurfacePoints(Context):
    """Points on triangles, seen from `wo`; the context in which expressions are evaluated.

    triangle (n,) int, barycentrics u, v (n,) of the second and third corner, position, ng and wo (3, n). The geometric normal is
    turned to the viewer's side, as is the shading normal with it; `backfacing` (n,) remembers where. `wavelength` (n,), in nanometres, is
    that of the light, where something depends on it. `flags`, () or (n,) int, are those of the rays that meet the points (scene/rays.py),
    where shaders ask, and `tally` (counts, n) the counts of the paths that meet them. `occluders` cast the rays of ambient occlusion, by
    `chance` (3, n), where shaders ask for it and a path meets the points; `bevels` and `bevel_chance` likewise average normals.
    `footprint` (n,), in metres, is the radius of the pixel's cone where a path meets the points and shaders ask for it.
    """

    wavelength: np.ndarray | None = None
    flags: np.ndarray | int = 0
    tally: np.ndarray | None = None
    occluders: OcclusionRays | None = None
    chance: np.ndarray | None = None
    bevels: BevelProbes | None = None
    bevel_chance: np.ndarray | None = None
    footprint: np.ndarray | None = None

    def __init__(
        self,
        tables: SurfaceTables,
        triangle: np.ndarray,
        u: np.ndarray,
        v: np.ndarray,
        position: np.ndarray,
        ng: np.ndarray,
        wo: np.ndarray,
    ) -> None:
        self.tables = tables
        self.triangle, self.u, self.v = triangle, u, v
        self.position, self.wo = position, wo
        facing = dot(ng, wo)
        self.backfacing = facing < 0.0
        self.side = np.copysign(1.0, facing)
        self.ng = ng * self.side

    @property
    def size(self) -> int:
        """Number of points."""
        return self.triangle.shape[0]

    def part(self, start: int, stop: int) -> SurfacePoints:
        """The points from `start` to `stop`, sharing arrays."""
        points = object.__new__(SurfacePoints)
        points.tables = self.tables
        points.triangle, points.u, points.v = self.triangle[start:stop], self.u[start:stop], self.v[start:stop]
        points.position, points.wo, points.ng = (
            self.position[:, start:stop],
            self.wo[:, start:stop],
            self.ng[:, start:stop],
        )
        points.backfacing, points.side = self.backfacing[start:stop], self.side[start:stop]
        points.n = self.n[:, start:stop]
        if self.wavelength is not None:
            points.wavelength = self.wavelength[start:stop]
        flags = self.flags
        points.flags = flags[start:stop] if isinstance(flags, np.ndarray) and flags.ndim else flags
        points.tally = None if self.tally is None else self.tally[:, start:stop]
        points.occluders = self.occluders
        points.chance = None if self.chance is None else self.chance[:, start:stop]
        points.bevels = self.bevels
        points.bevel_chance = None if self.bevel_chance is None else self.bevel_chance[:, start:stop]
        points.footprint = None if self.footprint is None else self.footprint[start:stop]
        return points

    def at(self, index: np.ndarray) -> SurfacePoints:
        """The points at `index`, as copies."""
        points = object.__new__(SurfacePoints)
        points.tables = self.tables
        for name in ("triangle", "u", "v", "position", "wo", "ng", "backfacing", "side"):
            setattr(points, name, gather(getattr(self, name), index))
        points.flags = self.flags if np.ndim(self.flags) == 0 else np.take(self.flags, index)
        points.tally = None if self.tally is None else np.take(self.tally, index, axis=1)
        points.occluders = self.occluders
        points.chance = None if self.chance is None else np.take(self.chance, index, axis=1)
        points.bevels = self.bevels
        points.bevel_chance = None if self.bevel_chance is None else np.take(self.bevel_chance, index, axis=1)
        points.footprint = None if self.footprint is None else np.take(self.footprint, index)
        return points

    @cached_property
    def n(self) -> np.ndarray:
        """The shading normal, (3, n).

        On smooth faces it is the normalised barycentric mix of the corner normals, else ng.
        """
        tables = self.tables
        if tables.all_flat:
            return self.ng
        if tables.all_smooth:
            return self._mixed_normal(self.triangle, self.u, self.v, self.side)
        smooth = np.flatnonzero(np.take(tables.mesh.smooth, self.triangle))
        if smooth.size == 0:
            return self.ng
        normal = self.ng.copy()
        put(normal, smooth, self._mixed_normal(*(x[smooth] for x in (self.triangle, self.u, self.v, self.side))))
        return normal

    def _mixed_normal(self, triangle: np.ndarray, u: np.ndarray, v: np.ndarray, side: np.ndarray) -> np.ndarray:
        corners = gather(self.tables.corner_normals, triangle).astype(np.float64)
        first = 1.0 - u - v
        mixed = corners[:3] * first
        mixed += corners[3:6] * u
        mixed += corners[6:] * v
        return normalize(mixed) * side

    @cached_property
    def cos_wo(self) -> np.ndarray:
        """|n.wo|, (n,)."""
        return np.abs(dot(self.n, self.wo))

    def coordinates(self, kind: str, uv_map: str = "") -> np.ndarray:
        """Texture coordinates of kind 'UV', 'GENERATED', 'OBJECT', 'NORMAL' or 'POSITION', (3, n)."""
        if kind == "POSITION":
            return self.position
        if kind in ("SHADING_NORMAL", "TRUE_NORMAL", "INCOMING"):
            return {"SHADING_NORMAL": self.n, "TRUE_NORMAL": self.ng, "INCOMING": self.wo}[kind]
        if kind == "UV":
            return self._uv(uv_map)
        if kind == "GENERATED":
            return self._generated()
        index = np.take(self.tables.mesh.object_index, self.triangle)
        if kind == "OBJECT":
            m = np.take(self.tables.object_from_world, index, axis=1)
            p = self.position
            return np.stack(
                [m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3] for k in range(3)]
            )
        # The inverse of the normal's map (the inverse transpose) is the transpose.
        m = np.take(self.tables.world_from_object, index, axis=1)
        n = self.n
        return normalize(np.stack([m[k] * n[0] + m[3 + k] * n[1] + m[6 + k] * n[2] for k in range(3)]))

    def _interpolated(self, corner: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
        first = 1.0 - self.u - self.v
        return corner[0] * first + corner[1] * self.u + corner[2] * self.v

    def _uv(self, uv_map: str) -> np.ndarray:
        table = self.tables.mesh.uvs.get(uv_map)
        coordinates = np.zeros((3, self.size))
        if table is not None:  # Cycles gives zero where there is no such map
            corners = np.take(table, self.triangle, axis=2)
            coordinates[:2] = self._interpolated((corners[0], corners[1], corners[2]))
        return coordinates

    def tangent_frame(self, uv_map: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the tangent (3, n), the bitangent's sign (n,) and the normal (3, n).

        They are for normal maps, in object space, on the front side.
        """
        corners = self.tables.normal_map_frame(uv_map, self.triangle)
        mixed = self._interpolated((corners[0], corners[1], corners[2]))
        return mixed[:3], mixed[3], mixed[4:]

    def normal_to_world(self, normal: np.ndarray) -> np.ndarray:
        """Return the unit normals (3, n) of the world for those of the object's space.

        They are transformed by the inverse transpose of the object's matrix.
        """
        m = np.take(self.tables.object_from_world, np.take(self.tables.mesh.object_index, self.triangle), axis=1)
        return normalize(np.stack([m[k] * normal[0] + m[4 + k] * normal[1] + m[8 + k] * normal[2] for k in range(3)]))

    @property
    def normal_scale(self) -> np.ndarray:
        """Metres along n for a unit along it in the object's space, (n,)."""
        m = np.take(self.tables.world_from_object, np.take(self.tables.mesh.object_index, self.triangle), axis=1)
        inside = self.coordinates("NORMAL")
        return dot(
            self.n,
            np.stack([m[3 * k] * inside[0] + m[3 * k + 1] * inside[1] + m[3 * k + 2] * inside[2] for k in range(3)]),
        )

    @property
    def step(self) -> float:
        """A length, in metres, over which slopes are taken: short against all that can be seen."""
        return self.tables.step

    def moved(self, direction: np.ndarray, step: float) -> SurfacePoints:
        """The points `step` further along unit vectors (3, n) in the planes of their triangles."""
        mesh = self.tables.mesh
        a, b, c = (np.take(mesh.vertices, k, axis=1) for k in np.take(mesh.triangles, self.triangle, axis=1))
        e1, e2 = b - a, c - a
        normal = cross(e1, e2)
        area2 = dot(normal, normal)
        points = self.at(np.arange(self.size))
        points.u = self.u + step * dot(cross(direction, e2), normal) / area2
        points.v = self.v + step * dot(cross(e1, direction), normal) / area2
        points.position = self.position + direction * step
        return points

    def undisplaced(self) -> SurfacePoints:
        """The points as they were before their vertices were displaced, seen from the same side."""
        points = self.at(np.arange(self.size))
        points.tables = self.tables.undisplaced
        mesh = points.tables.mesh
        a, b, c = (np.take(mesh.vertices, k, axis=1) for k in np.take(mesh.triangles, self.triangle, axis=1))
        points.position = self._interpolated((a, b, c))
        points.ng = normalize(cross(b - a, c - a)) * self.side
        return points

    def edge_distance(self) -> np.ndarray:
        """Distance in metres from the nearest line through two corners of the triangle, (n,)."""
        mesh = self.tables.mesh
        corners = [np.take(mesh.vertices, k, axis=1) for k in np.take(mesh.triangles, self.triangle, axis=1)]
        nearest = np.full(self.size, np.inf)
        for k in range(3):
            edge = corners[k] - corners[k - 1]
            area = cross(edge, self.position - corners[k])
            nearest = np.minimum(nearest, np.sqrt(dot(area, area) / dot(edge, edge)))
        return nearest

    def pixel_width(self) -> np.ndarray:
        """Return the mean width across the view of two steps in the face, each as long as the cone's radius, (n,).

        The steps are along Cycles' axes (svm/wireframe.h). 0 where no path meets the points, as for Cycles' light samples.
        """
        if self.footprint is None:
            return np.zeros(self.size)
        cosine = dot(np.stack(basis_across(self.ng), axis=1), self.wo[:, None])
        return self.footprint * np.sqrt(np.maximum(1.0 - cosine**2, 0.0)).mean(axis=0)

    def open_share(self, normal: np.ndarray, distance: np.ndarray, only_local: bool, samples: int) -> np.ndarray:
        """Return the estimate of ambient occlusion by so many rays, (n,).

        1 where no path meets the points, as for Cycles' light samples.
        """
        if self.occluders is None or self.chance is None:
            return np.ones(self.size)
        return self.occluders.open_share(self, self.chance, normal, distance, only_local, samples)

    def averaged_normal(self, radius: np.ndarray, samples: int) -> np.ndarray:
        """Return the estimate of the mean normal, (3, n).

        It is the shading normal where no path meets the points, as for Cycles' shadow rays.
        """
        if self.bevels is None or self.bevel_chance is None:
            return self.n
        return self.bevels.averaged_normal(self, self.bevel_chance, np.broadcast_to(radius, (self.size,)), samples)

    def object_info(self) -> np.ndarray:
        """Location, colour, alpha, index and random number of the object, (9, n)."""
        return np.take(self.tables.object_info, np.take(self.tables.mesh.object_index, self.triangle), axis=1)

    def attribute(self, name: str) -> np.ndarray:
        """Return red, green, blue, alpha, factor and presence of an attribute, (6, n).

        They are mixed from the corners.
        """
        corners = np.take(self.tables.mesh.attributes[name], self.triangle, axis=2)
        return self._interpolated((corners[0], corners[1], corners[2]))

    def _generated(self) -> np.ndarray:
        mesh = self.tables.mesh
        a, b, c = np.take(mesh.triangles, self.triangle, axis=1)
        return self._interpolated(tuple(np.take(mesh.generated, k, axis=1) for k in (a, b, c)))

    def tangent(
        self, source: Tangent, turns: np.ndarray, normal: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the unit tangent and bitangent across `normal` (n unless given), (3, n) each.

        They are turned about the normal by `turns` full circles.
        """
        n = self.n if normal is None else normal
        raw = (
            uv_tangents(self.tables.mesh, source.uv_map, self.triangle)
            if source.kind == "UV"
            else self._radial_tangent(source.axis)
        )
        turns = np.asarray(turns)
        if np.any(turns):
            raw = rotate_about(raw, n, 2.0 * np.pi * turns)
        bitangent = cross(n, raw)
        length = np.sqrt(dot(bitangent, bitangent))
        lost = length <= 1e-20  # a tangent along the normal: any direction across will do, the same one for all
        bitangent /= np.where(lost, 1.0, length)
        if lost.any():
            bitangent[:, lost] = any_perpendicular(n[:, lost])
        return cross(bitangent, n), bitangent

    def _radial_tangent(self, axis: str) -> np.ndarray:
        x, y, z = self._generated() - 0.5
        zero = np.zeros_like(x)
        radial = np.stack({"X": (zero, -z, y), "Y": (-z, zero, x), "Z": (-y, x, zero)}[axis])
        m = np.take(self.tables.object_from_world, np.take(self.tables.mesh.object_index, self.triangle), axis=1)
        return np.stack([m[k] * radial[0] + m[4 + k] * radial[1] + m[8 + k] * radial[2] for k in range(3)])
