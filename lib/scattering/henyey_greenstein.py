# SPDX-License-Identifier: GPL-3.0-or-later
"""The phase function of Henyey and Greenstein (1941).

The forms hold for every anisotropy g in (-1, 1), 0 included.
"""

from __future__ import annotations

import numpy as np

from ..sampling.warps import circle
from ..vectors import orthonormal_basis, to_world


def evaluate(cosine: np.ndarray, g: np.ndarray) -> np.ndarray:
    """Return the density p(cos) of directions, per steradian, (n,).

    p = (1 - g^2) / (4 pi (1 + g^2 - 2 g cos)^(3/2)).

    `cosine` is that of the angle between the directions in which light travels before and after, so g > 0 scatters
    forward. The base of the power is written as (1 - |g|)^2 + 2 |g| (1 - cos), with cos of the sign of g, which does
    not cancel where both are close to 1.
    """
    size = np.abs(g)
    base = np.square(1.0 - size) + 2.0 * size * (1.0 - np.copysign(1.0, g) * cosine)
    return (1.0 - g * g) / (4.0 * np.pi * base * np.sqrt(base))


def sample(direction: np.ndarray, g: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> np.ndarray:
    """Return directions (3, n) after scattering, of density `evaluate`.

    `direction` (3, n) is a unit vector, the uniforms are in [0, 1).

    `u1` turns about `direction`, `u2` inverts the distribution of the cosine. The usual inverse divides by g;
    multiplied out, 1 - cos = 2 (1 - g)^2 (1 - u) (1 + g u) / (1 - g + 2 g u)^2 and 1 + cos = 2 (1 + g)^2 u (1 - g (1
    - u)) / (1 - g + 2 g u)^2.
    """
    square = np.square(1.0 - g + 2.0 * g * u2)
    below = 2.0 * np.square(1.0 - g) * (1.0 - u2) * (1.0 + g * u2) / square
    above = 2.0 * np.square(1.0 + g) * u2 * (1.0 - g * (1.0 - u2)) / square
    sine = np.sqrt(below * above)
    x, y = circle(u1)
    return to_world(np.stack([x * sine, y * sine, 1.0 - below]), *orthonormal_basis(direction), direction)
