# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Mapping node."""

from __future__ import annotations

import numpy as np


def _divide(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.where(b != 0, a / np.where(b == 0, 1.0, b), 0.0)


def _rotate(matrix: list[list[np.ndarray]], vector: np.ndarray) -> np.ndarray:
    """The product with `vector`, skipping zeros: most mappings turn about one axis or none."""
    rows = []
    for row in matrix:
        terms = [coefficient * v for coefficient, v in zip(row, vector, strict=True) if np.any(coefficient)]
        rows.append(sum(terms[1:], start=terms[0]) if terms else np.zeros_like(vector[0]))
    return np.stack(np.broadcast_arrays(*rows))


def _euler_xyz(rotation: np.ndarray) -> list[list[np.ndarray]]:
    """The matrix that turns about x, then y, then z (radians); entries of shape (1,) or (n,)."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(rotation), np.cos(rotation)
    return [
        [cy * cz, sx * sy * cz - cx * sz, cx * sy * cz + sx * sz],
        [cy * sz, sx * sy * sz + cx * cz, cx * sy * sz - sx * cz],
        [-sy, sx * cy, cx * cy],
    ]


def mapping(kind: str, vector: np.ndarray, location: np.ndarray, rotation: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Map `vector` as Blender's Mapping node does.

    'POINT' scales, turns and moves it. 'TEXTURE' is the inverse, 'VECTOR' leaves out the move, and any other kind
    maps a normal.

    All (3, 1) or (3, n); division by a scale of 0 gives 0, as in Cycles.
    """
    matrix = _euler_xyz(rotation)
    if kind == "POINT":
        return _rotate(matrix, vector * scale) + location
    if kind == "VECTOR":
        return _rotate(matrix, vector * scale)
    if kind == "TEXTURE":
        inverse = [list(column) for column in zip(*matrix, strict=True)]
        return _divide(_rotate(inverse, vector - location), scale)
    normal = _rotate(matrix, _divide(vector, scale))
    return _divide(normal, np.sqrt((normal * normal).sum(axis=0)))
