# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement: the vertices of a mesh are moved before anything else is done with it.

A vertex is moved once, by the material and with the attributes of the first triangle that has it and is displaced, as in
Cycles. The vertex's normal counts, whether or not its faces are shaded smooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..errors import Refusal, Refused, SceneError
from ..plural import plural
from ..scene.expressions import Coordinates, ObjectInfo
from ..scene.materials import Displacement
from ..scene.mesh import FARTHEST, UNDISPLACED, UNDISPLACED_NORMAL, Mesh, Object, near
from ..scene.normals import normal_matrices
from ..scene.placements import LocalMesh
from ..textures.evaluate import evaluate
from ..textures.fold import walk
from ..textures.images import ImageSet
from ..vectors import cross, dot, normalize
from .surface import SurfacePoints, SurfaceTables

_OF_THE_WORLD = ("POSITION", "SHADING_NORMAL", "TRUE_NORMAL")
# Triangles lower than this times their longest edge have no normal in single precision.
_THINNEST = 1e-6


def depends_on_object(displacement: Displacement) -> bool:
    """Whether users of one mesh that stand elsewhere would be moved otherwise."""
    nodes = list(walk(displacement.offset))
    asked = any(isinstance(node, Coordinates) and node.kind in _OF_THE_WORLD for node in nodes)
    return displacement.space == "WORLD" or asked or any(isinstance(node, ObjectInfo) for node in nodes)


@dataclass(frozen=True)
class Normals:
    """The normals of a mesh before it is displaced.

    corners (3 corners, 3, t), unit, in object space: those of the vertices, also where faces are flat, unless `sharp` (t,) bool says
    which faces are. Then each corner has a normal of its own.
    """

    corners: np.ndarray
    sharp: np.ndarray | None = None


def displace(
    local: LocalMesh, normals: Normals, thing: Object, displacements: Sequence[Displacement | None], images: ImageSet
) -> LocalMesh:
    """Return the mesh with its vertices moved by the displacements of its slots.

    Normals are made anew. `thing` is the object that has the mesh. Raises SceneError where a vertex would not be at a finite place,
    and Refused where faces without area leave the new normals undefined.
    """
    slot = np.clip(local.slot, 0, len(displacements) - 1)
    is_moved = np.array([one is not None for one in displacements])[slot]
    vertex, triangle, corner = _first_corners(local.triangles, is_moved)
    order = _corner_order(thing)
    tables = SurfaceTables(_placed(local, normals.corners, thing, order))
    positions = local.positions.copy()
    for index, displacement in enumerate(displacements):
        at = np.flatnonzero(slot[triangle] == index)
        if displacement is not None and at.size:
            points = _corner_points(tables, triangle[at], order[corner[at]])
            with np.errstate(all="ignore"):  # what overflows is named below
                positions[:, vertex[at]] += _offsets(displacement, points, images)
    bad = int((~near(positions)).sum())
    if bad:
        raise SceneError(
            f"{thing.name}: {plural(bad, 'coordinate')} of displaced vertices not finite or beyond {FARTHEST:g}; "
            "change the displacement of its materials"
        )
    is_bumped = np.array([one is not None and one.bumps for one in displacements])[slot]
    turned = None
    if local.smooth.any():
        if normals.sharp is None:
            turned = _moved_vertex_normals(thing.name, local, positions, normals.corners, is_moved & ~is_bumped)
        else:
            turned = _moved_corner_normals(thing.name, local, positions, normals.corners, normals.sharp)
        turned = turned.astype(np.float32)
    moved = replace(local, positions=positions, corner_normals=turned, displaced=True)
    return _with_undisplaced(moved, local, normals.corners, is_bumped) if is_bumped.any() else moved


def _with_undisplaced(moved: LocalMesh, local: LocalMesh, before: np.ndarray, is_bumped: np.ndarray) -> LocalMesh:
    """The displaced mesh with what bumps on it need of the mesh as it was.

    Its faces that are bumped are flat: the bump has the shading normal, and light counts by it and the face.
    """
    values = np.zeros((3, 6, is_bumped.size), np.float32)
    places, normals = values.copy(), values.copy()
    places[:, :3] = np.stack([local.positions[:, k] for k in local.triangles])
    a, b, c = places[:, :3].astype(np.float64)
    normals[:, :3] = np.where(local.smooth, before, normalize(cross(b - a, c - a)))
    attributes = {**moved.attributes, UNDISPLACED: places, UNDISPLACED_NORMAL: normals}
    return replace(moved, smooth=local.smooth & ~is_bumped, attributes=attributes)


def _first_corners(triangles: np.ndarray, is_moved: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Each vertex (k,) of triangles that are moved, and where it is first met.

    That is the first such triangle, and which of its corners.
    """
    faces = np.flatnonzero(is_moved)
    vertex, first = np.unique(triangles[:, faces].T.ravel(), return_index=True)
    return vertex, faces[first // 3], first % 3


def _corner_order(thing: Object) -> np.ndarray:
    """The order of the corners of an object's triangles in the world.

    A mirrored object turns them round.
    """
    return np.array([0, 2, 1] if np.linalg.det(thing.world_from_object[:, :3]) < 0.0 else [0, 1, 2])


def _placed(local: LocalMesh, corner_normals: np.ndarray, thing: Object, order: np.ndarray) -> Mesh:
    """The mesh in the world before it is displaced, with its corners in that `order`."""
    linear = thing.world_from_object[:, :3]
    turn = normal_matrices(linear[None])[0]
    return Mesh(
        vertices=linear @ local.positions + thing.world_from_object[:, 3:],
        triangles=local.triangles[order],
        material_index=local.slot,
        object_index=np.zeros_like(local.slot),
        smooth=local.smooth,
        corner_normals=np.stack([normalize(turn @ one) for one in corner_normals[order]]),
        objects=(thing,),
        uvs={name: values[order] for name, values in local.uvs.items()},
        generated=np.zeros((3, 0), np.float32) if local.generated is None else local.generated,
        attributes={name: values[order] for name, values in local.attributes.items()},
    )


def _corner_points(tables: SurfaceTables, triangle: np.ndarray, corner: np.ndarray) -> SurfacePoints:
    """The corners (k,) of triangles (k,), seen along the normal of the vertex.

    That is the shading normal of flat faces, too.
    """
    mesh = tables.mesh
    a, b, c = (mesh.vertices[:, mesh.triangles[k, triangle]] for k in range(3))
    ng = normalize(cross(b - a, c - a))
    position = mesh.vertices[:, mesh.triangles[corner, triangle]]
    u, v = ((corner == k).astype(np.float64) for k in (1, 2))
    points = SurfacePoints(tables, triangle, u, v, position, ng, ng)
    points.n = points.wo = mesh.corner_normals[corner, :, triangle].T
    return points


def _offsets(displacement: Displacement, points: SurfacePoints, images: ImageSet) -> np.ndarray:
    """The way (3, n) of each point in object space."""
    offset = evaluate(displacement.offset, points, images)
    if displacement.space == "WORLD":
        way = offset if displacement.is_vector else points.n * offset
        return points.tables.object_from_world.reshape(3, 4)[:, :3] @ np.broadcast_to(way, points.n.shape)
    if displacement.space == "OBJECT" and displacement.is_vector:
        return offset
    normal = points.coordinates("NORMAL")
    if displacement.space == "OBJECT":
        return normal * offset
    tangent, sign, _ = points.tangent_frame("")
    return tangent * offset[0] + normal * offset[1] + normalize(cross(normal, tangent)) * sign * offset[2]


def _moved_vertex_normals(
    name: str, local: LocalMesh, positions: np.ndarray, before: np.ndarray, is_moved: np.ndarray
) -> np.ndarray:
    """Corner normals (3 corners, 3, t) at displaced `positions`.

    At vertices of triangles that are moved, the normals of these are mixed. Other vertices keep theirs. Raises Refused.
    """
    moved = local.triangles[:, is_moved]
    mixed = _mixed_normals(_face_normals(name, positions, moved), moved, positions.shape[1])
    is_met = np.bincount(moved.ravel(), minlength=positions.shape[1]) > 0
    return np.stack([np.where(is_met[k], mixed[:, k], b) for k, b in zip(local.triangles, before, strict=True)])


def _moved_corner_normals(
    name: str, local: LocalMesh, positions: np.ndarray, before: np.ndarray, sharp: np.ndarray
) -> np.ndarray:
    """Corner normals (3 corners, 3, t) at displaced `positions`.

    It is for a mesh whose corners had normals of their own. To each is added what displacement adds to the mixed normal of its
    vertex; those of `sharp` faces are the faces'. Raises Refused.
    """
    faces = _face_normals(name, positions, local.triangles)
    count = positions.shape[1]
    added = _mixed_normals(faces, local.triangles, count)
    added -= _mixed_normals(_face_normals(name, local.positions, local.triangles), local.triangles, count)
    return np.stack(
        [np.where(sharp, faces, normalize(b + added[:, k])) for k, b in zip(local.triangles, before, strict=True)]
    )


def _mixed_normals(faces: np.ndarray, triangles: np.ndarray, count: int) -> np.ndarray:
    """Unit normals (3, count) of vertices, from those of triangles, `faces` (3, t).

    Cycles weighs the triangles equally where Blender weighs them by their angles.
    """
    total = np.zeros((3, count))
    for corner in triangles:
        total += np.stack([np.bincount(corner, row, count) for row in faces])
    return normalize(total)


def _face_normals(name: str, positions: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Unit normals (3, t) of triangles (3, t); raises Refused where one has no area."""
    a, b, c = (positions[:, k].astype(np.float64) for k in triangles)
    edges = b - a, c - b, a - c
    normal = cross(edges[0], -edges[2])
    longest = np.maximum.reduce([dot(edge, edge) for edge in edges])
    if (dot(normal, normal) <= (_THINNEST * longest) ** 2).any():
        what, remedy = "displacement of smooth faces without area", "merge its vertices by distance, or shade it flat"
        raise Refused([Refusal(f"object '{name}'", what, remedy)])
    return normalize(normal)
