# SPDX-License-Identifier: GPL-3.0-or-later
"""Energy-preserving Oren-Nayar in Fujii's form.

It is that of Blender's Diffuse BSDF with roughness.
"""

from __future__ import annotations

import numpy as np

from ..sampling.warps import cosine_hemisphere
from .lobe import Lobe

# E of light from the horizon less E of light along the normal, over B: pi/2 - 2/3; and 1 - Eavg over B, from eq. 15.
_RANGE = np.pi / 2.0 - 2.0 / 3.0
_MEAN_LOST = 1.2 - np.pi / 6.0


def lost_share(cos: np.ndarray) -> np.ndarray:
    """Return the share that single scattering loses, (1 - E(c)) / B, (n,).

    It is (pi/2 - 2/3) - G(c); Portsmouth et al. 2024, eq. 12 and 13.

    `cos` (n,), clipped to [0, 1]. E = pi A + B G and 1 - pi A = (pi/2 - 2/3) B, so that nothing is left of 1. With s
    the sine and t = pi/2 - theta, the printed G = s (theta - 2/3 - s c) + (2/3) (s / c) (1 - s^3) has 1 - s^3 = c^2
    (1 + s + s^2) / (1 + s), which keeps its digits at grazing directions.
    """
    c = np.clip(cos, 0.0, 1.0)
    s = np.sqrt((1.0 - c) * (1.0 + c))
    t = np.arctan2(c, s)
    return _RANGE * c * c / (1.0 + s) + s * (t + c * (s - (2.0 / 3.0) * (1.0 + s + s * s) / (1.0 + s)))


class OrenNayar(Lobe):
    """Fujii's "qualitative" Oren-Nayar with its multiple scattering.

    It is coloured by `color` (3, n) or (3, 1).

    Fujii 2012; Portsmouth, Kutz and Hill 2024, "EON". `roughness` in [0, 1]; sampled by the cosine. Light that is
    scattered k times carries color^k, so the multiple scattering begins with color^`first`, first = 2. Cycles departs
    from it: 3 multiplies by color once more, None leaves the multiple scattering out.
    """

    diffuse = True

    def __init__(self, wo: np.ndarray, roughness: np.ndarray, color: np.ndarray, first: int | None = 2) -> None:
        self._wo, self._roughness, self._color, self._first = wo, np.asarray(roughness, np.float64), color, first
        self._a = 1.0 / (np.pi + self._roughness * _RANGE)
        self._b = self._roughness * self._a
        lost = self._b * _MEAN_LOST
        # (1 - E(wi)) (1 - E(wo)) / (1 - Eavg), where B comes out once.
        begin = 0.0 * color if first is None else color**first
        self._multiple = begin * (1.0 - lost) * self._b / (np.pi * _MEAN_LOST * (1.0 - color * lost))
        self._lost_o = lost_share(wo[2])

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coloured value (3, n) and density (n,)."""
        wo = self._wo
        nl = np.maximum(wi[2], 0.0)
        t = wi[0] * wo[0] + wi[1] * wo[1]
        t = np.where(t > 0.0, t / np.maximum(np.maximum(nl, wo[2]), 1e-300), t)
        single = self._a + self._b * t
        value = nl * (self._color * single + self._multiple * (self._lost_o * lost_share(nl)))
        return value, nl * (1.0 / np.pi)

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, coloured weight (3, n), density."""
        wi = cosine_hemisphere(u1, u2)
        value, pdf = self.evaluate(wi)
        return wi, value / np.maximum(pdf, 1e-300), pdf

    def part(self, index: np.ndarray) -> OrenNayar:
        """The same lobe at fewer points."""
        roughness = self._roughness if self._roughness.ndim == 0 else self._roughness[index]
        color = self._color if self._color.shape[1] == 1 else np.take(self._color, index, axis=1)
        return OrenNayar(np.take(self._wo, index, axis=1), roughness, color, self._first)
