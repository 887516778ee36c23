# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that arrives in pixels, contribution by contribution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Splats:
    """Contributions of light paths to pixels.

    pixel (n,), row by row from the top; value (3, n), of one path each; brightness (n,) of its emitter, as in
    `Emitted`; group (n,), by which uniforms of the path are drawn.
    """

    pixel: np.ndarray
    value: np.ndarray
    brightness: np.ndarray
    group: np.ndarray

    @staticmethod
    def none() -> Splats:
        """No contribution."""
        return Splats(np.empty(0, np.intp), np.empty((3, 0)), np.empty(0), np.empty(0, np.intp))

    @staticmethod
    def joined(parts: Sequence[Splats]) -> Splats:
        """All of them, in order."""
        if not parts:
            return Splats.none()
        return Splats(**{k: np.concatenate([vars(p)[k] for p in parts], axis=-1) for k in vars(parts[0])})
