# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin's velvet.

It is that of Blender's Sheen BSDF 'Ashikhmin', and of the Velvet BSDF of older files.
"""

from __future__ import annotations

import numpy as np

from ..microfacets import masking
from ..sampling.warps import uniform_hemisphere
from ..vectors import dot
from .fresnels import part_of
from .lobe import Lobe, to_rgb

LEAST_SIGMA = 0.01


def inverted_gaussian(m: np.ndarray, sigma: np.ndarray) -> np.ndarray:
    """Return the inverted Gaussian D(m) = exp(-cot^2 / sigma^2) / (pi sigma^2 sin^4), (n,).

    Few normals lie along +z. D cos integrates to 1.

    After Ashikhmin, Premoze and Shirley 2000, section 5. `m` (3, n) unit vectors; `sigma` > 0, () or (n,).
    """
    sine2 = m[0] * m[0] + m[1] * m[1]
    # Along the normal the exponential wins over every power.
    sine2 = np.maximum(sine2, 1e-140)
    cotangent2 = m[2] * m[2] / sine2
    return np.exp(-cotangent2 / np.square(sigma)) / (np.pi * np.square(sigma * sine2))


class Velvet(Lobe):
    """The velvet lobe D G / (4 |wo.n|), |wi.n| included.

    D is the inverted Gaussian and G is V-cavity masking. There is no Fresnel factor. Sampled uniformly.

    Ashikhmin, Premoze and Shirley 2000. `sigma` () or (n,), clipped to [0.01, 1].
    """

    diffuse = True

    def __init__(self, wo: np.ndarray, sigma: np.ndarray) -> None:
        self._wo, self._sigma = wo, np.clip(sigma, LEAST_SIGMA, 1.0)

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value (3, n) and density (n,)."""
        wo = self._wo
        lit = (wi[2] > 0.0) & (wo[2] > 0.0)
        m = wi + wo
        length = np.sqrt(dot(m, m))
        m /= np.where(length > 0.0, length, 1.0)
        shadowing = masking.torrance_sparrow(wi, wo, m)
        value = inverted_gaussian(m, self._sigma) * shadowing / (4.0 * np.where(lit, wo[2], 1.0))
        return to_rgb(np.where(lit, value, 0.0)), np.where(wi[2] > 0.0, 0.5 / np.pi, 0.0)

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight (3, n), density."""
        wi = uniform_hemisphere(u1, u2)
        value, pdf = self.evaluate(wi)
        return wi, value * (2.0 * np.pi), pdf

    def part(self, index: np.ndarray) -> Velvet:
        """The same lobe at fewer points."""
        return Velvet(np.take(self._wo, index, axis=1), part_of(self._sigma, index))
