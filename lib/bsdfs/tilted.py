# SPDX-License-Identifier: GPL-3.0-or-later
"""A lobe about a normal of its own (normal maps, bumps)."""

from __future__ import annotations

import numpy as np

from .lobe import Lobe, Wrapper


class Tilted(Wrapper):
    """A lobe made in a frame of its own.

    The axes of that frame are the `rows` (3, 3, n) in the common local frame.

    Light counts only where both normals see it on the same side, whatever strategy finds it.
    """

    def __init__(self, lobe: Lobe, rows: np.ndarray) -> None:
        super().__init__(lobe)
        self._rows = rows

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The lobe's value and density."""
        own = (self._rows * wi).sum(axis=1)
        value, pdf = self._lobe.evaluate(own)
        return value * (own[2] * wi[2] > 0.0), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The lobe's direction, turned back, its weight and density."""
        own, weight, pdf = self._lobe.sample(u1, u2)
        wi = (self._rows * own[:, None]).sum(axis=0)
        return wi, weight * (own[2] * wi[2] > 0.0), pdf

    def widening(self, wi: np.ndarray) -> np.ndarray:
        """The lobe's own, (n,)."""
        return self._lobe.widening((self._rows * wi).sum(axis=1))

    def reflects(self, wi: np.ndarray) -> np.ndarray:
        """By the lobe's own normal, (n,)."""
        return (self._rows[2] * wi).sum(axis=0) > 0.0

    def part(self, index: np.ndarray) -> Tilted:
        """The same lobe at fewer points."""
        return Tilted(self._lobe.part(index), np.take(self._rows, index, axis=2))
