# SPDX-License-Identifier: GPL-3.0-or-later
"""Lambert's diffuse reflection (documents, example 1)."""

from __future__ import annotations

import numpy as np

from ..sampling.warps import cosine_hemisphere
from .lobe import Lobe, to_rgb


class Lambert(Lobe):
    """f = 1 / pi, sampled by pdf(wi) = cos(theta_i) / pi."""

    diffuse = True

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Cos / pi twice: value, (3, n), and density, (n,)."""
        pdf = np.clip(wi[2], 0.0, np.inf)
        pdf *= 1.0 / np.pi
        return to_rgb(pdf), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight 1, density."""
        wi = cosine_hemisphere(u1, u2)
        return wi, to_rgb(np.ones_like(u1)), wi[2] * (1.0 / np.pi)

    def part(self, index: np.ndarray) -> Lambert:
        """Itself: it knows nothing of the points."""
        return self


class LambertTransmission(Lobe):
    """Lambert's reflection turned to the far side: f = 1 / pi where wi lies below."""

    diffuse = True

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """|Cos| / pi twice: value, (3, n), and density, (n,)."""
        pdf = np.clip(-wi[2], 0.0, np.inf)
        pdf *= 1.0 / np.pi
        return to_rgb(pdf), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight 1, density."""
        wi = cosine_hemisphere(u1, u2)
        pdf = wi[2] * (1.0 / np.pi)
        wi[2] *= -1.0
        return wi, to_rgb(np.ones_like(u1)), pdf

    def part(self, index: np.ndarray) -> LambertTransmission:
        """Itself: it knows nothing of the points."""
        return self
