# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions as the context of the world's expressions."""

from __future__ import annotations

import numpy as np

from ..textures.context import WithoutSurface


class Directions(WithoutSurface):
    """Unit directions (3, n) out of the scene, as places where the world is evaluated.

    Every kind of coordinates is the direction itself.
    `flags`, () or (n,) int, are those of the rays (scene/rays.py).
    """

    def __init__(self, direction: np.ndarray, flags: np.ndarray | int = 0) -> None:
        self._direction, self.flags, self.tally = direction, flags, None
        self.size = direction.shape[1]
        self.cos_wo = np.ones(self.size)
        self.backfacing = np.zeros(self.size, bool)

    def coordinates(self, kind: str, uv_map: str = "") -> np.ndarray:
        """The direction, (3, n)."""
        return self._direction
