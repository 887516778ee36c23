# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions uniform in a cone, which serve spheres, spots and suns.

A cone is named by 1 - cos of its half angle: for a narrow one the cosine itself has no digits left.
"""

from __future__ import annotations

from typing import overload

import numpy as np

from ..sampling.warps import circle


@overload
def density(one_minus_cos: float) -> float: ...
@overload
def density(one_minus_cos: np.ndarray) -> np.ndarray: ...
def density(one_minus_cos: np.ndarray | float) -> np.ndarray | float:
    """1 / solid angle = 1 / (2 pi (1 - cos)), per steradian; PBRT 4th edition, A.5.4."""
    return 1.0 / (2.0 * np.pi * one_minus_cos)


def uniform_cone(
    axis: np.ndarray, one_minus_cos: np.ndarray | float, u1: np.ndarray, u2: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sample a direction (3, n) uniform in the cone about unit `axis` (3, n) or (3, 1).

    Also returns the direction's own 1 - cos to the axis, (n,).
    """
    inner = u2 * one_minus_cos
    sine = np.sqrt(inner * (2.0 - inner))
    x, y = circle(u1)
    x *= sine
    y *= sine
    return _about(axis, x, y, 1.0 - inner), inner


def _about(axis: np.ndarray, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Return the vector with components x, y, z in a frame whose z is `axis`.

    It is the frame of Duff et al. 2017, multiplied out.
    """
    ax, ay, az = axis
    sign = np.copysign(1.0, az)
    across = ax * x
    across += ay * y
    along = z - across / (sign + az)
    direction = np.empty((3, x.shape[0]))
    np.multiply(ax, along, out=direction[0])
    direction[0] += sign * x
    np.multiply(ay, along, out=direction[1])
    direction[1] += sign * y
    np.multiply(az, z, out=direction[2])
    direction[2] -= across
    return direction
