# SPDX-License-Identifier: GPL-3.0-or-later
"""Which paths end at random."""

from __future__ import annotations

import numpy as np


def survival(throughput: np.ndarray) -> np.ndarray:
    """Russian roulette's chance min(1, sqrt(largest throughput)), (n,); who survives carries its inverse, so that the mean stays.

    The square root, as in Cycles, splits the loss between fewer paths and heavier ones (Veach 1997, section 10.4.1).
    """
    return np.minimum(np.sqrt(throughput.max(axis=0)), 1.0)
