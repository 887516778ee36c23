# SPDX-License-Identifier: GPL-3.0-or-later
"""Instances of local meshes, placed in the world and joined into one set of arrays."""

from __future__ import annotations

import logging
import os
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ..errors import EtalonError
from .mesh import Mesh, Object
from .normals import normal_matrices

UNKNOWN_MEMORY = 8 * 2**30
"""Bytes of memory where the system does not tell."""

# What tracing needs for a triangle beside the joined arrays: Embree's tree and what it is built from, planes, offsets. Measured.
_TRACED = 180
# What a vertex and a triangle of a flat mesh take at least.
_VERTEX, _TRIANGLE = 3 * 8, _TRACED + 3 * 4 + 4 + 4 + 1

_BLOCK = 1 << 16
_LOG = logging.getLogger(__name__)

# Below this ratio of height to longest edge the normal of a triangle is rounding error.
_THINNEST = 1e-12


@dataclass(frozen=True)
class LocalMesh:
    """A mesh before it is placed: v vertices, t triangles, in object space.

    positions (3, v) float32; triangles (3, t) int32; slot (t,) int32, the material slot as stored; smooth (t,) bool;
    corner_normals (3 corners, 3, t) float32, or None when no face is smooth; uvs: map name -> (3 corners, 2, t) float32;
    generated (3, v) float32, or None when nobody asks; attributes: name -> (3 corners, 6, t) float32.
    `displaced`: a material may move vertices of it.
    """

    positions: np.ndarray
    triangles: np.ndarray
    slot: np.ndarray
    smooth: np.ndarray
    corner_normals: np.ndarray | None
    uvs: dict[str, np.ndarray]
    generated: np.ndarray | None
    attributes: dict[str, np.ndarray]
    displaced: bool = False


@dataclass(frozen=True)
class _Instance:
    """One object: its index, its map to the world, and its materials.

    The materials are the scene's, one for each of its slots.
    """

    index: int
    matrix: np.ndarray
    materials: np.ndarray


@dataclass
class _Group:
    local: LocalMesh
    instances: list[_Instance] = field(default_factory=list)


class Placements:
    """Collects instances, counts what they will need, and joins them when all are known."""

    def __init__(self, limit: int | None = None) -> None:
        """`limit`, in bytes, is half of the machine's memory unless given."""
        self._limit = _memory() // 2 if limit is None else limit
        self._bytes = 0
        self._groups: dict[int, _Group] = {}
        self._objects: list[Object] = []

    def require_room(self, name: str, vertices: int, triangles: int) -> None:
        """Raise EtalonError where a mesh, which is not read yet, would need too much memory.

        It has so many `vertices` and `triangles`; `name` is its object's.
        """
        self._require(name, vertices * _VERTEX + triangles * _TRIANGLE)

    def add(self, thing: Object, local: LocalMesh, materials: np.ndarray) -> None:
        """Place `local` as the object `thing`; `materials` (slots,) are the scene's indices.

        Raises EtalonError, before anything is allocated, when all instances together would need too much memory.
        """
        self._require(thing.name, _bytes_of(local))
        self._bytes += _bytes_of(local)
        if not np.isfinite(thing.world_from_object).all():
            raise EtalonError(f"{thing.name}: its transform is not finite; reset its location, rotation and scale")
        group = self._groups.setdefault(id(local), _Group(local))
        group.instances.append(_Instance(len(self._objects), thing.world_from_object, materials))
        self._objects.append(thing)

    def _require(self, name: str, more: int) -> None:
        """Raise EtalonError where `more` bytes are too many."""
        if self._bytes + more > self._limit:
            raise EtalonError(
                f"{name}: with this instance the scene needs more than {self._limit / 2**30:.1f} GB, half of the memory here; "
                "reduce instances or render levels"
            )

    def join(self, uv_maps: frozenset[str], generated: bool, attributes: frozenset[str] = frozenset()) -> Mesh:
        """All instances as one mesh in world space; faces without area are left out."""
        groups = list(self._groups.values())
        vertices = sum(g.local.positions.shape[1] * len(g.instances) for g in groups)
        triangles = sum(g.local.triangles.shape[1] * len(g.instances) for g in groups)
        smooth = any(g.local.corner_normals is not None for g in groups)
        mesh = Mesh(
            vertices=np.empty((3, vertices)),
            triangles=np.empty((3, triangles), np.int32),
            material_index=np.empty(triangles, np.int32),
            object_index=np.empty(triangles, np.int32),
            smooth=np.empty(triangles, bool),
            corner_normals=np.empty((3, 3, triangles if smooth else 0), np.float32),
            objects=tuple(self._objects),
            uvs={name: np.empty((3, 2, triangles), np.float32) for name in sorted(uv_maps)},
            generated=np.empty((3, vertices if generated else 0), np.float32),
            attributes={name: np.empty((3, 6, triangles), np.float32) for name in sorted(attributes)},
        )
        first_vertex = first_triangle = 0
        for group in groups:
            for instances in _batches(group):
                _fill(mesh, group, instances, first_vertex, first_triangle)
                first_vertex += group.local.positions.shape[1] * len(instances)
                first_triangle += group.local.triangles.shape[1] * len(instances)
        return _without_degenerate(mesh)


def _memory() -> int:
    """Bytes of memory that the machine has."""
    try:
        return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):  # Windows has no such call
        return UNKNOWN_MEMORY


def _bytes_of(local: LocalMesh) -> int:
    """Bytes that one instance takes, traced, corner normals included."""
    vertex, triangle = _VERTEX, _TRIANGLE + 36 + 24 * len(local.uvs) + 72 * len(local.attributes)
    if local.generated is not None:
        vertex += 3 * 4
    return vertex * local.positions.shape[1] + triangle * local.triangles.shape[1]


def _batches(group: _Group) -> Iterator[list[_Instance]]:
    """The instances in batches that fit the cache.

    Many small instances thus cost no more than a few large ones.
    """
    step = max(1, _BLOCK // max(1, group.local.triangles.shape[1]))
    for first in range(0, len(group.instances), step):
        yield group.instances[first : first + step]


def _fill(mesh: Mesh, group: _Group, instances: list[_Instance], first_vertex: int, first_triangle: int) -> None:
    """Write `instances` of `group` into the joined arrays.

    They begin at the given vertex and triangle.
    """
    local = group.local
    k, v, t = len(instances), local.positions.shape[1], local.triangles.shape[1]
    at_vertices = slice(first_vertex, first_vertex + k * v)
    at_triangles = slice(first_triangle, first_triangle + k * t)
    matrices = np.stack([one.matrix for one in instances])
    linear = matrices[:, :, :3]
    mirrored = np.linalg.det(linear) < 0.0

    placed = np.matmul(linear, local.positions.astype(np.float64)) + matrices[:, :, 3:]
    mesh.vertices[:, at_vertices] = placed.transpose(1, 0, 2).reshape(3, -1)
    offsets = (first_vertex + v * np.arange(k, dtype=np.int32))[None, :, None]
    triangles = local.triangles[:, None, :] + offsets
    # A mirrored copy would turn inside out; Cycles keeps its normals where the object has them.
    triangles[1:, mirrored] = triangles[:0:-1, mirrored]
    mesh.triangles[:, at_triangles] = triangles.reshape(3, -1)

    for i, one in enumerate(instances):
        part = slice(first_triangle + i * t, first_triangle + (i + 1) * t)
        mesh.material_index[part] = one.materials[np.clip(local.slot, 0, one.materials.size - 1)]
        mesh.object_index[part] = one.index
    mesh.smooth[at_triangles] = np.tile(local.smooth, k)
    if mesh.corner_normals.size:
        _fill_normals(mesh, group, linear, mirrored, at_triangles)
    for name, values in mesh.uvs.items():
        values[:, :, at_triangles] = _mirrored_corners(local.uvs[name][:, :, None, :], mirrored).reshape(3, 2, -1)
    for name, values in mesh.attributes.items():
        corners = local.attributes[name][:, :, None, :]
        values[:, :, at_triangles] = _mirrored_corners(corners, mirrored).reshape(3, 6, -1)
    if mesh.generated.size:
        mesh.generated[:, at_vertices] = np.tile(local.generated, (1, k))


def _fill_normals(mesh: Mesh, group: _Group, linear: np.ndarray, mirrored: np.ndarray, at: slice) -> None:
    """Corner normals of the instances.

    Cycles mixes an instance's normals in object space, as those of a mesh that is displaced, but turns those of another mesh with
    one user into unit vectors of the world first: so the latter are normalised, and the former keep the lengths that their
    transform gives them.
    """
    local = group.local
    mixed_in_world = len(group.instances) == 1 and not local.displaced
    if local.corner_normals is None:
        mesh.corner_normals[:, :, at] = _face_normals(mesh, at)
        return
    turns = normal_matrices(linear).astype(np.float32)
    for corner in range(3):
        normals = np.matmul(turns, local.corner_normals[corner])
        if corner:
            normals[mirrored] = np.matmul(turns[mirrored], local.corner_normals[3 - corner])
        length = np.sqrt(np.einsum("kct,kct->kt", normals, normals))[:, None, :]
        bad = ~(length > 0.0)
        if mixed_in_world:
            np.divide(normals, length, out=normals, where=~bad)
        flat = normals.transpose(1, 0, 2).reshape(3, -1)
        if bad.any():
            flat = np.where(bad.reshape(-1), _face_normals(mesh, at), flat)
        mesh.corner_normals[corner, :, at] = flat


def _mirrored_corners(values: np.ndarray, mirrored: np.ndarray) -> np.ndarray:
    """`values` (3 corners, c, 1, t) once for each instance, (3, c, k, t).

    Corners 1 and 2 are swapped where the instance is mirrored.
    """
    if not mirrored.any():
        return np.broadcast_to(values, (*values.shape[:2], mirrored.size, values.shape[3]))
    return np.where(mirrored[:, None], values[[0, 2, 1]], values)


def have_area(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(t,) whether triangles (3, t) of world vertices (3, v) have an area, and are thus kept when meshes are joined."""
    found = np.empty(triangles.shape[1], bool)
    for first in range(0, found.size, _BLOCK):
        at = slice(first, first + _BLOCK)
        u, v = _edges(vertices, triangles[:, at])
        w = v - u
        normal = np.cross(u, v, axis=0)
        longest = np.maximum(np.einsum("cn,cn->n", u, u), np.einsum("cn,cn->n", v, v))
        longest = np.maximum(longest, np.einsum("cn,cn->n", w, w))
        found[at] = np.sqrt(np.einsum("cn,cn->n", normal, normal)) > _THINNEST * longest
    return found


def _edges(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    a, b, c = (np.take(vertices, triangles[i], axis=1) for i in range(3))
    return b - a, c - a


def _face_normals(mesh: Mesh, at: slice) -> np.ndarray:
    """(3, n) unit normals of the triangles; +z for those without area."""
    normals = np.cross(*_edges(mesh.vertices, mesh.triangles[:, at]), axis=0)
    length = np.sqrt(np.einsum("cn,cn->n", normals, normals))
    up = np.array([[0.0], [0.0], [1.0]])
    return np.where(length > 0.0, normals / np.where(length > 0.0, length, 1.0), up)


def _log_degenerate(mesh: Mesh, marked: np.ndarray) -> None:
    """Say how many faces have no area, (t,) bool, once for all objects of one name."""
    counts: Counter[str] = Counter()
    for index in np.flatnonzero(per_object := np.bincount(mesh.object_index[marked])):
        counts[mesh.objects[index].name] += int(per_object[index])
    for name, count in counts.items():
        _LOG.warning("%s: %d faces without area left out", name, count)


def _without_degenerate(mesh: Mesh) -> Mesh:
    """The mesh without triangles that have no area, each object's count logged."""
    keep = have_area(mesh.vertices, mesh.triangles)
    if keep.all():
        return mesh
    _log_degenerate(mesh, ~keep)
    return Mesh(
        vertices=mesh.vertices,
        triangles=np.compress(keep, mesh.triangles, axis=1),
        material_index=mesh.material_index[keep],
        object_index=mesh.object_index[keep],
        smooth=mesh.smooth[keep],
        corner_normals=np.compress(keep, mesh.corner_normals, axis=2)
        if mesh.corner_normals.size
        else mesh.corner_normals,
        objects=mesh.objects,
        uvs={name: np.compress(keep, values, axis=2) for name, values in mesh.uvs.items()},
        generated=mesh.generated,
        attributes={name: np.compress(keep, values, axis=2) for name, values in mesh.attributes.items()},
    )
