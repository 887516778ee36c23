# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh as it was before it was displaced, for bumps on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..scene.mesh import UNDISPLACED, UNDISPLACED_NORMAL, Mesh
from ..scene.normals import normal_matrices


def undisplaced_mesh(mesh: Mesh) -> Mesh:
    """The same triangles where they were, each with corners of its own and smooth.

    The mesh has the attributes of corners that displacement leaves.
    """
    matrices = np.array([item.world_from_object for item in mesh.objects])
    place = matrices[mesh.object_index]
    turn = normal_matrices(matrices[:, :, :3])[mesh.object_index]
    places, normals = mesh.attributes[UNDISPLACED][:, :3], mesh.attributes[UNDISPLACED_NORMAL][:, :3]
    corners = mesh.triangles.ravel()
    return replace(
        mesh,
        vertices=np.hstack([np.einsum("tij,jt->it", place[:, :, :3], one) + place[:, :, 3].T for one in places]),
        triangles=np.arange(corners.size, dtype=np.int32).reshape(3, -1),
        smooth=np.ones(mesh.triangle_count, bool),
        corner_normals=np.stack([np.einsum("tij,jt->it", turn, one) for one in normals]),
        generated=mesh.generated[:, corners] if mesh.generated.size else mesh.generated,
    )
