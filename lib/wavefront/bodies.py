# SPDX-License-Identifier: GPL-3.0-or-later
"""Ray casters for walks inside objects, and the surfaces at which these walks leave.

Each object that light scatters inside of has a ray caster of its own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..errors import Refusal, Refused
from ..scattering.subsurface import BY_DISK
from ..scene.expressions import Expression
from ..scene.materials import Diffuse, Material, Subsurface, WeightedClosure
from ..scene.mesh import Mesh
from .raycaster import Raycaster


class Body:
    """Embree over one object, in a frame of its own.

    A small object in a large scene is thus resolved as finely as it would be alone.
    """

    def __init__(self, mesh: Mesh, number: int) -> None:
        self._index = np.flatnonzero(mesh.object_index == number).astype(np.int32)
        corners, triangles = np.unique(np.take(mesh.triangles, self._index, axis=1), return_inverse=True)
        count = self._index.size
        alone = Mesh(
            np.take(mesh.vertices, corners, axis=1),
            triangles.reshape(3, count).astype(np.int32),
            np.take(mesh.material_index, self._index),
            np.zeros(count, np.int32),
            np.zeros(count, bool),
            np.zeros((3, 3, 0), np.float32),
            (mesh.objects[number],),
        )
        self._caster = Raycaster(alone)
        low, high = alone.vertices.min(axis=1, keepdims=True), alone.vertices.max(axis=1, keepdims=True)
        diagonal = np.linalg.norm(high - low)
        self._low, self._high = low - diagonal, high + diagonal

    def below(self, triangle: np.ndarray, position: np.ndarray, ng: np.ndarray) -> np.ndarray:
        """The points `position` (3, n) of the object's faces, moved below the surface.

        They move against `ng` by what float32 can resolve there.
        """
        local = np.searchsorted(self._index, triangle)
        return position - ng * np.take(self._caster.planes[4], local)

    def is_far(self, position: np.ndarray) -> np.ndarray:
        """Whether points (3, n) are farther from the object's bounds than its size, (n,) bool.

        Light that is so far away left the object by an opening.
        """
        return ((position < self._low) | (position > self._high)).any(axis=0)

    def closest(
        self, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """The first face within `reach` (n,).

        Returns its triangle in the whole mesh (-1 for none), its distance, and u, v.
        """
        hits = self._caster.closest(origin, direction, reach)
        met = hits.triangle >= 0
        return np.where(met, np.take(self._index, hits.triangle), np.int32(-1)), hits.distance, hits.u, hits.v


class Bodies:
    """The bodies of all objects with a face under which light scatters.

    Walks in different bodies are followed together.
    """

    def __init__(self, mesh: Mesh, materials: Sequence[Material]) -> None:
        self._owner = mesh.object_index
        self._bodies = {k: Body(mesh, k) for k in objects_entered(mesh, materials, by_disk=False)}

    def groups(self, triangle: np.ndarray) -> list[tuple[Body, np.ndarray]]:
        """Each body that has some of the triangles (n,), and the places of these."""
        owner = np.take(self._owner, triangle)
        return [(self._bodies[k], np.flatnonzero(owner == k)) for k in np.unique(owner).tolist()]

    def below(self, triangle: np.ndarray, position: np.ndarray, ng: np.ndarray) -> np.ndarray:
        """As Body.below, for faces of any bodies."""
        moved = np.empty_like(position)
        for body, here in self.groups(triangle):
            moved[:, here] = body.below(triangle[here], position[:, here], ng[:, here])
        return moved

    def closest(
        self, start: np.ndarray, origin: np.ndarray, direction: np.ndarray, reach: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """As Body.closest, for rays inside the bodies of the triangles `start` (n,)."""
        groups = self.groups(start)
        if len(groups) == 1:
            return groups[0][0].closest(origin, direction, reach)
        size = start.size
        found = np.empty(size, np.int32), np.empty(size), np.empty(size, np.float32), np.empty(size, np.float32)
        for body, here in groups:
            rays = np.take(origin, here, axis=1), np.take(direction, here, axis=1), reach[here]
            for whole, part in zip(found, body.closest(*rays), strict=True):
                whole[here] = part
        return found

    def is_far(self, start: np.ndarray, position: np.ndarray) -> np.ndarray:
        """As Body.is_far, for points of walks in the bodies of the triangles `start` (n,)."""
        far = np.empty(start.size, bool)
        for body, here in self.groups(start):
            far[here] = body.is_far(np.take(position, here, axis=1))
        return far


def objects_entered(mesh: Mesh, materials: Sequence[Material], by_disk: bool) -> list[int]:
    """The objects with a face that light enters, to leave by a disk or to walk."""

    def enters(material: Material) -> bool:
        closures = [lobe.closure for lobe in material.lobes if isinstance(lobe.closure, Subsurface)]
        return any((closure.mapping == BY_DISK) == by_disk for closure in closures)

    entered = np.array([enters(material) for material in materials], bool)
    return np.unique(mesh.object_index[np.take(entered, mesh.material_index)]).tolist()


def exit_materials(materials: Sequence[Material]) -> tuple[list[Material], np.ndarray]:
    """The materials by which faces scatter the light that leaves there.

    Returns them and, for each material of the scene, the number of the one that its faces have, (materials,).
    They are diffuse and white, about the normal that the closures of the material share. Raises Refused where these
    differ.
    """
    exits, numbers = [_white("", None)], []
    for material in materials:
        closures = [lobe.closure for lobe in material.lobes if isinstance(lobe.closure, Subsurface)]
        normals = {id(closure.normal): closure.normal for closure in closures}
        if len(normals) > 1:
            what = "subsurface scattering by several closures with different normals"
            raise Refused([Refusal(f"material '{material.name}'", what, "link the same Normal to all of them")])
        normal = next(iter(normals.values()), None)
        if normal is not None:
            exits.append(_white(material.name, normal))
        numbers.append(0 if normal is None else len(exits) - 1)
    return exits, np.array(numbers, np.intp)


def _white(name: str, normal: Expression | None) -> Material:
    return Material(name, (WeightedClosure(Diffuse(normal=normal)),))
