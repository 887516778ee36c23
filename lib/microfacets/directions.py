# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities of directions that all microfacet kernels use.

Tangents, and the sine on a stretched surface.
"""

from __future__ import annotations

import numpy as np

FLOOR = 1e-70
"""Stands for a cosine of zero or less where one divides: its fourth power still has a reciprocal."""


def normal_from_tangents(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The normal (3, n) whose tangents m.x / m.z and m.y / m.z are `x` and `y`, (n,).

    The tangents are the surface's slopes, negated.
    """
    m = np.empty((3, x.shape[0]))
    m[2] = 1.0 / np.sqrt(x * x + y * y + 1.0)
    np.multiply(x, m[2], out=m[0])
    np.multiply(y, m[2], out=m[1])
    return m


def stretched_sine_squared(w: np.ndarray, alpha_x: float | np.ndarray, alpha_y: float | np.ndarray) -> np.ndarray:
    """(alpha_x w.x)^2 + (alpha_y w.y)^2, (n,).

    It is sin^2 of a direction as seen by the surface stretched to roughness 1.
    """
    return np.square(w[0] * alpha_x) + np.square(w[1] * alpha_y)


def above_horizon(w: np.ndarray, value: np.ndarray, below: float) -> np.ndarray:
    """`value` (n,), or of any shape (...) with w (3, ...), but `below` where w.z <= 0.

    It writes into `value`, which is nearly always right already.
    """
    value[np.nonzero(w[2] <= 0.0)] = below  # by indices: no branch to guess, a third of the time of a masked write
    return value
