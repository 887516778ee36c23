# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays of ambient occlusion: whether anything stands near a point (Blender's Ambient Occlusion node).

The mean of what is not linear in the occlusion depends on the number of rays, and on what their directions have in common.
So where there are several at a point, both are Cycles'.
"""

from __future__ import annotations

from copy import copy

import numpy as np

from ..sampling.cycles_pattern import OCCLUSION, branches, cycles_pairs, dimension_at
from ..sampling.warps import concentric_disk, cosine_hemisphere
from ..scene.expressions import AmbientOcclusion
from ..scene.rays import SHADOW
from ..scene.scene import Scene
from ..surfaces.surface import SurfacePoints
from ..vectors import basis_across, dot, orthonormal_basis, to_world
from .casters import Casters
from .probes import objects_asking


class Occluders:
    """The faces that rays of ambient occlusion meet; transparent ones count, as in Cycles.

    All rays meet what shadow rays meet. Where only the point's own object counts, it does whatever its ray visibility. The
    rays are those of the first step of paths, unless `at_step` says another.
    """

    def __init__(self, scene: Scene, casters: Casters) -> None:
        self._all = casters.for_bits(SHADOW)
        self._object_index = scene.mesh.object_index
        objects = objects_asking(scene, lambda node: isinstance(node, AmbientOcclusion) and node.only_local)
        self._own = {number: casters.for_object(number) for number in objects}
        self._dimension = dimension_at(0, OCCLUSION)

    def at_step(self, step: int) -> Occluders:
        """The same faces for the rays at another step."""
        other = copy(self)
        other._dimension = dimension_at(step, OCCLUSION)
        return other

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

        Rays have density cos / pi about the unit normals (3, n). 1 where the distance is not above 0. `chance` as in
        surface.OcclusionRays.
        """
        reach = np.broadcast_to(distance, (points.size,))
        if samples == 1:
            direction = to_world(cosine_hemisphere(chance[0], chance[1]), *orthonormal_basis(normal), normal)
            hidden = self._meets(points, direction, chance[2], reach, only_local).astype(np.float64)
        else:
            axes, hidden = basis_across(normal), np.zeros(points.size)
            for place in branches(chance[0], samples):
                x, y = concentric_disk(*cycles_pairs(place, self._dimension))
                up = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
                direction = axes[0] * x + axes[1] * y + normal * up
                hidden += self._meets(points, direction, chance[2], reach, only_local)
        return np.where(reach > 0.0, 1.0 - hidden / samples, 1.0)

    def _meets(
        self, points: SurfacePoints, direction: np.ndarray, offset: np.ndarray, reach: np.ndarray, only_local: bool
    ) -> np.ndarray:
        """Whether rays in a `direction` (3, n), from `offset` (n,) off the face, meet a face that counts, (n,) bool."""
        origin = points.position + points.ng * np.copysign(offset, dot(points.ng, direction))
        if not only_local:
            return self._all.occluded(origin, direction, reach)
        hidden = np.zeros(points.size, bool)
        own = np.take(self._object_index, points.triangle)
        for number in np.unique(own).tolist():
            index = np.flatnonzero(own == number)
            rays = np.take(origin, index, axis=1), np.take(direction, index, axis=1), reach[index]
            hidden[index] = self._own[number].occluded(*rays)
        return hidden
