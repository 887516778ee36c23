# SPDX-License-Identifier: GPL-3.0-or-later
"""The sRGB transfer function, IEC 61966-2-1, both ways.

The report's script has the encoding once more, as `encodeSrgb` in report/calculations.js; a test compares the two.
"""

from __future__ import annotations

import numpy as np


def srgb_decode(code: np.ndarray) -> np.ndarray:
    """Linear light of sRGB code values; negative codes give 0. Any shape."""
    code = np.maximum(code, 0)
    return np.where(code < 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)


def srgb_encode(linear: np.ndarray) -> np.ndarray:
    """Code values in sRGB of linear light; negative light gives 0. Any shape."""
    linear = np.maximum(linear, 0)
    return np.where(linear < 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
