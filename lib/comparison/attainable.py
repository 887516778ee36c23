# SPDX-License-Identifier: GPL-3.0-or-later
"""The bound of the image that a time allows, and what it asks of each region.

The bound of the image is the largest of its regions'. It is least for a given time where all regions that need samples end with the
same bound: noisy ones get many, others few or none. What a region needs follows from its present bound, whose noise falls with the root
of its replicates, and whose room for rare light falls with their number.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.special import ndtri, stdtrit

from ..film.moments import Moments
from ..film.regions import Regions
from ..relative import difference_scale
from ..verdict.boundaries import GROWTH, looks_between
from ..verdict.claims import combine, difference
from ..verdict.outcome import Outcome
from ..verdict.sequential import SequentialTest
from .pace import Pace

# From one look that a small part is given to the next, its replicates grow by this factor at most.
FURTHEST = 1.5
# Areas are counted in squares of so many pixels.
EDGE = 8
# Nothing is planned beyond so many replicates.
LOOKS = np.array(looks_between(0, 1 << 24))
# Numbers of observations for which quantiles of Student's t are computed; between them they are interpolated.
OBSERVED = np.geomspace(2.0, 1e5, 64)
# A bound is found to within this factor.
CLOSE = 1.02
TINY = np.finfo(float).tiny


@dataclass(frozen=True)
class Standing:
    """What is known of K regions.

    `replicates` (K,) is their number by weight, `observed` (K,) how often each region was rendered. `bounds` (K,) are those of the last
    look, or an estimate where that gave none. Once a region differs, they are those up to which each region agrees on its own, and what
    differs counts by its noise.
    """

    replicates: np.ndarray
    observed: np.ndarray
    bounds: np.ndarray


def find_standing(test: SequentialTest, reference: Moments, candidate: Moments) -> Standing:
    """The standing of the regions of `test`, by the moments (K, 3) of both sides."""
    shape = test.bounds.shape
    replicates = np.broadcast_to(np.minimum(reference.n, candidate.n), shape)
    observed = np.broadcast_to(np.minimum(reference.df, candidate.df) + 1, (*shape, 1))[:, 0]
    gap = np.abs(difference(candidate, reference, test.floor)).max(axis=1)
    plain = combine(candidate, reference, 1.0)
    scale = np.maximum(difference_scale(reference.mean, test.floor), TINY)
    noise = (-stdtrit(plain.df, test.looks[-1].level) * plain.error / scale).max(axis=1)
    bounds = np.where(np.isfinite(test.bounds), test.bounds, gap + noise + test.rare + test.unsupported)
    differs = test.outcomes == Outcome.DIFFERENT
    bounds = np.where(differs, bounds - gap, bounds)
    if differs.any():
        room = test.rare + test.unsupported
        bounds = room + (bounds - room) * ndtri(test.level_alone) / ndtri(test.looks[-1].level)
    return Standing(replicates, observed, np.nan_to_num(bounds, nan=0.0, posinf=1.0 / TINY))


def needed_replicates(test: SequentialTest, now: Standing, bound: float) -> np.ndarray:
    """The replicates (K,) of the look at which each region is expected to be within `bound`.

    Those it has where it is so now; infinite where no number of replicates will do.
    """
    noise = np.maximum(now.bounds - test.rare - test.unsupported, 0.0)
    room = np.maximum(bound - test.unsupported, 0.0)
    quantiles = -stdtrit(2.0 * (OBSERVED - 1.0), test.looks[-1].level)
    present = np.interp(now.observed, OBSERVED, quantiles)
    ratio, growth = np.ones(noise.shape), np.ones(noise.shape)
    for _ in range(2):
        # rare x^2 + ratio noise x = room, for x = 1 / sqrt(growth)
        slope = ratio * noise
        x = 2.0 * room / np.maximum(slope + np.sqrt(slope * slope + 4.0 * test.rare * room), TINY)
        growth = 1.0 / np.clip(x * x, 1.0 / LOOKS[-1], 1.0)
        # Each look adds one observation at least.
        later = now.observed + np.log(growth) / np.log(GROWTH)
        ratio = np.interp(later, OBSERVED, quantiles) / present
    looks = np.append(LOOKS, np.inf)[np.searchsorted(LOOKS, now.replicates * growth)]
    return np.where(now.bounds <= bound, now.replicates, looks)


class Attainable:
    """What the regions of an image cost to sample, if all pixels cost the same."""

    def __init__(self, regions: Regions) -> None:
        height, width = regions.shape
        across, down = -(-width // EDGE), -(-height // EDGE)
        row, column = np.divmod(regions.weights.indices, width)
        square = (row // EDGE) * across + column // EDGE
        region = np.repeat(np.arange(len(regions)), np.diff(regions.weights.indptr))
        shown = sparse.coo_array((np.ones(square.size), (region, square)), (len(regions), across * down)).tocsr()
        self._squares, self._square, self._count = across * down, shown.indices, np.diff(shown.indptr)

    def work(self, replicates: np.ndarray) -> float:
        """What it takes to give each region so many `replicates` (K,), in replicates of the whole image."""
        most = np.zeros(self._squares)
        np.maximum.at(most, self._square, np.repeat(replicates, self._count))
        return float(most.mean())

    def bound(self, test: SequentialTest, wanted: np.ndarray, now: Standing, pace: Pace, seconds: float) -> float:
        """The bound that all regions `wanted` (K,) bool are expected to reach in so many `seconds`.

        It is the tolerance where that is within reach.
        """

        def is_within_reach(bound: float) -> bool:
            needed = np.where(wanted, needed_replicates(test, now, bound), now.replicates)
            growth = float((needed / np.maximum(now.replicates, 1)).max())
            if np.isinf(growth):
                return False
            return pace.seconds(self.work(needed - now.replicates), np.log(growth) / np.log(FURTHEST)) <= seconds

        low, high = test.tolerance, float(now.bounds[wanted].max(initial=0.0))
        if is_within_reach(low):
            return low
        while high > CLOSE * low:
            middle = float(np.sqrt(low * high))
            low, high = (low, middle) if is_within_reach(middle) else (middle, high)
        return high
