# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether light that leaves a face can meet another face.

It cannot in a plane, nor outside a closed convex body.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ..scene.camera import Camera
from ..scene.mesh import Mesh
from ..scene.rays import EVERY
from ..scene.shells import directed_edges, weld
from ..vectors import cross, dot

Answer = tuple[bool, str]

# Faces that are looked at first, one by one: nearly every scene that is not convex shows it by one of them.
PROBES = 16
# Pairs of a face and a vertex that are looked at in all; half a second's work.
MOST_PAIRS = 6e8
_BLOCK = 200_000
# A vertex counts as on a face's plane up to half the height, in units of the face's largest coordinate about the scene's centre, at
# which rays set out from it (raycaster.py): what stands no higher cannot be met. Vertices come from a few steps in float32, so that the
# faces of one flat polygon are turned against each other by some such units over a face's height; by no more than this angle, in radians.
_TOLERANCE = 1.5 * 2.0**-23
_STEPS = 12.0
_LARGEST_TURN = 2e-3


def meets_again(mesh: Mesh, camera: Camera, behind: list[str]) -> Answer:
    """Return whether a ray that leaves a face can meet a face, and why.

    `behind` names the materials through which light gets to back sides.

    False is a proof, up to the rounding of vertices: either all faces lie in one plane, or none has anything in front
    of it, they are closed and opaque, and the camera is outside. True may only mean that no proof was found.
    """
    count, vertices = mesh.triangle_count, mesh.vertices.shape[1]
    if count == 0:
        return False, "there are no faces"
    if any(thing.rays != EVERY for thing in mesh.objects):
        return True, "some rays pass through what hides from them"
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
    if not _closed(mesh):
        return True, "the faces leave an opening, and their back sides face each other"
    if not _outside(mesh, camera):
        return True, "the camera does not stand clear of the faces"
    return False, "the faces are one closed convex body, seen from outside"


def _shape(mesh: Mesh, batches: Iterable[np.ndarray]) -> tuple[bool, bool]:
    """Return whether all vertices lie on the planes of the faces in `batches`.

    The second result says whether they lie on or behind these planes.
    """
    center = _center(mesh)
    centered = mesh.vertices - center
    flat = True
    for faces in batches:
        planes = _planes(mesh, center, faces)
        heights = planes.normal.T @ centered
        heights -= planes.distance[:, None]
        if not _within(heights, planes, centered):
            return False, False
        flat = flat and _within(-heights, planes, centered)
    return flat, True


def _within(heights: np.ndarray, planes: _Planes, places: np.ndarray) -> bool:
    """Return whether no height (k, v) of `places` (3, v) over the planes is positive.

    A height counts as positive if it exceeds what rounding can make of zero.
    """
    for face in np.flatnonzero(heights.max(axis=1) > planes.tolerance):
        above = np.flatnonzero(heights[face] > planes.tolerance[face])
        away = np.linalg.norm(places[:, above] - planes.corner[:, face, None], axis=0)
        if np.any(heights[face, above] > planes.tolerance[face] + planes.turn[face] * away):
            return False
    return True


def _center(mesh: Mesh) -> np.ndarray:
    return 0.5 * (mesh.vertices.min(axis=1) + mesh.vertices.max(axis=1))[:, None]


class _Planes(NamedTuple):
    """Planes of k faces.

    They are a corner and the unit normal (3, k), distance from the centre, tolerance and turn (k,); see above.
    """

    corner: np.ndarray
    normal: np.ndarray
    distance: np.ndarray
    tolerance: np.ndarray
    turn: np.ndarray


def _planes(mesh: Mesh, center: np.ndarray, faces: np.ndarray) -> _Planes:
    """A face without area has a normal of zero: nothing lies above it."""
    a, b, c = (mesh.vertices[:, corner] - center for corner in mesh.triangles[:, faces])
    normal = cross(b - a, c - a)
    doubled = np.sqrt(dot(normal, normal))
    normal /= np.where(doubled > 0.0, doubled, 1.0)
    tolerance = _TOLERANCE * np.abs(np.concatenate([a, b, c])).max(axis=0)
    longest = np.sqrt(np.max([dot(x - y, x - y) for x, y in ((a, b), (b, c), (c, a))], axis=0))
    turn = _STEPS * tolerance * longest / np.where(doubled > 0.0, doubled, np.inf)
    return _Planes(a, normal, dot(normal, a), tolerance, np.where(turn <= _LARGEST_TURN, turn, 0.0))


def _closed(mesh: Mesh) -> bool:
    """Return whether every edge belongs to two faces that run along it in opposite directions.

    Vertices in one place count as one.
    """
    along, against = directed_edges(weld(mesh.vertices, mesh.triangles))
    return bool(np.all(along == against) and np.all(along[1:] != along[:-1]))


def _outside(mesh: Mesh, camera: Camera) -> bool:
    """Whether one face's plane has all places where camera rays begin in front of it."""
    center = _center(mesh)
    planes = _planes(mesh, center, np.arange(mesh.triangle_count))
    places, margin = _starts(camera)
    nearest = (planes.normal.T @ (places - center)).min(axis=1) - planes.distance
    return bool(np.any(nearest > margin + _LARGEST_TURN * np.linalg.norm(places - center)))


def _starts(camera: Camera) -> tuple[np.ndarray, float]:
    """Return points (3, k) and a radius that bound the origins of camera rays.

    Camera rays begin in balls about the points, or between them.
    """
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
