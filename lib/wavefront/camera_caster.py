# SPDX-License-Identifier: GPL-3.0-or-later
"""Camera rays, where objects hide from them: they meet the other objects only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..scene.mesh import Mesh
from .raycaster import Hits, Raycaster


class CameraCaster:
    """Embree over the faces that camera rays meet; the triangles of its hits are numbered as in the whole mesh."""

    def __init__(self, mesh: Mesh) -> None:
        shown = np.array([thing.visible_camera for thing in mesh.objects])
        index = np.flatnonzero(np.take(shown, mesh.object_index))
        self._index = np.append(index, -1).astype(np.int32)  # a miss, -1, reads the last entry
        self._caster = Raycaster(replace(mesh, triangles=np.take(mesh.triangles, index, axis=1)))

    def occluded(self, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """As Raycaster.occluded."""
        return self._caster.occluded(origin, direction, reach)

    def closest(self, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray | None = None) -> Hits:
        """As Raycaster.closest."""
        hits = self._caster.closest(origin, direction, reach)
        return replace(hits, triangle=np.take(self._index, hits.triangle))
