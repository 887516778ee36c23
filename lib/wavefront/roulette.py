# SPDX-License-Identifier: GPL-3.0-or-later
"""Which paths end at random."""

from __future__ import annotations

import numpy as np


def survival(throughput: np.ndarray) -> np.ndarray:
    """Chance of survival in Russian roulette: min(1, sqrt(largest throughput)), (n,).

    A surviving path is multiplied by its inverse, which keeps the mean.
    The square root, as in Cycles, splits the loss between fewer paths and heavier ones (Veach 1997, section 10.4.1).
    """
    return np.minimum(np.sqrt(throughput.max(axis=0)), 1.0)
