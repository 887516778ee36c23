# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of faces and objects."""

from __future__ import annotations

import numpy as np

from ..plural import plural
from ..scene.findings import OVERLAPPING_FACES, Finding, list_areas, list_names
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..vectors import cross, dot


def find_overlapping_faces(scene: Scene) -> Finding | None:
    """Find faces that overlap in one plane, by the objects that they belong to.

    The largest area is first.
    """
    overlaps = scene.mesh.overlaps
    if not overlaps.count:
        return None
    areas: dict[tuple[str, str], float] = {}
    one, other = scene.mesh.object_index[overlaps.pairs].astype(np.int64)
    # One number for each two objects: such are sorted fast, and there may be millions.
    count = len(scene.mesh.objects)
    both, which = np.unique(np.minimum(one, other) * count + np.maximum(one, other), return_inverse=True)
    for a, b, area in zip(*np.divmod(both, count), np.bincount(which, overlaps.area), strict=True):
        names = scene.mesh.objects[a].name, scene.mesh.objects[b].name
        areas[names] = areas.get(names, 0.0) + float(area)
    pairs_of_objects = [(_of(names), area) for names, area in areas.items()]
    return Finding(
        OVERLAPPING_FACES,
        f"Faces share a plane and an area of it: {list_areas(pairs_of_objects, 'pair of objects', 'pairs of objects')}.",
        "Cycles has such faces hide all light from each other; the reference treats them as one surface.",
        "Move one of each pair by a millimetre, or delete it.",
    )


def _of(names: tuple[str, str]) -> str:
    return f"'{names[0]}' with itself" if names[0] == names[1] else f"'{names[0]}' and '{names[1]}'"


def find_turned_normals(scene: Scene) -> Finding | None:
    """Find smooth faces whose shading normals all point away from the face's own side."""
    mesh = scene.mesh
    if not mesh.corner_normals.shape[2]:
        return None
    smooth = np.flatnonzero(mesh.smooth)
    a, b, c = (np.take(mesh.vertices, corner[smooth], axis=1) for corner in mesh.triangles)
    face = cross(b - a, c - a)
    turned = np.ones(smooth.size, bool)
    for corner in mesh.corner_normals:
        turned &= dot(face, corner[:, smooth].astype(np.float64)) < 0.0
    if not turned.any():
        return None
    names = _objects_of(mesh, smooth[turned])
    count = int(turned.sum())
    return Finding(
        "normals against faces",
        f"{plural(count, 'triangle has', 'triangles have')} shading normals that point to the other side: {list_names(names)}.",
        "Such faces are dark, or lit from behind, in both renderers.",
        "Recalculate the normals, or clear custom normals.",
    )


def find_mirrored(scene: Scene) -> Finding | None:
    """Objects whose transform mirrors them."""
    mirrored = [o.name for o in scene.mesh.objects if np.linalg.det(o.world_from_object[:, :3]) < 0.0]
    if not mirrored:
        return None
    return Finding(
        "negative scale",
        f"{plural(len(mirrored), 'object is', 'objects are')} mirrored by a negative scale: {list_names(list(dict.fromkeys(mirrored)))}.",
        "Both renderers show them alike; tangents, and so normal maps and anisotropy, are mirrored too.",
        "Apply the scale if that is not meant.",
    )


def _objects_of(mesh: Mesh, triangles: np.ndarray) -> list[str]:
    """The names of the objects that triangles belong to, each once."""
    return list(dict.fromkeys(mesh.objects[k].name for k in np.unique(mesh.object_index[triangles])))
