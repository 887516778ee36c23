# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as it stands at one moment of the time in which the shutter is open."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..errors import EtalonError
from .interpolation import interpolate_directions, interpolate_linearly, interpolate_transforms
from .mesh import Mesh
from .motion import Motion
from .normals import normal_matrices
from .scene import Scene


def scene_at(scene: Scene, time: float) -> Scene:
    """The scene at the shutter time `time`, 0 to 1; what does not move is shared.

    The result has no motion. Raises EtalonError for an object that has no volume, as its vertices cannot be brought
    back to object space.
    """
    motion = scene.motion
    if motion is None:
        return scene
    mesh = scene.mesh
    if motion.objects or motion.positions:
        mesh = _mesh_at(mesh, motion, time)
    camera = scene.camera
    if motion.camera is not None:
        camera = replace(camera, world_from_camera=interpolate_transforms(motion.camera, time))
    return replace(scene, mesh=mesh, camera=camera, motion=None)


def _mesh_at(mesh: Mesh, motion: Motion, time: float) -> Mesh:
    """The mesh with the objects that move where they are at `time`."""
    vertices, normals, objects = mesh.vertices.copy(), mesh.corner_normals.copy(), list(mesh.objects)
    order = np.argsort(mesh.object_index, kind="stable")
    starts = np.searchsorted(mesh.object_index, np.arange(len(objects) + 1), sorter=order)
    for index in sorted({*motion.objects, *motion.positions}):
        thing, faces = objects[index], order[starts[index] : starts[index + 1]]
        before = after = thing.world_from_object
        if index in motion.objects:
            after = interpolate_transforms(motion.objects[index], time)
        own = np.unique(mesh.triangles[:, faces])
        if index in motion.positions:
            local = interpolate_linearly(motion.positions[index], time)
        else:
            local = _to_object_space(thing.name, before, vertices[:, own])
        vertices[:, own] = after[:, :3] @ local + after[:, 3:]
        if index in motion.normals:
            mixed = interpolate_directions(motion.normals[index], time)
            normals[:, :, faces] = _turn(mixed, after[:, :3]) if index in motion.objects else mixed
        elif normals.size and index in motion.objects:
            still = _to_object_normals(normals[:, :, faces], before[:, :3])
            normals[:, :, faces] = _turn(still, after[:, :3])
        objects[index] = replace(thing, world_from_object=after)
    return replace(mesh, vertices=vertices, corner_normals=normals, objects=tuple(objects))


def _to_object_space(name: str, matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """World points (3, v) in the object space of a (3, 4) map."""
    try:
        return np.linalg.solve(matrix[:, :3], points - matrix[:, 3:])
    except np.linalg.LinAlgError as error:
        raise EtalonError(f"{name}: moves with a scale of 0 at this frame; give it a scale above 0") from error


def _to_object_normals(normals: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Unit normals (3 corners, 3, n) in the object space of the linear map (3, 3), of those in world space."""
    local = np.einsum("ji,cjt->cit", matrix, normals)
    return local / np.linalg.norm(local, axis=1, keepdims=True)


def _turn(local: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Corner normals (3 corners, 3, n) in world space, of unit normals in object space.

    They keep the lengths that the linear map (3, 3) gives them: what moves is mixed in object space.
    """
    return np.einsum("ij,cjt->cit", normal_matrices(matrix[None])[0], local)
