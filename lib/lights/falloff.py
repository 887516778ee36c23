# SPDX-License-Identifier: GPL-3.0-or-later
"""How light changes with the length of a ray, beside the square of the distance."""

from __future__ import annotations

import numpy as np

from ..scene.lights import Falloff


def brightness_at(falloff: Falloff, distance: np.ndarray) -> np.ndarray:
    """What multiplies the light over `distance` (n,) metres: d^power d^2 / (smooth + d^2); 0 at no distance."""
    square = distance * distance
    fading = square + falloff.smooth
    return distance**falloff.power * np.divide(square, fading, out=np.zeros_like(square), where=fading > 0.0)
