# SPDX-License-Identifier: GPL-3.0-or-later
"""A reflecting lobe that carries a Fresnel reflectance."""

from __future__ import annotations

import numpy as np

from ..vectors import dot
from .fresnels import Fresnel
from .lobe import Lobe, Wrapper


class Reflected(Wrapper):
    """A lobe that reflects everything, times a reflectance, (3, n).

    The reflectance is that at the half vector of wi and `wo`.
    """

    def __init__(self, lobe: Lobe, wo: np.ndarray, reflectance: Fresnel) -> None:
        super().__init__(lobe)
        self._wo, self._reflectance = wo, reflectance

    @property
    def estimate(self) -> np.ndarray:
        """Return the reflectance of a smooth surface, raised a little.

        Rough surfaces reflect more at their facets.
        """
        reflectance = np.atleast_2d(self._reflectance(np.clip(self._wo[2], 0.0, 1.0))).mean(axis=0)
        return 0.05 + 0.95 * reflectance

    def _factor(self, wi: np.ndarray) -> np.ndarray:
        """The reflectance at the half vector, whose cosine is half the length of wi + wo.

        By 1 + wi.wo it would lose its digits between opposite grazing directions.
        """
        twice = wi + self._wo
        return self._reflectance(np.minimum(0.5 * np.sqrt(dot(twice, twice)), 1.0))

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Value (3, n) and density (n,)."""
        value, pdf = self._lobe.evaluate(wi)
        return value * self._factor(wi), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction, weight (3, n), density."""
        wi, weight, pdf = self._lobe.sample(u1, u2)
        return wi, weight * self._factor(wi), pdf

    def part(self, index: np.ndarray) -> Reflected:
        """The same lobe at fewer points."""
        return Reflected(self._lobe.part(index), np.take(self._wo, index, axis=1), self._reflectance.part(index))
