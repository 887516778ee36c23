# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays of ambient occlusion: whether anything stands near a point (Blender's Ambient Occlusion node)."""

from __future__ import annotations

import numpy as np

from ..sampling.warps import cosine_hemisphere
from ..scene.expressions import AmbientOcclusion
from ..scene.rays import SHADOW
from ..scene.scene import Scene
from ..surfaces.surface import SurfacePoints
from ..vectors import dot, orthonormal_basis, to_world
from .casters import Casters
from .probes import objects_asking


class Occluders:
    """The faces that rays of ambient occlusion meet; transparent ones count, as in Cycles.

    All rays meet what shadow rays meet. Where only the point's own object counts, it does whatever its ray visibility.
    """

    def __init__(self, scene: Scene, casters: Casters) -> None:
        self._all = casters.for_bits(SHADOW)
        self._object_index = scene.mesh.object_index
        objects = objects_asking(scene, lambda node: isinstance(node, AmbientOcclusion) and node.only_local)
        self._own = {number: casters.for_object(number) for number in objects}

    def open_share(
        self, points: SurfacePoints, chance: np.ndarray, normal: np.ndarray, distance: np.ndarray, only_local: bool
    ) -> np.ndarray:
        """Return 1 where a ray meets nothing within `distance` metres, else 0, (n,).

        Rays have density cos / pi about the unit normals (3, n). 1 where the distance is not above 0. `chance` as in
        surface.OcclusionRays.
        """
        direction = to_world(cosine_hemisphere(chance[0], chance[1]), *orthonormal_basis(normal), normal)
        origin = points.position + points.ng * np.copysign(chance[2], dot(points.ng, direction))
        reach = np.broadcast_to(distance, (points.size,))
        hidden = np.zeros(points.size, bool)
        if not only_local:
            hidden = self._all.occluded(origin, direction, reach)
        else:
            own = np.take(self._object_index, points.triangle)
            for number in np.unique(own).tolist():
                index = np.flatnonzero(own == number)
                rays = np.take(origin, index, axis=1), np.take(direction, index, axis=1), reach[index]
                hidden[index] = self._own[number].occluded(*rays)
        return np.where(hidden & (reach > 0.0), 0.0, 1.0)
