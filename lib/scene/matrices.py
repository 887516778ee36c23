# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's matrices as float64 arrays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_SHEAR = 1e-4


def affine(matrix: Sequence[Sequence[float]]) -> np.ndarray:
    """(3, 4) float64 copy of a 4 x 4 matrix without its last row."""
    return np.array(matrix, dtype=np.float64)[:3]


def is_sheared(matrix: np.ndarray) -> bool:
    """Whether the axes of the (3, 4) `matrix` are not at right angles, or one has no length."""
    lengths = np.linalg.norm(matrix[:, :3], axis=0)
    if not np.all(lengths > 0.0):
        return True
    axes = matrix[:, :3] / lengths
    return bool(np.abs(axes.T @ axes - np.eye(3)).max() > _SHEAR)
