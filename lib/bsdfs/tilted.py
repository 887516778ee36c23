# SPDX-License-Identifier: GPL-3.0-or-later
"""A lobe about a normal of its own (normal maps, bumps)."""

from __future__ import annotations

import numpy as np

from .lobe import Lobe, Wrapper

# Normals at right angles, within what float32 resolves, count as pointing to the same side.
_LEVEL = 1e-6


class Tilted(Wrapper):
    """A lobe made in a frame of its own.

    The axes of that frame are the `rows` (3, 3, n) in the common local frame.

    Light counts only where both normals see it on the same side, whatever strategy finds it. Where the lobe's own normal points to the
    other side of the common one, as in Cycles it counts where they see it on different sides; and from above alone, so that an
    opaque lobe reflects nothing.
    """

    def __init__(self, lobe: Lobe, rows: np.ndarray) -> None:
        super().__init__(lobe)
        self._rows = rows
        self._turned = rows[2, 2] < -_LEVEL

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The lobe's value and density."""
        own = (self._rows * wi).sum(axis=1)
        value, pdf = self._lobe.evaluate(own)
        return value * self._counts(own[2], wi[2]), pdf

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The lobe's direction, turned back, its weight and density."""
        own, weight, pdf = self._lobe.sample(u1, u2)
        wi = (self._rows * own[:, None]).sum(axis=0)
        return wi, weight * self._counts(own[2], wi[2]), pdf

    def _counts(self, own: np.ndarray, common: np.ndarray) -> np.ndarray:
        """Whether light counts by its cosines with the lobe's own normal and the common one, (n,) bool."""
        return np.where(self._turned, (own < 0.0) & (common > 0.0), own * common > 0.0)

    def widening(self, wi: np.ndarray) -> np.ndarray:
        """The lobe's own, (n,)."""
        return self._lobe.widening((self._rows * wi).sum(axis=1))

    def reflects(self, wi: np.ndarray) -> np.ndarray:
        """By the lobe's own normal, (n,)."""
        return (self._rows[2] * wi).sum(axis=0) > 0.0

    def part(self, index: np.ndarray) -> Tilted:
        """The same lobe at fewer points."""
        return Tilted(self._lobe.part(index), np.take(self._rows, index, axis=2))
