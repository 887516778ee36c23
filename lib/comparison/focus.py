# SPDX-License-Identifier: GPL-3.0-or-later
"""Where sampling goes on, once most regions are decided.

It goes on in the parts of the image that hold the others. A region's replicates stay a prefix of all replicates, judged
at the same numbers of them as if the whole image were rendered: what was seen elsewhere decides whether it is looked at
again, never after how many of its replicates. In a part of the image, a round renders several of them at once, as one
replicate of that weight, for about the time that one takes in the whole image.
"""

from __future__ import annotations

import numpy as np

from ..film.regions import Regions
from ..film.windows import Windows, windows_around
from ..verdict.allocation import MOST_SAMPLES
from ..verdict.boundaries import next_look

# Parts that are together larger than this share of the image save too little.
LARGEST = 0.75


def focus(regions: Regions, wanted: np.ndarray, samples: int, replicates: int) -> Windows | None:
    """The windows that hold the regions `wanted` (K,) bool.

    None where the whole image is to be rendered. `samples` is what a pixel gets in a replicate, `replicates` how many
    there are.
    """
    inside = np.zeros(regions.shape, bool)
    for left, top, right, bottom in regions.boxes[wanted]:
        inside[top : bottom + 1, left : right + 1] = True
    share = inside.mean()
    if not 0.0 < share <= LARGEST:
        return None
    windows = windows_around(inside, samples * weigh_round(share, replicates, samples))
    return windows if windows.mask.mean() <= LARGEST else None


def weigh_round(share: float, replicates: int, samples: int, most: int | None = None) -> int:
    """How many replicates to render at once, in a `share` of the image.

    `replicates` is how many were rendered before. It is as many as take no longer than one of the whole image, but
    not past the next look, nor past `most` in all.
    """
    until = min(next_look(replicates), most or next_look(replicates)) - replicates
    return max(min(int(1.0 / share), until, MOST_SAMPLES // samples), 1)
