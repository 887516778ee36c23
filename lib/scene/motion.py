# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves while the shutter is open, and the scene as it stands at one moment of that time.

The shutter time runs from 0, where it opens, to 1, where it closes. Keys are equally spaced over it, the first at 0 and the last at 1,
and between them everything moves as Cycles defines it (transform_motion_decompose and camera.cpp in its tree).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.spatial.transform import Rotation

from ..errors import EtalonError
from .mesh import Mesh
from .scene import Scene


@dataclass(frozen=True)
class Motion:
    """Keys of a scene's objects and camera, at least two each, and the shutter's curve.

    objects: index of the object -> (k, 3, 4) `world_from_object`. positions: index of the object -> (k, 3, v) vertices in object space, for
    meshes that deform, in the order in which the scene's mesh has them. camera: (k, 3, 4) `world_from_camera`, rigid; None where it stands
    still. shutter: (n,) how far it is open at equally spaced times, linear between; None where it opens and closes at once.
    """

    objects: Mapping[int, np.ndarray] = field(default_factory=dict)
    positions: Mapping[int, np.ndarray] = field(default_factory=dict)
    camera: np.ndarray | None = None
    shutter: np.ndarray | None = None


def split_interval(keys: int, time: float) -> tuple[int, float]:
    """The key before `time`, 0 to 1, and how far (0 to 1) it lies on the way to the next of `keys` keys."""
    first = min(int(time * (keys - 1)), keys - 2)
    return first, time * (keys - 1) - first


def interpolate_linearly(keys: np.ndarray, time: float) -> np.ndarray:
    """Values at `time`, 0 to 1, between keys (k, ...)."""
    first, share = split_interval(len(keys), time)
    return (1.0 - share) * keys[first] + share * keys[first + 1]


def decompose(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A rotation (3, 3) and an upper triangular stretch (3, 3) whose product is the linear part of a (3, 4) map.

    The stretch has the scales on its diagonal, all negative where the map mirrors, and shears above it.
    """
    rotation, stretch = np.linalg.qr(matrix[:, :3])
    signs = np.where(np.diag(stretch) < 0.0, -1.0, 1.0)
    rotation, stretch = rotation * signs, stretch * signs[:, None]
    if np.linalg.det(rotation) < 0.0:
        return -rotation, -stretch
    return rotation, stretch


def interpolate_transforms(keys: np.ndarray, time: float) -> np.ndarray:
    """The (3, 4) affine map at `time`, 0 to 1, between keys (k, 3, 4).

    Translation, scale and shear are linear in time. The rotation turns at constant speed about one axis, by the smaller angle.
    """
    first, share = split_interval(len(keys), time)
    (start, stretch), (stop, last_stretch) = (decompose(keys[first + k]) for k in (0, 1))
    turn = Rotation.from_matrix(start.T @ stop).as_rotvec()
    rotation = start @ Rotation.from_rotvec(share * turn).as_matrix()
    linear = rotation @ ((1.0 - share) * stretch + share * last_stretch)
    return np.column_stack([linear, interpolate_linearly(keys[:, :, 3], time)])


def shutter_times(shutter: np.ndarray | None, uniforms: np.ndarray) -> np.ndarray:
    """Times (n,) from 0 to 1, by the inverse of the shutter's distribution, for `uniforms` (n,).

    The density of a time is proportional to how far the shutter is open then. Raises EtalonError for a shutter that never opens.
    """
    if shutter is None:
        return uniforms
    areas = 0.5 * (shutter[1:] + shutter[:-1])
    reached = np.concatenate([[0.0], np.cumsum(areas)])
    if not reached[-1] > 0.0 or (shutter < 0.0).any():
        raise EtalonError("The shutter curve is nowhere open, or below 0; raise its points")
    target = uniforms * reached[-1]
    piece = np.clip(np.searchsorted(reached, target, side="right") - 1, 0, areas.size - 1)
    start, slope = shutter[piece], shutter[piece + 1] - shutter[piece]
    rest = target - reached[piece]
    # start s + slope s^2 / 2 = rest, in the form that does not cancel for small slopes.
    root = start + np.sqrt(np.maximum(start**2 + 2.0 * slope * rest, 0.0))
    share = np.divide(2.0 * rest, root, out=np.zeros_like(rest), where=root > 0.0)
    return (piece + np.clip(share, 0.0, 1.0)) / areas.size


def scene_at(scene: Scene, motion: Motion, time: float) -> Scene:
    """The scene as it stands at the shutter time `time`, 0 to 1; what does not move is shared.

    Raises EtalonError for an object that has no volume, as its vertices cannot be brought back to object space, and for deforming
    meshes that are shaded smooth.
    """
    mesh = scene.mesh
    if motion.objects or motion.positions:
        mesh = _mesh_at(mesh, motion, time)
    camera = scene.camera
    if motion.camera is not None:
        camera = replace(camera, world_from_camera=interpolate_transforms(motion.camera, time))
    return replace(scene, mesh=mesh, camera=camera)


def _mesh_at(mesh: Mesh, motion: Motion, time: float) -> Mesh:
    """The mesh with the objects that move where they are at `time`."""
    vertices, normals, objects = mesh.vertices.copy(), mesh.corner_normals.copy(), list(mesh.objects)
    for index in sorted({*motion.objects, *motion.positions}):
        thing, faces = objects[index], mesh.object_index == index
        before, after = thing.world_from_object, thing.world_from_object
        if index in motion.objects:
            after = interpolate_transforms(motion.objects[index], time)
        own = np.unique(mesh.triangles[:, faces])
        if index in motion.positions:
            if mesh.smooth[faces].any():
                raise EtalonError(f"{thing.name}: a smooth mesh that deforms is not supported; shade it flat")
            local = interpolate_linearly(motion.positions[index], time)
        else:
            local = _to_object_space(thing.name, before, vertices[:, own])
        vertices[:, own] = after[:, :3] @ local + after[:, 3:]
        if normals.size and index in motion.objects:
            change = np.linalg.inv(after[:, :3] @ np.linalg.inv(before[:, :3])).T
            turned = np.einsum("ij,cjt->cit", change, normals[:, :, faces])
            normals[:, :, faces] = turned / np.linalg.norm(turned, axis=1, keepdims=True)
        objects[index] = replace(thing, world_from_object=after)
    return replace(mesh, vertices=vertices, corner_normals=normals, objects=tuple(objects))


def _to_object_space(name: str, matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """World points (3, v) in the object space of a (3, 4) map."""
    try:
        return np.linalg.solve(matrix[:, :3], points - matrix[:, 3:])
    except np.linalg.LinAlgError as error:
        raise EtalonError(f"{name}: moves with a scale of 0 at this frame; give it a scale above 0") from error
