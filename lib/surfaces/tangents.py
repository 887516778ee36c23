# SPDX-License-Identifier: GPL-3.0-or-later
"""Tangents along UV maps.

Those at the corners of triangles, in object space, are for normal maps, by the rules of MikkTSpace (Mikkelsen 2008).
"""

from __future__ import annotations

import numpy as np

from ..scene.mesh import Mesh
from ..vectors import cross, normalize

_DIGITS = 5  # to which corners' places, normals and coordinates agree when they count as one


def normal_map_frame(
    mesh: Mesh, uv_map: str, object_from_world: np.ndarray, world_from_object: np.ndarray, smooth: bool
) -> np.ndarray:
    """Return the tangent, the bitangent's sign and the unit normal at the corners.

    They are (3 corners, 7, t), in object space.

    Matrices by objects as `SurfaceTables` has them, (12, k) and (9, k); `smooth` if any face has corner normals.
    """
    m = np.take(object_from_world, mesh.object_index, axis=1).reshape(3, 4, -1)
    corners = np.stack([np.take(mesh.vertices, k, axis=1) for k in mesh.triangles])
    positions = np.einsum("ijt,kjt->kit", m[:, :3], corners) + m[:, 3]
    linear = np.take(world_from_object, mesh.object_index, axis=1).reshape(3, 3, -1)
    # The corners of a mirrored object's triangles were swapped, so that they turn about the normal of the world.
    mirrored = np.where(np.linalg.det(linear.transpose(2, 0, 1)) < 0.0, -1.0, 1.0)
    face = cross(positions[1] - positions[0], positions[2] - positions[0]) * mirrored
    normals = np.stack([face] * 3)
    if smooth:  # from the world's to the object's normals by the transpose of the object's matrix
        turned = np.einsum("jit,kjt->kit", linear, mesh.corner_normals.astype(np.float64))
        normals = np.where(mesh.smooth, turned, normals)
    normals = np.stack([_unit(one) for one in normals])
    return np.concatenate([corner_tangents(mesh, uv_map, normals, positions, mirrored), normals], axis=1)


def corner_tangents(
    mesh: Mesh, uv_map: str, normals: np.ndarray, positions: np.ndarray, mirrored: np.ndarray
) -> np.ndarray:
    """Return the unit tangent and the sign of the bitangent at corners, (3 corners, 4, t).

    The tangent points along growing u; it is zero where the map has no area.

    `mirrored` (t,) is -1 for the triangles of mirrored objects, else 1. `positions` and unit `normals` of the
    corners, (3 corners, 3, t), in object space. Corners that share place, normal, coordinates and orientation share
    the mean of their triangles' tangents, weighed by the angles there.
    """
    uv = mesh.uvs[uv_map].astype(np.float64)
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
    owner = np.broadcast_to(mesh.object_index, weights.shape)
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
