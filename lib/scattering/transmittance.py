# SPDX-License-Identifier: GPL-3.0-or-later
"""What a homogeneous volume lets through."""

from __future__ import annotations

import numpy as np


def transmittance(extinction: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """The part exp(-extinction distance) of light that is left after `distance` (n,) in metres; shape of `extinction` (3, n), 1/m.

    Beer and Lambert's law (Pharr, Jakob and Humphreys 2023, eq. 11.9). Distances may be infinite: where nothing is extinguished all
    of the light is left even then. Both are at least 0.
    """
    distance = np.broadcast_to(distance, extinction.shape)
    depth = np.multiply(extinction, distance, out=np.zeros(extinction.shape), where=extinction > 0.0)
    return np.exp(-depth)
