# SPDX-License-Identifier: GPL-3.0-or-later
"""Mean normals about points, for Blender's Bevel node.

A mean over the object's faces within a radius is estimated by a few probes and made a unit vector, as Cycles does it. The mean of
such vectors, and of what lobes make of them, depends on the number of probes, on what their uniforms have in common, and on their
axes. So all three are Cycles'.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from ..sampling.cycles_pattern import BEVEL, branches, cycles_pairs, dimension_at
from ..scattering.profiles import cubic_profile, sample_cubic
from ..scene.expressions import Bevel
from ..scene.scene import Scene
from ..surfaces.surface import SurfacePoints, SurfaceTables
from ..vectors import dot, normalize, put
from .casters import Casters
from .probes import Probes, objects_asking

LEAST_PDF = 8.0
"""Where a path was scattered by a lower density, per steradian, Cycles leaves the shading normal as it is (svm/bevel.h)."""
# Points whose probes are cast together: their arrays stay in cache.
_BLOCK = 16384


class Bevels:
    """The probes of Bevel nodes at one step of paths: the first, unless `at_step` says another."""

    def __init__(self, scene: Scene, tables: SurfaceTables, casters: Casters) -> None:
        self._tables = tables
        objects = objects_asking(scene, lambda node: isinstance(node, Bevel))
        self._probes = Probes(scene.mesh.object_index, casters, objects)
        self._dimension = dimension_at(0, BEVEL)

    def at_step(self, step: int) -> Bevels:
        """The same probes at another step."""
        other = copy(self)
        other._dimension = dimension_at(step, BEVEL)
        return other

    def averaged_normal(
        self, points: SurfacePoints, chance: np.ndarray, radius: np.ndarray, samples: int
    ) -> np.ndarray:
        """As surface.BevelProbes."""
        asking = np.flatnonzero((radius > 0.0) & (chance[1] >= LEAST_PDF))
        normal = points.n.copy()
        for start in range(0, asking.size, _BLOCK):
            index = asking[start : start + _BLOCK]
            here = points.at(index)
            total = self.summed_normal(here, chance[0, index], radius[index], samples)
            put(normal, index, np.where(dot(total, total) > 0.0, normalize(total) * here.side, here.n))
        return normal

    def summed_normal(self, points: SurfacePoints, place: np.ndarray, radius: np.ndarray, samples: int) -> np.ndarray:
        """Return the sum over the probes, (3, n), whose uniforms begin at the `place` (n,), in (0, 1), of Cycles' sequence.

        Its mean is `samples` times the integral of the faces' normals by `cubic_profile` of the distance. Normals are those of
        the faces' fronts, smooth where the faces are.
        """
        u, v = (row.ravel() for row in cycles_pairs(branches(place, samples), self._dimension))
        center, ng = (np.tile(row, samples) for row in (points.position, points.ng))
        reach, triangle = np.tile(radius, samples), np.tile(points.triangle, samples)
        off = sample_cubic(reach, v)
        axes, hits = self._probes.cast(triangle, center, ng, u, off, reach)
        probe = hits.probe
        away = hits.position - np.take(center, probe, axis=1)
        profile = cubic_profile(reach[probe], np.sqrt(dot(away, away))) / cubic_profile(reach, off)[probe]
        weight = axes.weight(probe, hits.ng) * profile
        met = SurfacePoints(self._tables, hits.triangle, hits.u, hits.v, hits.position, hits.ng, hits.ng)
        owner = probe % points.size
        return np.stack([np.bincount(owner, weight * row, points.size) for row in met.n])
