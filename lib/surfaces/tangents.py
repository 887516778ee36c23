# SPDX-License-Identifier: GPL-3.0-or-later
"""Tangents along UV maps.

Those at the corners of triangles, in object space, are for normal maps, by the rules of MikkTSpace (Mikkelsen 2008).
"""

from __future__ import annotations

from threading import Lock

import numpy as np

from ..scene.mesh import Mesh
from ..vectors import cross, normalize

_DIGITS = 5  # to which corners' places, normals and coordinates agree when they count as one


class CornerFrames:
    """The frames of normal maps at corners, along one UV map.

    They are made for an object when one of its triangles is first asked for: few of a scene may have normal maps.
    Matrices by objects as `SurfaceTables` has them, (12, k) and (9, k); `smooth` if any face has corner normals.
    """

    def __init__(
        self, mesh: Mesh, uv_map: str, object_from_world: np.ndarray, world_from_object: np.ndarray, smooth: bool
    ) -> None:
        self._mesh, self._uv_map, self._smooth = mesh, uv_map, smooth
        self._object_from_world, self._world_from_object = object_from_world, world_from_object
        self._frames = np.zeros((3, 7, mesh.triangle_count))
        self._is_made = np.zeros(len(mesh.objects), bool)
        self._lock = Lock()

    def at(self, triangle: np.ndarray) -> np.ndarray:
        """Return the tangent, the bitangent's sign and the unit normal at the corners of triangles (n,).

        They are (3 corners, 7, n), in object space.
        """
        owner = np.take(self._mesh.object_index, triangle)
        if not self._is_made[owner].all():
            with self._lock:
                wanted = np.zeros_like(self._is_made)
                wanted[owner] = True
                wanted &= ~self._is_made
                some = np.flatnonzero(wanted[self._mesh.object_index])
                if some.size:  # unless another thread made them in the meantime
                    self._frames[:, :, some] = self._make(some)
                    self._is_made |= wanted
        return np.take(self._frames, triangle, axis=2)

    def _make(self, triangle: np.ndarray) -> np.ndarray:
        """The frames of triangles (n,), which are all those of their objects."""
        mesh, owner = self._mesh, self._mesh.object_index[triangle]
        m = np.take(self._object_from_world, owner, axis=1).reshape(3, 4, -1)
        corners = np.stack([np.take(mesh.vertices, k[triangle], axis=1) for k in mesh.triangles])
        positions = np.einsum("ijt,kjt->kit", m[:, :3], corners) + m[:, 3]
        linear = np.take(self._world_from_object, owner, axis=1).reshape(3, 3, -1)
        # The corners of a mirrored object's triangles were swapped, so that they turn about the normal of the world.
        mirrored = np.where(np.linalg.det(linear.transpose(2, 0, 1)) < 0.0, -1.0, 1.0)
        face = cross(positions[1] - positions[0], positions[2] - positions[0]) * mirrored
        normals = np.stack([face] * 3)
        if self._smooth:  # from the world's to the object's normals by the transpose of the object's matrix
            turned = np.einsum("jit,kjt->kit", linear, mesh.corner_normals[..., triangle].astype(np.float64))
            normals = np.where(mesh.smooth[triangle], turned, normals)
        normals = np.stack([_unit(one) for one in normals])
        uv = mesh.uvs[self._uv_map][..., triangle].astype(np.float64)
        return np.concatenate([corner_tangents(owner, uv, normals, positions, mirrored), normals], axis=1)


def corner_tangents(
    owner: np.ndarray, uv: np.ndarray, normals: np.ndarray, positions: np.ndarray, mirrored: np.ndarray
) -> np.ndarray:
    """Return the unit tangent and the sign of the bitangent at corners, (3 corners, 4, t).

    The tangent points along growing u; it is zero where the map has no area.

    `owner` (t,) is the object of each triangle, and `mirrored` (t,) is -1 for those of mirrored objects, else 1. `uv`
    (3 corners, 2, t); `positions` and unit `normals` of the corners, (3 corners, 3, t), in object space. Corners that
    share place, normal, coordinates and orientation share the mean of their triangles' tangents, weighed by the angles
    there.
    """
    edge1, edge2 = positions[1] - positions[0], positions[2] - positions[0]
    (u1, v1), (u2, v2) = uv[1] - uv[0], uv[2] - uv[0]
    area = u1 * v2 - v1 * u2
    along = _unit((edge1 * v2 - edge2 * v1) * np.sign(area))
    tangents = np.empty_like(positions)
    weights = np.empty(positions.shape[::2])
    for k in range(3):
        n = normals[k]
        tangents[k] = _unit(along - n * (n * along).sum(axis=0))
        sides = [
            _unit(d - n * (n * d).sum(axis=0))
            for d in (positions[k - 1] - positions[k], positions[k - 2] - positions[k])
        ]
        weights[k] = np.arccos(np.clip((sides[0] * sides[1]).sum(axis=0), -1.0, 1.0))
    owner = np.broadcast_to(owner, weights.shape)
    places = np.concatenate([positions, normals, uv], axis=1).transpose(0, 2, 1).reshape(-1, 8)
    keys = np.column_stack([np.round(places, _DIGITS) + 0.0, owner.ravel(), np.tile(area > 0.0, 3)])
    rows = np.ascontiguousarray(keys).view(np.dtype((np.void, keys.dtype.itemsize * keys.shape[1]))).ravel()
    _, group = np.unique(rows, return_inverse=True)
    flat = (tangents * weights[:, None]).transpose(1, 0, 2).reshape(3, -1)
    shared = np.stack([np.bincount(group, weights=row)[group] for row in flat]).reshape(3, 3, -1).transpose(1, 0, 2)
    sign = np.broadcast_to(np.where(area * mirrored > 0.0, 1.0, -1.0), weights.shape)
    return np.concatenate([_unit(shared.transpose(1, 0, 2)).transpose(1, 0, 2), sign[:, None]], axis=1)


def uv_tangents(mesh: Mesh, uv_map: str, triangle: np.ndarray) -> np.ndarray:
    """The directions (3, n) in which u grows fastest on flat triangles (n,), dP/du."""
    table = mesh.uvs.get(uv_map)
    if table is None:
        return np.zeros((3, triangle.size))
    a, b, c = np.take(mesh.triangles, triangle, axis=1)
    corner = np.take(mesh.vertices, a, axis=1)
    edge1, edge2 = np.take(mesh.vertices, b, axis=1) - corner, np.take(mesh.vertices, c, axis=1) - corner
    uv = np.take(table, triangle, axis=2).astype(np.float64)
    v1, v2 = uv[1, 1] - uv[0, 1], uv[2, 1] - uv[0, 1]
    u1, u2 = uv[1, 0] - uv[0, 0], uv[2, 0] - uv[0, 0]
    return normalize((edge1 * v2 - edge2 * v1) * np.copysign(1.0, u1 * v2 - u2 * v1))


def _unit(v: np.ndarray) -> np.ndarray:
    """Unit vectors along the first axis; zero stays zero."""
    length = np.sqrt((v * v).sum(axis=0))
    return v / np.where(length > 1e-30, length, 1.0)
