# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes whose vertices materials move: which of them are refused, and the moved ones."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ...lib.blender_versions import Versions
from ...lib.errors import Refusal
from ...lib.scene.images import Image
from ...lib.scene.materials import Material
from ...lib.scene.mesh import Object
from ...lib.scene.placements import LocalMesh
from ...lib.surfaces.displacement import depends_on_object, displace
from ...lib.textures.images import ImageSet
from ...lib.textures.requirements import reads_tangents
from .mesh import faces_of, read_undisplaced_normals, splits_normals

# Since then Cycles makes tangents for the displaced mesh, and displaces vertices whose corners have normals of their own as one.
_KEEPS_CORNERS_TOGETHER = Versions("5.2")
_SCALED = 1e-4


@dataclass(frozen=True)
class User:
    """An object that has a mesh, with the materials of its slots and their numbers in the scene.

    `matrix` is its map to the world, (3, 4).
    """

    thing: bpy.types.Object
    matrix: np.ndarray
    slots: tuple[int, ...]
    materials: tuple[Material, ...]


def find_undisplaceable(users: Sequence[User]) -> Iterator[tuple[int, Refusal]]:
    """What of displacing the mesh that all `users` have is not simulated.

    Each refusal comes with the number of a material that is the reason.
    """
    met = {k: one for user in users for k, one in zip(user.slots, user.materials, strict=True)}
    displacements = {k: one.displacement for k, one in met.items() if one.displacement is not None}
    if not displacements:
        return
    owner, mesh = f"object '{users[0].thing.name}'", faces_of(users[0].thing)
    for index, displacement in displacements.items():
        if splits_normals(mesh) and bpy.app.version not in _KEEPS_CORNERS_TOGETHER:
            what = "displacement of a mesh with custom normals or sharp edges, before Blender 5.2"
            yield index, Refusal(owner, what, "clear them and shade it smooth or flat")
        if displacement.space == "TANGENT" and not mesh.uv_layers:
            yield index, Refusal(owner, "displacement in tangent space of a mesh without a UV map", "give it a UV map")
        if len(users) > 1 and depends_on_object(displacement):
            what = (
                f"the displacement of '{met[index].name}', which depends on the object, of a mesh with several users,"
            )
            yield index, Refusal(owner, what, "make its mesh single-user, or choose Object Space")
        if len({tuple(id(one.displacement) for one in user.materials) for user in users}) > 1:
            what = f"the displacement of '{met[index].name}' on a mesh whose users have other materials,"
            yield index, Refusal(owner, what, "make its mesh single-user")
        if displacement.bumps and any(_is_scaled(user.matrix[:, :3]) for user in users):
            what, remedy = "Displacement and Bump of a scaled object", "apply its scale, or choose Displacement Only"
            yield index, Refusal(owner, what, remedy)
    bumped = any(one.bumps for one in displacements.values())
    for index, material in met.items():
        if not reads_tangents(material):
            continue
        remedy = "unlink the Normal Map node or Tangent"
        if bpy.app.version not in _KEEPS_CORNERS_TOGETHER:
            what = f"a normal map or UV tangents of '{material.name}' on a displaced mesh, before Blender 5.2"
            yield index, Refusal(owner, what, remedy)
        elif bumped:
            what = f"a normal map or UV tangents of '{material.name}' beside Displacement and Bump"
            yield index, Refusal(owner, what, remedy)


def _is_scaled(linear: np.ndarray) -> bool:
    """Whether a linear map (3, 3) changes lengths.

    Cycles then misjudges the slopes of a bump (docs/findings/displacement_and_bump.md).
    """
    return bool(np.abs(linear.T @ linear - np.eye(3)).max() > _SCALED)


class Displacer:
    """Moves the vertices of meshes, each mesh once."""

    def __init__(self, materials: Sequence[Material], images: Sequence[Image]) -> None:
        self._displacements = [material.displacement for material in materials]
        self._has_any = any(self._displacements)
        self._images = ImageSet(images)
        self._done: dict[int, LocalMesh] = {}

    def __call__(self, local: LocalMesh, thing: bpy.types.Object, item: Object, slots: np.ndarray) -> LocalMesh:
        """The mesh that was read from `thing` as `local`, as the materials of its slots displace it.

        `item` is that object as the scene has it, and `slots` are the numbers of the materials.
        """
        displacements = [self._displacements[k] for k in slots] if self._has_any else []
        if not any(displacements):
            return local
        if id(local) not in self._done:
            normals = read_undisplaced_normals(faces_of(thing), local)
            self._done[id(local)] = displace(local, normals, item, displacements, self._images)
        return self._done[id(local)]
