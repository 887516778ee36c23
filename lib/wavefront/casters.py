# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray casters that meet only some of the objects; rays pass through the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..scene.links import has_set
from ..scene.mesh import Mesh
from ..scene.rays import SHADOW, has_bits
from .frame import Frame, find_frame
from .raycaster import Hits, Raycaster


class PartCaster:
    """Embree over some of the objects.

    The triangles of its hits are numbered as in the whole mesh.
    """

    def __init__(self, mesh: Mesh, frame: Frame, met: np.ndarray) -> None:
        """`met` (objects,) bool: which objects rays meet."""
        index = np.flatnonzero(np.take(met, mesh.object_index))
        self._index = np.append(index, -1).astype(np.int32)  # a miss, -1, reads the last entry
        self._caster = Raycaster(replace(mesh, triangles=np.take(mesh.triangles, index, axis=1)), frame)

    def occluded(self, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray) -> np.ndarray:
        """As Raycaster.occluded."""
        return self._caster.occluded(origin, direction, reach)

    def closest(self, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray | None = None) -> Hits:
        """As Raycaster.closest."""
        hits = self._caster.closest(origin, direction, reach)
        return replace(hits, triangle=np.take(self._index, hits.triangle))


class Casters:
    """One caster for each set of objects that a kind of ray meets; equal sets share one.

    `whole` meets every object, in the `frame` that all share. `viewpoint` (3,) is the camera's place, for the frame.
    """

    def __init__(self, mesh: Mesh, viewpoint: np.ndarray) -> None:
        self._mesh, self.frame = mesh, find_frame(mesh, viewpoint)
        self.whole = Raycaster(mesh, self.frame)
        self._parts: dict[tuple[bool, ...], PartCaster] = {}

    def for_bits(self, bits: int) -> Raycaster | PartCaster:
        """The caster for rays that meet the objects whose masks have all of `bits`."""
        return self._for_objects(tuple(has_bits(thing.rays, bits) for thing in self._mesh.objects))

    def for_blockers(self, sets: int) -> Raycaster | PartCaster:
        """The caster for shadow rays of a light that only objects of these `sets` hide (links.py)."""
        things = self._mesh.objects
        return self._for_objects(tuple(has_bits(one.rays, SHADOW) and has_set(sets, one.blocker) for one in things))

    def for_object(self, number: int) -> Raycaster | PartCaster:
        """The caster for rays that meet one object only."""
        return self._for_objects(tuple(k == number for k in range(len(self._mesh.objects))))

    def _for_objects(self, met: tuple[bool, ...]) -> Raycaster | PartCaster:
        if all(met):
            return self.whole
        if met not in self._parts:
            self._parts[met] = PartCaster(self._mesh, self.frame, np.array(met))
        return self._parts[met]
