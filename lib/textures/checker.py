# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's Checker texture."""

from __future__ import annotations

import numpy as np


def checker(vector: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Return whether the first colour shows at `vector` (3, n) times `scale`.

    It shows in cells with an odd sum of coordinates.

    Blender nudges the point by a millionth, so that a whole coordinate falls to the side of the origin; so does this.
    """
    x, y, z = np.floor((vector * scale + 1e-6) * 0.999999)
    half = 0.5 * (x + y + z)
    return half != np.floor(half)
