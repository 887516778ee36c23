# SPDX-License-Identifier: GPL-3.0-or-later
"""A closed box of diffuse walls with a square lamp in its ceiling.

This file has its patches, its picture, and the same box as a scene. The box is the cube from 0 to 1. Patches are the
squares of an n x n grid on each wall; n is a multiple of 4, since the lamp fills the middle half of the ceiling.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..sampling.warps import cosine_hemisphere
from ..scene.camera import Camera
from ..scene.expressions import Constant
from ..scene.materials import Diffuse, Emission, Material, WeightedClosure
from ..scene.mesh import Mesh, Object
from ..scene.scene import Scene, Transport
from ..scene.world import World
from ..wavefront.camera_rays import camera_rays

WHITE, RED, GREEN, BLACK = (0.75, 0.75, 0.75), (0.6, 0.15, 0.1), (0.15, 0.5, 0.15), (0.0, 0.0, 0.0)
_ALBEDOS = (RED, GREEN, WHITE, WHITE, WHITE, WHITE)
"""Of the walls x = 0, x = 1, y = 0, y = 1, z = 0, z = 1."""
LAMP = 1.0
"""Radiance of the lamp, W m^-2 sr^-1."""
BOUNCES = 40
"""Scatterings of a path less one: what is left after them is below 1e-5."""
SIDE, INSIDE = 40, (0.25, 0.75)
_MIDPOINTS = (np.arange(16) + 0.5) / 16


@dataclass(frozen=True)
class Patches:
    """The N patches of a grid.

    `corners` (N, 4, 3) run counterclockwise about `normals` (N, 3), which point inwards. `albedos` and `emitted` (N, 3) are reflectance and
    emitted radiance.
    """

    count: int
    corners: np.ndarray
    normals: np.ndarray
    albedos: np.ndarray
    emitted: np.ndarray

    @property
    def centers(self) -> np.ndarray:
        """The middle of each patch, (N, 3)."""
        return self.corners.mean(axis=1)


def make_patches(count: int) -> Patches:
    """The patches of `count` x `count` squares on each wall."""
    step = np.arange(count) / count
    corners, normals, albedos, emitted = [], [], [], []
    for wall, albedo in enumerate(_ALBEDOS):
        axis, end = divmod(wall, 2)
        u, v = (axis + 1) % 3, (axis + 2) % 3
        inward = np.zeros(3)
        inward[axis] = 1.0 - 2.0 * end
        for a in step:
            for b in step:
                turn = [(0, 0), (1, 0), (1, 1), (0, 1)] if end == 0 else [(0, 0), (0, 1), (1, 1), (1, 0)]
                square = np.zeros((4, 3))
                square[:, axis] = end
                square[:, u] = [a + i / count for i, _ in turn]
                square[:, v] = [b + j / count for _, j in turn]
                middle = square.mean(axis=0)
                is_lamp = wall == 5 and bool((np.abs(middle[:2] - 0.5) < 0.25).all())
                corners.append(square)
                normals.append(inward)
                albedos.append(BLACK if is_lamp else albedo)
                emitted.append([LAMP if is_lamp else 0.0] * 3)
    return Patches(count, np.array(corners), np.array(normals), np.array(albedos), np.array(emitted))


def find_patch(points: np.ndarray, wall: np.ndarray, count: int) -> np.ndarray:
    """The number of the patch that each point (n, 3) of a `wall` (n,) lies in."""
    axis = wall // 2
    rows = np.arange(len(points))
    u, v = (np.minimum((points[rows, (axis + k) % 3] * count).astype(int), count - 1) for k in (1, 2))
    return (wall * count + u) * count + v


def make_camera() -> Camera:
    """A camera before the front wall, which looks along +y."""
    step = 1.6 / SIDE
    plane = np.array([[step, 0.0, -0.8], [0.0, step, -0.8]])
    # Columns: right, up, and back along -y.
    axes = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    return Camera("PERSPECTIVE", SIDE, SIDE, plane, np.c_[axes, [0.5, 0.02, 0.5]], 0.0, 1e6)


def measure_distances(points: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far rays inside the box go until they meet a wall, and its axis.

    They start at points (n, 3) and go along unit directions (n, 3).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = np.where(directions > 0.0, (1.0 - points) / directions, points / -directions)
    distance = np.where(directions == 0.0, np.inf, distance)
    axis = distance.argmin(axis=1)
    return np.take_along_axis(distance, axis[:, None], axis=1)[:, 0], axis


def find_harmonic_distance(points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """The harmonic mean distance (n,) of what points (n, 3) on walls see.

    It takes 16 x 16 directions that are distributed as the cosine.
    """
    u1, u2 = (one.ravel() for one in np.meshgrid(_MIDPOINTS, _MIDPOINTS))
    local = cosine_hemisphere(u1, u2)
    axis = np.abs(normals).argmax(axis=1)
    total = np.zeros(len(points))
    for x, y, z in local.T:
        direction = z * normals
        np.put_along_axis(direction, ((axis + 1) % 3)[:, None], x, axis=1)
        np.put_along_axis(direction, ((axis + 2) % 3)[:, None], y, axis=1)
        # A point on its own wall is at distance 0 of it, behind the ray.
        total += 1.0 / np.maximum(measure_distances(points, direction)[0], 1e-9)
    return local.shape[1] / total


def look(places: tuple[float, ...] = INSIDE) -> tuple[np.ndarray, np.ndarray]:
    """What the camera sees: points (n, 3) and walls (n,), pixels row by row from the top.

    In each pixel it looks at the `places` across times the same places up, in pixels.
    """
    row, column = np.divmod(np.arange(SIDE * SIDE), SIDE)
    dx, dy = (one.ravel() for one in np.meshgrid(places, places))
    x, y = (column[:, None] + dx).ravel(), (SIDE - 1.0 - row[:, None] + dy).ravel()
    rays = camera_rays(make_camera(), x, y, None)
    origin, direction = np.broadcast_to(rays.origin, rays.direction.shape).T, rays.direction.T
    distance, axis = measure_distances(origin, direction)
    points = np.clip(origin + distance[:, None] * direction, 0.0, 1.0)
    return points, 2 * axis + (np.take_along_axis(direction, axis[:, None], axis=1)[:, 0] > 0.0)


def average_pixels(values: np.ndarray) -> np.ndarray:
    """The picture (SIDE, SIDE, 3) of values (n, 3) at the points that the camera sees."""
    return values.reshape(SIDE, SIDE, len(INSIDE) ** 2, 3).mean(axis=2)


def find_plain_pixels() -> np.ndarray:
    """Which pixels (SIDE, SIDE) show one wall alone and no part of the lamp.

    Their means are computed without finding an edge.
    """
    points, wall = look((1e-6, 0.5, 1.0 - 1e-6))
    is_lamp = make_patches(4).emitted[find_patch(points, wall, 4), 0] > 0.0
    shown = np.where(is_lamp, -1, wall).reshape(SIDE, SIDE, 9)
    return (shown == shown[..., :1]).all(axis=2) & (shown[..., 0] >= 0)


def make_scene() -> Scene:
    """The same box as a scene, for path tracing."""
    patches = make_patches(4)
    many = len(patches.corners)
    first = 4 * np.arange(many)
    triangles = np.concatenate(
        [np.stack([first, first + 1, first + 2]), np.stack([first, first + 2, first + 3])], axis=1
    )
    names = ("Red", "Green", "White", "Lamp")
    is_lamp = patches.emitted[:, 0] > 0.0
    material = np.where(is_lamp, 3, np.minimum(np.arange(many) // 16, 2))
    walls = [
        Material(n, (WeightedClosure(Diffuse(Constant(c), Constant(0.0))),))
        for n, c in zip(names, (RED, GREEN, WHITE), strict=False)
    ]
    lamp = Material("Lamp", (WeightedClosure(Emission(Constant((LAMP, LAMP, LAMP)))),))
    mesh = Mesh(
        vertices=patches.corners.reshape(-1, 3).T.copy(),
        triangles=triangles.astype(np.int32),
        material_index=np.tile(material, 2).astype(np.int32),
        object_index=np.zeros(2 * many, np.int32),
        smooth=np.zeros(2 * many, bool),
        corner_normals=np.zeros((3, 3, 0), np.float32),
        objects=(Object("Box", np.eye(4)[:3]),),
    )
    return Scene("box", mesh, (*walls, lamp), (), World(), make_camera(), Transport(BOUNCES))
