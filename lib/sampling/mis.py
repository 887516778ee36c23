# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights that combine sampling strategies (Veach 1997, chapter 9)."""

from __future__ import annotations

import numpy as np


def power_heuristic(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Weight of the strategy with density `p` against one with density `q`; Veach 1997, eq. 9.14, beta = 2.

    Written with the ratio so that a near-specular density is never squared past the largest double. `p` must be
    positive; it may be infinite (a delta lobe), and the weight is then 1. `q` must be finite.
    """
    with np.errstate(over="ignore"):
        ratio = q / p
        return 1.0 / (1.0 + ratio * ratio)
