# SPDX-License-Identifier: GPL-3.0-or-later
"""Points on triangles, and rays that meet triangles, in the single precision of Cycles and Embree.

Part of a departure, see coplanar.py. Where a ray leaves a face in the plane of another, the rounding of single numbers decides what it
meets, so that they are rounded in the same order here. Vectors are lists of three float32 arrays, one for each axis.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..scene.mesh import Mesh

Vector = list[np.ndarray]
# Embree lets rays pass edges by so much, relative to the sum of the three edge functions.
_EDGE = np.float32(2.0**-23)


class SingleHits(NamedTuple):
    """What Embree computes for rays and triangles, (n,) each.

    Whether the ray meets the triangle at a distance of 0 or more, this distance, and the barycentrics.
    """

    meets: np.ndarray
    distance: np.ndarray
    u: np.ndarray
    v: np.ndarray


def corners_of(mesh: Mesh, triangle: np.ndarray) -> list[Vector]:
    """The three corners of the triangles (n,), rounded."""
    return [[np.take(axis, row[triangle]).astype(np.float32) for axis in mesh.vertices] for row in mesh.triangles]


def place(corners: list[Vector], u: np.ndarray, v: np.ndarray) -> Vector:
    """The points at barycentrics u, v (n,) as Cycles computes them."""
    u, v = u.astype(np.float32), v.astype(np.float32)
    return [a + u * (b - a) + v * (c - a) for a, b, c in zip(*corners, strict=True)]


def meet(corners: list[Vector], origin: Vector, direction: np.ndarray) -> SingleHits:
    """Embree's robust test of rays from `origin` along `direction` (3, n) with the triangles `corners`."""
    along = list(direction.astype(np.float32))
    a, b, c = (_minus(corner, origin) for corner in corners)
    edges = _minus(c, a), _minus(a, b), _minus(b, c)
    sums = _plus(c, a), _plus(a, b), _plus(b, c)
    sides = [_dot(_cross(edge, both), along) for edge, both in zip(edges, sums, strict=True)]
    whole = sides[0] + sides[1] + sides[2]
    slack = _EDGE * np.abs(whole)
    inside = (np.minimum.reduce(sides) >= -slack) | (np.maximum.reduce(sides) <= slack)
    normal = _normal(*edges)
    height, slope = _dot(a, normal), _dot(normal, along)
    with np.errstate(divide="ignore", invalid="ignore"):
        distance, u, v = height / slope, sides[0] / whole, sides[1] / whole
        return SingleHits(inside & (distance >= 0.0) & (slope != 0.0), distance, u, v)


def _fused(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Return a b + c, rounded once: the product of two float32 is exact in float64."""
    return (a.astype(np.float64) * b + c).astype(np.float32)


def _minus(a: Vector, b: Vector) -> Vector:
    return [x - y for x, y in zip(a, b, strict=True)]


def _plus(a: Vector, b: Vector) -> Vector:
    return [x + y for x, y in zip(a, b, strict=True)]


def _dot(a: Vector, b: Vector) -> np.ndarray:
    return _fused(a[0], b[0], _fused(a[1], b[1], a[2] * b[2]))


def _cross(a: Vector, b: Vector) -> Vector:
    return [_fused(a[j], b[k], -(a[k] * b[j])) for j, k in ((1, 2), (2, 0), (0, 1))]


def _normal(first: Vector, second: Vector, third: Vector) -> Vector:
    """The cross product of two edges: in each axis of those whose products are smaller, which cancel less."""
    axes = []
    for j, k in ((1, 2), (2, 0), (0, 1)):
        one, other = first[k] * second[j], second[k] * third[j]
        axes.append(
            np.where(
                np.abs(one) < np.abs(other),
                _fused(first[j], second[k], -one),
                _fused(second[j], third[k], -other),
            )
        )
    return axes
