# SPDX-License-Identifier: GPL-3.0-or-later
"""How an area light's radiance falls off with the angle when its spread is narrowed."""

from __future__ import annotations

import math

import numpy as np


class Spread:
    """max(tan h - tan theta, 0) / (tan h - h) with h half the `spread` (radians, 0 < spread < pi): the slats of a soft box.

    Its integral against the cosine over the hemisphere is pi, so that the flux is that of a light without it.
    """

    def __init__(self, spread: float) -> None:
        h = 0.5 * spread
        self.tan_half = math.tan(h)
        # tan h - h cancels; its series is exact to 1e-13 where the difference no longer is.
        series = h**3 / 3.0 * (1.0 + h**2 * (2.0 / 5.0 + h**2 * (17.0 / 105.0 + h**2 * 62.0 / 945.0)))
        self._scale = 1.0 / (series if h < 0.03 else self.tan_half - h)

    def __call__(self, tan_theta: np.ndarray) -> np.ndarray:
        """Factor (n,) for the tangent of the angle to the light's normal."""
        factor = self.tan_half - tan_theta
        np.maximum(factor, 0.0, out=factor)
        factor *= self._scale
        return factor
