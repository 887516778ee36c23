# SPDX-License-Identifier: GPL-3.0-or-later
"""Where sampling goes on: once most regions are decided, on the parts of the image that hold the others.

A region's replicates stay a prefix of all replicates, judged at the same numbers of them as if the whole image were rendered: what was seen
elsewhere decides whether it is looked at again, never after how many of its replicates.
"""

from __future__ import annotations

import numpy as np

from ..film.regions import Regions
from ..film.windows import Windows, windows_around

# Parts that are together larger than this share of the image save too little.
LARGEST = 0.5


def focus(regions: Regions, wanted: np.ndarray) -> Windows | None:
    """The windows that hold the regions `wanted` (K,) bool, or None where the whole image is to be rendered."""
    inside = np.zeros(regions.shape, bool)
    for left, top, right, bottom in regions.boxes[wanted]:
        inside[top : bottom + 1, left : right + 1] = True
    if inside.mean() > LARGEST:
        return None
    windows = windows_around(inside)
    return windows if windows.mask.mean() <= LARGEST else None
