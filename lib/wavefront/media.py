# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: volumes; which of them a ray is in, and what they leave of its light.

Each object has a volume for each material of its faces that has one. A ray that passes such a face from its front enters that volume, and
leaves it through a face from behind; volumes that overlap add up (Cycles, kernel/integrator/volume_stack.h). The volumes that a
ray is in together are a medium. Media are numbered as they are met; 0 is the air of the world.
"""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np

from ..scattering.free_path import transmittance
from ..scene.scene import Scene
from ..scene.volumes import Volume
from ..surfaces.surface import SurfacePoints
from ..vectors import dot, normalize
from .casters import Casters
from .raycaster import Raycaster

AIR = 0
"""The medium of rays that are in no object."""
# A ray from here tells whether its start is inside; along no axis, so that it meets no edges of boxes.
_PROBE = normalize(np.array([[0.31], [0.17], [0.94]]))


class Media:
    """The volumes of one scene, and the media that rays have met so far.

    `extinction` (3, media), 1/m, and `emission` (3, media), W m^-3 sr^-1, have one column for each; they grow, and what is there stays. So
    does `scattering` (G, 3, media), 1/m, apart for each of the G `anisotropies` that phase functions of the scene have.
    """

    def __init__(self, scene: Scene, casters: Casters) -> None:
        mesh, count = scene.mesh, len(scene.materials)
        self._mesh, self._whole, self._frame = mesh, casters.whole, casters.frame
        filled = np.array([m.volume is not None and not m.volume.is_empty for m in scene.materials], bool)
        faces = np.flatnonzero(np.take(filled, mesh.material_index))
        key = mesh.object_index[faces].astype(np.int64) * count + mesh.material_index[faces]
        kinds, number = np.unique(key, return_inverse=True)
        self._volumes = [scene.materials[k % count].volume for k in kinds]
        self._faces = [faces[number == k] for k in range(kinds.size)]
        self._number_of = np.full(mesh.triangle_count, -1, np.intp)
        self._number_of[faces] = number
        self._bounds = [self._bounds_of(part) for part in self._faces]
        self._probes: dict[int, Raycaster] = {}
        self._air = scene.world.volume or Volume()
        self._members: list[frozenset[int]] = []
        self._index: dict[frozenset[int], int] = {}
        self._lock = threading.Lock()
        phases = [phase for volume in (self._air, *self._volumes) for phase in volume.phases]
        self.anisotropies = sorted({phase.anisotropy for phase in phases})
        self.extinction, self.emission = np.empty((3, 0)), np.empty((3, 0))
        self.scattering = np.empty((len(self.anisotropies), 3, 0))
        self._find(frozenset())

    @property
    def emits(self) -> bool:
        """Whether any of the volumes emits light."""
        return any(any(volume.emission) for volume in (self._air, *self._volumes))

    def _bounds_of(self, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        places = self._mesh.vertices[:, self._mesh.triangles[:, faces].ravel()]
        return places.min(axis=1, keepdims=True), places.max(axis=1, keepdims=True)

    def _find(self, members: frozenset[int]) -> int:
        """The number of the medium of these volumes; a new one where it is met for the first time."""
        with self._lock:
            if members not in self._index:
                together = [self._air, *(self._volumes[k] for k in sorted(members))]
                extinction, emission = (
                    np.sum([getattr(volume, name) for volume in together], axis=0)[:, None]
                    for name in ("extinction", "emission")
                )
                self.extinction = np.concatenate([self.extinction, extinction], axis=1)
                self.emission = np.concatenate([self.emission, emission], axis=1)
                self.scattering = np.concatenate([self.scattering, self._scattering_of(together)], axis=2)
                self._members.append(members)
                self._index[members] = len(self._members) - 1
            return self._index[members]

    def _scattering_of(self, volumes: list[Volume]) -> np.ndarray:
        """What volumes together scatter by each anisotropy, (G, 3, 1)."""
        total = np.zeros((len(self.anisotropies), 3, 1))
        for phase in (phase for volume in volumes for phase in volume.phases):
            total[self.anisotropies.index(phase.anisotropy), :, 0] += phase.scattering
        return total

    def around(self, origin: np.ndarray) -> np.ndarray:
        """The media (n,) in which rays from the camera begin, at `origin` (3, n)."""
        medium = np.full(origin.shape[1], AIR, np.intp)
        for k, (lowest, highest) in enumerate(self._bounds):
            near = np.flatnonzero(((origin >= lowest) & (origin <= highest)).all(axis=0))
            if near.size:
                inside = near[self._encloses(k, origin[:, near])]
                medium[inside] = self._moved(medium[inside], np.full(inside.size, k), np.ones(inside.size, bool))
        return medium

    def _encloses(self, number: int, point: np.ndarray) -> np.ndarray:
        """Whether the volume encloses points (3, n).

        It does where a ray meets the back of a face of the volume first.
        """
        faces = self._faces[number]
        with self._lock:
            if number not in self._probes:
                part = replace(self._mesh, triangles=np.take(self._mesh.triangles, faces, axis=1))
                self._probes[number] = Raycaster(part, self._frame)
        hits = self._probes[number].closest(point, np.broadcast_to(_PROBE, point.shape))
        normal = np.take(self._whole.planes[:3], faces[hits.triangle], axis=1)
        return (hits.triangle >= 0) & (dot(normal, _PROBE) > 0.0)

    def beyond(self, medium: np.ndarray, points: SurfacePoints, direction: np.ndarray) -> np.ndarray:
        """The media (n,) of rays that leave `points` along `direction` (3, n).

        The paths came to the points in `medium` (n,).
        """
        return self.crossed(medium, points, dot(points.ng, direction) < 0.0)

    def crossed(self, medium: np.ndarray, points: SurfacePoints, crosses: np.ndarray) -> np.ndarray:
        """The media (n,) beyond the faces at `points`, for rays that were in `medium` (n,).

        `crosses`, (n,) bool, tells which rays pass their face.
        """
        number = np.take(self._number_of, points.triangle)
        index = np.flatnonzero(crosses & (number >= 0))
        if index.size == 0:
            return medium
        following = medium.copy()
        following[index] = self._moved(medium[index], number[index], ~points.backfacing[index])
        return following

    def _moved(self, medium: np.ndarray, number: np.ndarray, enters: np.ndarray) -> np.ndarray:
        """The media (n,) of rays that enter the volumes `number` (n,), or leave them."""
        key = (medium * len(self._volumes) + number) * 2 + enters
        kinds, place = np.unique(key, return_inverse=True)
        following = []
        for kind in kinds.tolist():
            (old, volume), inwards = divmod(kind // 2, len(self._volumes)), kind % 2
            members = self._members[old]
            following.append(self._find(members | {volume} if inwards else members - {volume}))
        return np.array(following, np.intp)[place]

    def transmittance(self, medium: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """The share of light that is left after `distance` (n,) in `medium` (n,), (3, n).

        Rays without end are in the air: objects are closed, so a ray that meets no further face can be in none of them,
        whatever single precision makes of their edges.
        """
        medium = np.where(np.isinf(distance), AIR, medium)
        return transmittance(np.take(self.extinction, medium, axis=1), distance)
