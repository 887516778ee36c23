# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether light that leaves a face can meet another one: not in a plane, and not outside a closed convex body."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..scene.camera import Camera
from ..scene.mesh import Mesh
from ..vectors import cross

Answer = tuple[bool, str]

# Faces that are looked at first, one by one: nearly every scene that is not convex shows it by one of them.
PROBES = 16
# Pairs of a face and a vertex that are looked at in all; half a second's work.
MOST_PAIRS = 2e8
_BLOCK = 2_000_000
# A vertex counts as on a plane up to half the height, in units of the face's largest coordinate about the scene's centre, at which
# rays set out from it (raycaster.py): what stands no higher cannot be met.
_TOLERANCE = 1.5 * 2.0**-23


def meets_again(mesh: Mesh, camera: Camera, behind: list[str]) -> Answer:
    """Whether a ray that leaves a face can meet a face, and why; `behind` names the materials through which light gets to back sides.

    False is a proof: either all faces lie in one plane, or none has anything in front of it, they are closed and opaque, and the camera
    is outside. True may only mean that no proof was found.
    """
    count, vertices = mesh.triangle_count, mesh.vertices.shape[1]
    if count == 0:
        return False, "there are no faces"
    flat, convex = _shape(mesh, np.unique(np.linspace(0, count - 1, PROBES).astype(np.intp))[:, None])
    if not convex:
        return True, "faces stand in front of faces"
    if count * vertices > MOST_PAIRS:
        return True, f"{count} faces are too many to prove that none stands in front of another"
    step = max(_BLOCK // vertices, 1)
    flat, convex = _shape(mesh, (np.arange(k, min(k + step, count)) for k in range(0, count, step)))
    if not convex:
        return True, "faces stand in front of faces"
    if flat:
        return False, "all faces lie in one plane"
    if behind:
        return True, f"light gets behind the faces of material '{behind[0]}'"
    if not _closed(mesh.triangles, vertices):
        return True, "the faces leave an opening, and their back sides face each other"
    if not _outside(mesh, camera):
        return True, "the camera does not stand clear of the faces"
    return False, "the faces are one closed convex body, seen from outside"


def _shape(mesh: Mesh, batches: Iterable[np.ndarray]) -> tuple[bool, bool]:
    """Whether all vertices lie on the planes of the faces in `batches`, and whether they lie on or behind them."""
    center = _center(mesh)
    centered = mesh.vertices - center
    flat = True
    for faces in batches:
        normal, distance, tolerance = _planes(mesh, center, faces)
        heights = normal.T @ centered
        heights -= distance[:, None]
        if np.any(heights.max(axis=1) > tolerance):
            return False, False
        flat = flat and bool(np.all(heights.min(axis=1) >= -tolerance))
    return flat, True


def _center(mesh: Mesh) -> np.ndarray:
    return 0.5 * (mesh.vertices.min(axis=1) + mesh.vertices.max(axis=1))[:, None]


def _planes(mesh: Mesh, center: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit normals (3, k), distances from `center` (k,) and tolerances (k,) of faces; a face without area has a normal of zero."""
    a, b, c = (mesh.vertices[:, corner] - center for corner in mesh.triangles[:, faces])
    normal = cross(b - a, c - a)
    length = np.sqrt((normal * normal).sum(axis=0))
    normal /= np.where(length > 0.0, length, 1.0)
    largest = np.abs(np.concatenate([a, b, c])).max(axis=0)
    return normal, (normal * a).sum(axis=0), _TOLERANCE * largest


def _closed(triangles: np.ndarray, vertices: int) -> bool:
    """Whether every edge belongs to two faces that run along it in opposite directions."""
    a, b, c = triangles.astype(np.int64)
    start, end = np.concatenate([a, b, c]), np.concatenate([b, c, a])
    along, against = np.sort(start * vertices + end), np.sort(end * vertices + start)
    return bool(np.all(along == against) and np.all(along[1:] != along[:-1]))


def _outside(mesh: Mesh, camera: Camera) -> bool:
    """Whether one face's plane has all places where camera rays begin in front of it."""
    center = _center(mesh)
    normal, distance, tolerance = _planes(mesh, center, np.arange(mesh.triangle_count))
    places, margin = _starts(camera)
    nearest = (normal.T @ (places - center)).min(axis=1) - distance
    return bool(np.any(nearest > margin + 4.0 * tolerance))


def _starts(camera: Camera) -> tuple[np.ndarray, float]:
    """Points (3, k) and a radius: camera rays begin in balls about the points, or between them."""
    lens = camera.aperture
    margin = 0.0
    if lens is not None:
        margin = lens.radius / min(lens.ratio, 1.0) * (1.0 + camera.clip_start / lens.focus_distance)
    place = np.zeros((3, 1))
    if camera.kind in ("PERSPECTIVE", "ORTHOGRAPHIC"):
        x, y = np.meshgrid([0.0, camera.width], [0.0, camera.height])
        across = camera.plane_from_raster @ np.stack([x.ravel(), y.ravel(), np.ones(4)])
        scale = camera.clip_start if camera.kind == "PERSPECTIVE" else 1.0
        place = np.stack([*(scale * across), np.full(4, -camera.clip_start)])
    else:
        margin += camera.clip_start
    return camera.world_from_camera[:, :3] @ place + camera.world_from_camera[:, 3:], margin
