# SPDX-License-Identifier: GPL-3.0-or-later
"""Where sampling goes on.

It goes on in parts of the image, once less than all of it is open or where the time will not decide it all. Regions that have as many
replicates as each other are sampled together, up to a look; then what to sample next is chosen anew, and regions that were left may come
again. Each region is judged after the same numbers of replicates as if the whole image were rendered: what was seen elsewhere decides when
it is looked at, never after how many of its replicates. In a part of the image, a round renders several of them at once, as one replicate of
that weight, for about the time that one takes in the whole image.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from ..film.regions import Regions
from ..film.windows import CALL, Windows, windows_around
from ..verdict.allocation import MOST_SAMPLES
from ..verdict.boundaries import next_look
from ..verdict.sequential import SequentialTest
from .attainable import CLOSE, FURTHEST, Attainable, Standing, needed_replicates
from .pace import Pace

# Parts that are together larger than this share of the image save too little.
LARGEST = 0.75
# Windows are chosen for at least so many replicates at once, if the next look is not nearer; and rounds in them are long enough for
# pixels to cost so many times what calls cost.
LEAST_AT_ONCE, CHEAP = 2, 3
# The whole image goes on while that is expected to decide it in this part of the time that is left.
IMAGE_SHARE = 0.5
# Parts are worth leaving the whole image for where they are expected to lower its bound to this part of what it would be.
WORTHWHILE = 0.9


@dataclass(frozen=True, eq=False)
class Part:
    """What is rendered until the next look.

    The regions `of` (K,) bool, None for all, have so many `replicates` as it begins, and are looked at when they have `target`. Their pixels
    are in `windows`, None for the whole image.
    """

    of: np.ndarray | None
    windows: Windows | None
    replicates: int
    target: int

    @property
    def share(self) -> float:
        """The part of the image's pixels that is rendered."""
        return 1.0 if self.windows is None else self.windows.share

    @property
    def is_all(self) -> bool:
        """Whether it is the whole image, for all regions."""
        return self.of is None and self.windows is None


def part_of(
    regions: Regions, wanted: np.ndarray, replicates: np.ndarray, lost: np.ndarray, samples: int, pace: Pace
) -> Part:
    """The part that holds the regions `wanted` (K,) bool, which have equally many `replicates` (K,).

    Other regions with as many take part in it if their pixels are rendered anyway, but for those that are `lost` (K,).
    `samples` is what a pixel gets in a replicate.
    """
    count = int(replicates[wanted].max())
    windows = find_windows(regions, wanted, samples, count)
    of, share = (replicates == count) & ~lost, 1.0 if windows is None else windows.share
    if windows is not None:
        rendered = windows.mask.ravel()[regions.weights.indices]
        of &= np.logical_and.reduceat(rendered, regions.weights.indptr[:-1])
    target = next_look(count)
    while pace.seconds(share * (target - count), 0) < pace.of_round and next_look(target) <= FURTHEST * count:
        target = next_look(target)
    return Part(None if of.all() else of, windows, count, target)


def find_windows(regions: Regions, wanted: np.ndarray, samples: int, replicates: int) -> Windows | None:
    """The windows that hold the regions `wanted` (K,) bool; None where the whole image is to be rendered."""
    inside = np.zeros(regions.shape, bool)
    inside.ravel()[regions.weights[np.flatnonzero(wanted)].indices] = True
    share = inside.mean()
    if not 0.0 < share <= LARGEST:
        return None
    at_once = min(max(int(1.0 / share), LEAST_AT_ONCE), next_look(replicates) - replicates)
    windows = windows_around(inside, samples * at_once)
    return windows if windows.share <= LARGEST else None


def weigh_round(windows: Windows, replicates: int, samples: int, target: int, most: int | None = None) -> int:
    """How many replicates of so many `samples` to render at once in the `windows`.

    `replicates` is how many were rendered before. It is as many as take no longer than one of the whole image, or as make the calls of
    the renderers cheap beside the pixels, but not past the `target`, nor past `most` in all. Rounds up to there are about equal.
    """
    until = max(min(target, most or target) - replicates, 1)
    cheap = math.ceil(CHEAP * CALL * len(windows.boxes) / (windows.pixels * samples))
    weight = max(min(max(int(1.0 / windows.share), cheap), until, MOST_SAMPLES // samples), 1)
    return math.ceil(until / math.ceil(until / weight))


def choose_regions(
    test: SequentialTest,
    attainable: Attainable,
    now: Standing,
    wanted: np.ndarray,
    pace: Pace,
    seconds: float,
    is_split: bool,
) -> np.ndarray:
    """Those of the regions `wanted` (K,) bool to sample next; they have equally many replicates.

    So many `seconds` are left. If they decide all that is wanted, all is to be sampled, else what has a bound above the one that all can
    reach. Of that, the worst comes first: the upper half between that bound and the largest, on a logarithmic scale. The whole image,
    where it is wanted, comes before all else while IMAGE_SHARE of the time may decide it. Until the sampling `is_split`, all goes on where
    parts gain little. What time is left at the end, too short for all of the worst, goes to some of them. None is returned where nothing
    more is in reach.
    """
    bound, limit = attainable.bound(test, wanted, now, pace, seconds), seconds / pace.whole
    chosen = wanted
    if bound > test.tolerance:
        more = needed_replicates(test, now, test.tolerance) - now.replicates
        image = np.flatnonzero(wanted & (test.families == 0) & (more <= IMAGE_SHARE * limit))
        if image.size:
            return wanted & (now.replicates == now.replicates[image[0]])
        if is_split or bound <= WORTHWHILE * bound_of_whole(test, now, wanted, limit):
            largest = float(now.bounds[wanted].max())
            if bound >= largest and math.isfinite(seconds):
                bound = largest / CLOSE
            chosen = wanted & (now.bounds > bound) & (now.bounds >= np.sqrt(bound * largest))
    if not chosen.any():
        return chosen
    first = int(np.argmax(np.where(chosen, now.bounds, -np.inf)))
    return chosen & (now.replicates == now.replicates[first])


def bound_of_whole(test: SequentialTest, now: Standing, wanted: np.ndarray, limit: float) -> float:
    """The bound expected of the regions `wanted` (K,) bool after `limit` more replicates of the whole image.

    They end with a last look, which has all of the level that is left.
    """
    growth = 1.0 + limit / np.maximum(now.replicates, 1)
    look = test.looks[-1]
    quantiles = ndtri([look.level, look.level * max(test.share_left / look.share, 1.0)])
    noise = now.bounds - test.rare - test.unsupported
    after = noise / np.sqrt(growth) * (quantiles[1] / quantiles[0]) + test.rare / growth + test.unsupported
    return float(after[wanted].max(initial=0.0))
