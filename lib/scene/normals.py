# SPDX-License-Identifier: GPL-3.0-or-later
"""How a linear map turns the normals of what it places."""

from __future__ import annotations

import numpy as np


def normal_matrices(linear: np.ndarray) -> np.ndarray:
    """Return the maps of normals (n, 3, 3) for linear maps (n, 3, 3), by the cofactor matrix det(M) M^-T.

    It exists for flattened objects, too. Normals keep their side under a mirror. The largest entry of each map is 1,
    but for a map to a line or a point, which leaves no normals.
    """
    cofactor = np.cross(np.roll(linear, -1, axis=1), np.roll(linear, -2, axis=1))
    cofactor[np.linalg.det(linear) < 0.0] *= -1.0
    largest = np.abs(cofactor).max(axis=(1, 2), keepdims=True)
    return np.divide(cofactor, largest, out=cofactor, where=largest > 0.0)
