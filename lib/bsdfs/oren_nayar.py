# SPDX-License-Identifier: GPL-3.0-or-later
"""Energy-preserving Oren-Nayar in Fujii's form, as in Blender's Diffuse BSDF with roughness."""

from __future__ import annotations

import numpy as np

from ..sampling.warps import cosine_hemisphere


def _albedo_term(cos: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Single-scattering directional albedo E(c) = pi A + B G(c); Portsmouth et al. 2024, eq. 12 and 13."""
    cos = np.clip(cos, 1e-9, 1.0)
    sin = np.sqrt(np.maximum(1.0 - cos * cos, 0.0))
    theta = np.arctan2(sin, cos)
    g = sin * (theta - 2.0 / 3.0 - sin * cos) + (2.0 / 3.0) * (sin / cos) * (1.0 - sin * sin * sin)
    return np.pi * a + b * g


class OrenNayar:
    """Fujii's "qualitative" Oren-Nayar with its multiple scattering, coloured by `color` (3, n) or (3, 1).

    Fujii 2012; Portsmouth, Kutz and Hill 2024, "EON". `roughness` in [0, 1]; sampled by the cosine. Light that is scattered
    k times carries color^k, so the multiple scattering begins with color^`first`, first = 2. Cycles departs from it: 3 multiplies by
    color once more, None leaves the multiple scattering out.
    """

    delta = False

    def __init__(self, wo: np.ndarray, roughness: np.ndarray, color: np.ndarray, first: int | None = 2) -> None:
        self._wo, self._roughness, self._color, self._first = wo, np.asarray(roughness, np.float64), color, first
        self._a = 1.0 / (np.pi + self._roughness * (np.pi / 2.0 - 2.0 / 3.0))
        self._b = self._roughness * self._a
        average = np.pi * self._a + self._b * (2.0 * np.pi - 5.6) / 3.0
        self._average = average
        lost = 1.0 - average
        begin = 0.0 * color if first is None else color**first
        self._multiple = begin * average / (np.pi * np.maximum(lost, 1e-300) * (1.0 - color * lost))
        self._lost_o = 1.0 - _albedo_term(wo[2], self._a, self._b)

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coloured value (3, n) and density (n,)."""
        wo = self._wo
        nl = np.maximum(wi[2], 0.0)
        t = wi[0] * wo[0] + wi[1] * wo[1] + wi[2] * wo[2] - wi[2] * wo[2]
        t = np.where(t > 0.0, t / np.maximum(np.maximum(nl, wo[2]), 1e-300), t)
        single = self._a + self._b * t
        lost_i = 1.0 - _albedo_term(nl, self._a, self._b)
        value = nl * (self._color * single + self._multiple * (self._lost_o * lost_i))
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
