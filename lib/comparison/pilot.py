# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of a sample on either side and its noise, which give the layout of a run.

The layout is the samples of a replicate and the finest grid. A comparison begins with renders of 1, 4, 16, ... samples
that are timed and counted nowhere, as few as tell what samples cost. Then comes the first look: FIRST_LOOK replicates
small enough to take FIRST_SHARE of the time, on a coarse grid. It gives a first answer, the noise of every region, and
more timings. From these the replicates of the main run are laid out; the first look's own samples are not used there,
so nothing that the main run claims depends on data that chose how much of them there would be.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.special import ndtri

from ..film.regions import BLOCK, RegionMoments
from ..sampling.streams import FIRST_CALLS
from ..verdict.allocation import MOST_SAMPLES, Cost, allocate, fit_cost
from ..verdict.boundaries import FIRST_LOOK, count_looks
from .run import TimedRun
from .sides import Replicates

# Of the time: what one timed call may take at most, and what the first look may take; but no more than so many seconds.
CALL_SHARE, FIRST_SHARE, FIRST_SECONDS = 0.05, 0.05, 10.0
PILOT_SAMPLES, STEP = 64, 4
# A call that takes so many times as long as the one with fewer samples tells what samples cost. One that takes so many times as long as
# its samples explain is made again.
TELLING, SPOILED = 2.0, 1.5
# Calls of a side whose samples are slow before the first look.
CALLS_BEFORE = 2
# Where the first look may be all there is, the cheaper side gets more samples if so many replicates still fit into the time.
ENOUGH = 12
# The coarse grid has about so many columns and rows.
COLUMNS, ROWS = 16, 9
# Of a main run that is worth starting: it has so many times the samples of the first look.
WORTHWHILE = 4
# Cells are to be decided with so many times the noise that is expected: noises of few replicates are themselves noisy, and some time is lost.
SPARE = 2.0
# Focusing on open regions can multiply replicates by this; the looks share the level among so many.
FOCUS_GAIN = 16


@dataclass
class Timings:
    """Seconds of render calls of one side, by samples per pixel."""

    seconds: dict[int, list[float]] = field(default_factory=dict)

    def add(self, samples: int, seconds: float) -> None:
        """Take one call."""
        self.seconds.setdefault(samples, []).append(seconds)

    @property
    def cost(self) -> Cost:
        """The cost of a call, from the median of the calls of each number of samples."""
        samples = sorted(self.seconds)
        return fit_cost(samples, [float(np.median(self.seconds[s])) for s in samples])


@dataclass(frozen=True)
class Layout:
    """The layout of a run.

    It has the `samples` per replicate of both sides, the `blocks` of its grids from coarse to fine, and the looks
    expected.
    """

    samples: tuple[int, int]
    blocks: tuple[int, ...]
    looks: int


def time_calls(renderers: tuple[Replicates, Replicates], run: TimedRun) -> tuple[Timings, Timings]:
    """Measure timings of both sides; raises Cancelled.

    Samples grow until a call takes TELLING times as long as the one before, and while the next call, were it STEP times as
    long as the last, would stay within CALL_SHARE of the time.
    """
    both = Timings(), Timings()
    number = 0
    for renderer, timings in zip(renderers, both, strict=True):
        samples, before, longest, again = 1, np.inf, np.inf, False
        while True:
            _, spent = run.render(renderer, FIRST_CALLS.number(number), samples)
            number += 1
            is_slow = STEP * spent > run.share(CALL_SHARE)
            # A call that lasts longer than its samples explain met a busy moment; a first one that is slow may have set things up.
            again = not again and (spent > longest or (samples == 1 and is_slow))
            if again:
                continue
            timings.add(samples, spent)
            if is_slow or spent >= TELLING * before or samples >= PILOT_SAMPLES:
                break
            samples, before, longest = STEP * samples, spent, SPOILED * STEP * spent
    return both


def coarse_grid(height: int, width: int) -> int:
    """The edge of a coarse grid's cells.

    It is BLOCK times the power of two that comes nearest to COLUMNS x ROWS cells.
    """
    edge = min(width / COLUMNS, height / ROWS) / BLOCK
    return BLOCK * 2 ** max(round(np.log2(edge)), 0) if edge > 0 else BLOCK


def first_layout(shape: tuple[int, int], timings: tuple[Timings, Timings], run: TimedRun) -> Layout:
    """The layout of the first look.

    It has as many samples, a power of two, as FIRST_LOOK replicates can have in its time; 1 at least. Where that is 1, it
    may be all there is, and the side with cheaper samples gets more (`balance_samples`).
    """
    seconds = min(run.share(FIRST_SHARE), FIRST_SECONDS) / FIRST_LOOK
    costs = timings[0].cost, timings[1].cost
    samples = 1
    while 2 * samples <= MOST_SAMPLES and sum(cost.seconds(2 * samples) for cost in costs) <= seconds:
        samples *= 2
    pair = (samples, samples) if samples > 1 else balance_samples(costs, run.left)
    expected = run.left / max(sum(cost.seconds(n) for cost, n in zip(costs, pair, strict=True)), 1e-9)
    return Layout(pair, (coarse_grid(*shape),), count_looks(int(min(expected, 1e6))))


def balance_samples(costs: tuple[Cost, Cost], seconds: float) -> tuple[int, int]:
    """Samples per replicate of both sides, 1 of the side whose samples cost more.

    The other gets the power of two at or below the square root of how many times less its samples cost. With as much noise on both
    sides, that is what gives the least variance in a given time (as in `allocate`). It is 1, too, where fewer than ENOUGH
    replicates would fit into `seconds`.
    """
    dear = max(cost.per_sample for cost in costs)
    first, second = (min(2 ** int(np.log2(dear / cost.per_sample) / 2), PILOT_SAMPLES) for cost in costs)
    fits = ENOUGH * (costs[0].seconds(first) + costs[1].seconds(second)) <= seconds
    return (first, second) if fits else (1, 1)


def fixed_share(timings: tuple[Timings, Timings], samples: tuple[int, int]) -> float:
    """The part of the time of a replicate of so many `samples` on both sides that is not spent on samples."""
    costs = timings[0].cost, timings[1].cost
    whole = sum(cost.seconds(n) for cost, n in zip(costs, samples, strict=True))
    return sum(cost.fixed for cost in costs) / max(whole, 1e-9)


def main_layout(
    first: Layout,
    sides: tuple[RegionMoments, RegionMoments],
    timings: tuple[Timings, Timings],
    limits: tuple[float, int | None],
    tolerance: float,
    level: float,
) -> Layout | None:
    """The layout after the first look, from the noise of the first look's `sides`.

    None where it is not worthwhile. `limits` are the seconds that are left, and the most replicates if there is such a
    limit; `level` is the error of one region's test.
    """
    left, most = limits
    costs = timings[0].cost, timings[1].cost
    noises = [relative_variances(side, samples) for side, samples in zip(sides, first.samples, strict=True)]
    of_reference, of_candidate = (float(np.nanmean(n)) if np.isfinite(n).any() else 0.0 for n in noises)
    samples = allocate(left, costs, (of_reference, of_candidate), most)
    replicates = left / max(sum(cost.seconds(n) for cost, n in zip(costs, samples, strict=True)), 1e-9)
    replicates = min(replicates, most or np.inf)
    if replicates < min(FIRST_LOOK, most or np.inf) or replicates * sum(samples) < WORTHWHILE * FIRST_LOOK * sum(
        first.samples
    ):
        return None
    variance = noises[0] / (replicates * samples[0]) + noises[1] / (replicates * samples[1])
    blocks = choose_grids(first.blocks[0], variance, tolerance / float(-ndtri(level)))
    return Layout(samples, blocks, count_looks(int(FOCUS_GAIN * replicates)))


def relative_variances(side: RegionMoments, samples: int) -> np.ndarray:
    """The relative variance (K,) of one sample of one pixel in the cells of the finest grid.

    It is averaged over channels.
    """
    cells = np.flatnonzero(side.regions.families == side.regions.families.max())
    mean, variance = side.moments.mean[cells], side.moments.variance[cells]
    scale = np.maximum(np.abs(mean), 1e-3 * np.nanmean(np.abs(mean)))
    with np.errstate(invalid="ignore", divide="ignore"):
        return (variance / scale**2).mean(axis=1) * samples * side.sizes[cells]


def choose_grids(coarse: int, variance: np.ndarray, error: float) -> tuple[int, ...]:
    """The edges of the grids from coarse to fine.

    They are halved while all cells can be expected to reach the relative standard `error`, and twice as little, if the time goes where the
    noise is.
    `variance` (K,) is the relative variance of one pixel's mean in each coarse cell, at the end of a run that renders all of them equally
    often. Cells that end with the same error have shares of the time in proportion to that, and so their mean decides.
    """
    edges = [coarse]
    known = variance[np.isfinite(variance)]
    while edges[-1] > BLOCK and known.size:
        half = edges[-1] // 2
        if SPARE * np.sqrt(known.mean()) / half > error:
            break
        edges.append(half)
    return tuple(edges)
