# SPDX-License-Identifier: GPL-3.0-or-later
"""How an area light's radiance falls off with the angle when its spread is narrowed."""

from __future__ import annotations

import math

import numpy as np


class Spread:
    """The spread of a flat light, as by the slats of a soft box.

    The factor is max(tan h - tan theta, 0) / (tan h - h), where h is half the `spread` (radians, 0 < spread < pi).

    Its integral against the cosine over the hemisphere is pi, so that the flux is that of a light without it.
    """

    def __init__(self, spread: float) -> None:
        h = 0.5 * spread
        self.tan_half = math.tan(h)
        self.sin2_half = math.sin(h) ** 2
        # tan h - h cancels; of sin h - h cos h = h^3 / 3 (1 - h^2 / 10 + h^4 / 280 - ...) the series does not.
        series = term = 1.0
        k = 2
        while abs(term) > 1e-17:
            term *= -h * h / (k * (k + 3))
            series += term
            k += 2
        self._scale = 3.0 * math.cos(h) / (h**3 * series)

    def __call__(self, tan_theta: np.ndarray) -> np.ndarray:
        """Factor (n,) for the tangent of the angle to the light's normal."""
        factor = self.tan_half - tan_theta
        np.maximum(factor, 0.0, out=factor)
        factor *= self._scale
        return factor
