# SPDX-License-Identifier: GPL-3.0-or-later
"""Lambert's diffuse reflection (documents, example 1)."""

from __future__ import annotations

import numpy as np

from ..sampling.warps import cosine_hemisphere


class Lambert:
    """f = 1 / pi, sampled by pdf(wi) = cos(theta_i) / pi."""

    delta = False

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Cos / pi twice: value and density, (n,)."""
        pdf = np.clip(wi[2], 0.0, np.inf)
        pdf *= 1.0 / np.pi
        return pdf, pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight 1, density."""
        wi = cosine_hemisphere(u1, u2)
        return wi, np.ones_like(u1), wi[2] * (1.0 / np.pi)

    def part(self, index: np.ndarray) -> Lambert:
        """Itself: it knows nothing of the points."""
        return self


class LambertTransmission:
    """Lambert's reflection turned to the far side: f = 1 / pi where wi lies below."""

    delta = False

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """|Cos| / pi twice: value and density, (n,)."""
        pdf = np.clip(-wi[2], 0.0, np.inf)
        pdf *= 1.0 / np.pi
        return pdf, pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight 1, density."""
        wi = cosine_hemisphere(u1, u2)
        pdf = wi[2] * (1.0 / np.pi)
        wi[2] *= -1.0
        return wi, np.ones_like(u1), pdf

    def part(self, index: np.ndarray) -> LambertTransmission:
        """Itself: it knows nothing of the points."""
        return self
