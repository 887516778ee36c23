# SPDX-License-Identifier: GPL-3.0-or-later
"""A lobe whose own x axis lies elsewhere about the normal (anisotropic tangents)."""

from __future__ import annotations

import numpy as np

from .lobe import Lobe, Wrapper


def rotate_in(v: np.ndarray, cos: np.ndarray, sin: np.ndarray) -> np.ndarray:
    """Components of `v` in the frame whose x axis is (cos, sin, 0)."""
    return np.stack([v[0] * cos + v[1] * sin, v[1] * cos - v[0] * sin, v[2]])


class Rotated(Wrapper):
    """`lobe`, made in the frame whose x axis is (cos, sin, 0) of the common local frame."""

    def __init__(self, lobe: Lobe, cos: np.ndarray, sin: np.ndarray) -> None:
        super().__init__(lobe)
        self._cos, self._sin = cos, sin

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The lobe's value and density."""
        return self._lobe.evaluate(rotate_in(wi, self._cos, self._sin))

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The lobe's direction, turned back, its weight and density."""
        wi, weight, pdf = self._lobe.sample(u1, u2)
        return rotate_in(wi, self._cos, -self._sin), weight, pdf

    def widening(self, wi: np.ndarray) -> np.ndarray:
        """The lobe's own, (n,)."""
        return self._lobe.widening(rotate_in(wi, self._cos, self._sin))

    def part(self, index: np.ndarray) -> Rotated:
        """The same lobe at fewer points."""
        return Rotated(self._lobe.part(index), np.take(self._cos, index), np.take(self._sin, index))
