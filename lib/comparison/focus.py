# SPDX-License-Identifier: GPL-3.0-or-later
"""Where sampling goes on, once most regions are decided.

It goes on in the parts of the image that hold the others. A region's replicates stay a prefix of all replicates, judged
at the same numbers of them as if the whole image were rendered: what was seen elsewhere decides whether it is looked at
again, never after how many of its replicates. In a part of the image, a round renders several of them at once, as one
replicate of that weight, for about the time that one takes in the whole image.

Where the time will not decide all regions, it goes to those that keep the bound of the image up (`decisive_regions`).
"""

from __future__ import annotations

import numpy as np
from scipy.special import stdtrit

from ..film.regions import Regions
from ..film.windows import Windows, windows_around
from ..verdict.allocation import MOST_SAMPLES
from ..verdict.boundaries import next_look
from ..verdict.sequential import SequentialTest

# Parts that are together larger than this share of the image save too little.
LARGEST = 0.75
# Regions are given up for others where that is expected to lower the bound of the image to this part of what it would be.
WORTHWHILE = 0.8
# What is given up is not taken up again, and the noise of few replicates is itself noisy: the others may come to this part of what is expected.
HOPE = 0.6
# How many numbers of regions are tried.
TRIED = 64


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


def decisive_regions(test: SequentialTest, regions: Regions, wanted: np.ndarray, rounds: float) -> np.ndarray:
    """Those of the regions `wanted` (K,) bool that are worth the time that is left.

    `rounds` is how many more replicates fit into the time, of all that is wanted. Where this decides all of it, all is
    kept. Else the regions with the largest bounds are, as many as give the lowest bound of the image at the end, and
    with them those that the time decides. The others keep the bound that they have. The whole image comes first:
    while it is wanted, so is all.
    """
    bounds, limited = test.bounds, np.isfinite(rounds) and rounds > 0.0
    if not limited or not np.isfinite(bounds[wanted]).all() or (wanted & (regions.families == 0)).any():
        return wanted
    replicates = test.looks[-1].replicates[1]

    def after(share: float) -> np.ndarray:
        """The bounds (K,) expected if a `share` of what is wanted gets all the time."""
        growth = 1.0 + rounds / share / replicates
        quantiles = stdtrit(2.0 * (replicates * np.array([1.0, growth]) - 1.0), test.looks[-1].level)
        noise = bounds - test.rare - test.unsupported
        return noise / np.sqrt(growth) * quantiles[1] / quantiles[0] + test.rare / growth + test.unsupported

    kept = wanted & (after(1.0) <= test.tolerance)
    order = np.flatnonzero(wanted & ~kept)
    order = order[np.argsort(-bounds[order], kind="stable")]
    painted, area = np.zeros(regions.shape, bool), 0
    areas = []
    for k in (*np.flatnonzero(kept), *order):
        left, top, right, bottom = regions.boxes[k]
        box = painted[top : bottom + 1, left : right + 1]
        area += box.size - int(np.count_nonzero(box))
        box[...] = True
        areas.append(area)
    if not order.size:
        return wanted
    # With the first k + 1 of them, for some k; the next one keeps its bound.
    tried = np.unique(np.linspace(0, order.size - 1, TRIED).astype(int))[::-1]
    shares, nexts = [float(part / area) for part in areas[kept.sum() :]], np.append(bounds[order[1:]], 0.0)
    reached = [max(HOPE * after(shares[k])[order[: k + 1]].max(), nexts[k]) for k in tried]
    if min(reached) > WORTHWHILE * reached[0]:
        return wanted
    kept[order[: tried[int(np.argmin(reached))] + 1]] = True
    return kept


def weigh_round(share: float, replicates: int, samples: int, most: int | None = None) -> int:
    """How many replicates to render at once, in a `share` of the image.

    `replicates` is how many were rendered before. It is as many as take no longer than one of the whole image, but
    not past the next look, nor past `most` in all.
    """
    until = min(next_look(replicates), most or next_look(replicates)) - replicates
    return max(min(int(1.0 / share), until, MOST_SAMPLES // samples), 1)
