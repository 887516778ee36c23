# SPDX-License-Identifier: GPL-3.0-or-later
"""Relative differences: what a difference is divided by, and where it counts as absolute.

The report's script has the quotient once more, as `relativeDifference` in report/calculations.js; a test compares the two.
"""

from __future__ import annotations

import numpy as np


def difference_scale(reference: np.ndarray, floor: np.ndarray | float) -> np.ndarray:
    """What differences from `reference` are relative to: max(|reference|, floor), elementwise."""
    return np.maximum(np.abs(reference), floor)


def relative_difference(gap: np.ndarray, reference: np.ndarray, floor: np.ndarray | float) -> np.ndarray:
    """`gap` / max(|reference|, floor), elementwise.

    0 where the gap is 0; infinite, with the sign of the gap, where only the scale is 0; NaN where either is NaN.
    """
    scale = difference_scale(reference, floor)
    unscaled = np.where(gap == 0, 0.0, np.copysign(np.inf, gap))
    return np.where(np.isnan(gap), np.nan, np.divide(gap, scale, out=unscaled, where=scale != 0))


def worst_channel(difference: np.ndarray) -> np.ndarray:
    """The channel (...) in which each difference (..., 3) is largest.

    0 where there is no number.
    """
    return np.argmax(np.nan_to_num(np.abs(difference), nan=-1.0, posinf=np.inf), axis=-1)
