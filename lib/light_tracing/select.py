# SPDX-License-Identifier: GPL-3.0-or-later
"""Which light counts: all of it."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ..surfaces.materials import PreparedMaterial
from ..surfaces.surface import SurfacePoints


class Selection(Protocol):
    """Decides which of the light tracer's paths count.

    `history` (n,) is the selection's own memory of each path, 0 at first.
    """

    def starts(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray | bool:
        """Return which rays (3, n) from the lights can start a path that counts.

        The result is (n,) bool, or True for all.
        """
        ...

    def allowed(self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray) -> np.ndarray | None:
        """Which lobes paths may take on, (lobes, n) bool, one at a time; None: all together."""

    def connected(self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray) -> np.ndarray | None:
        """Which lobes send light to the camera that counts, (lobes, n) bool; None: all."""

    def remember(
        self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray, lobe: np.ndarray
    ) -> np.ndarray:
        """The history after a scattering by the lobe (n,)."""
        ...


class Everything:
    """All light counts."""

    def starts(self, origin: np.ndarray, direction: np.ndarray) -> bool:
        """All rays."""
        return True

    def allowed(self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray) -> None:
        """All lobes together."""

    def connected(self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray) -> None:
        """All lobes."""

    def remember(
        self, material: PreparedMaterial, points: SurfacePoints, history: np.ndarray, lobe: np.ndarray
    ) -> np.ndarray:
        """Nothing new."""
        return history
