# SPDX-License-Identifier: GPL-3.0-or-later
"""How a time budget becomes samples per replicate.

It follows from the cost and noise of both sides, which a pilot measures.
The pilot's own images are not used for the verdict, so the data cannot decide how many of them there will be.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# So many replicates are aimed at: quantiles of t far out in the tail need degrees of freedom,
REPLICATES = 48
# but each render call has a fixed cost, and all of them together shall not eat more than this share of the budget.
OVERHEAD = 0.15
FEWEST = 16
# A side gets no less and no more of the time: noises are those of few replicates, and differ from region to region. Where a
# tenth or nine tenths would be best, this costs 6 % more variance.
SHARES = 0.2, 0.8
# A sample costs at least this part of its share in the longest timed call.
LEAST_SLOPE = 0.1
# Cycles adds samples up in float32, which drifts beyond this many.
MOST_SAMPLES = 4096


@dataclass(frozen=True)
class Cost:
    """Seconds of a render call: `fixed`, and `per_sample` for each sample per pixel."""

    fixed: float
    per_sample: float

    def seconds(self, samples: int) -> float:
        """Seconds of one call."""
        return self.fixed + self.per_sample * samples


def fit_cost(samples: list[int], seconds: list[float]) -> Cost:
    """The cost from timings of calls with `samples`, ascending.

    All of it is per sample if there is only one number of samples.
    The fixed part is at most the quickest call. A sample costs at least LEAST_SLOPE of its share in the longest call:
    one timing that a busy machine spoiled must not make samples look free.
    """
    most, longest = samples[-1], seconds[-1]
    if len(set(samples)) < 2:
        return Cost(0.0, max(longest / most, 1e-9))
    slope = max((longest - min(seconds)) / (most - samples[0]), LEAST_SLOPE * longest / most, 1e-9)
    return Cost(max(longest - slope * most, 0.0), slope)


def allocate(
    seconds: float, costs: tuple[Cost, Cost], noises: tuple[float, float], most: int | None = None
) -> tuple[int, int]:
    """Samples per replicate for both sides, as many replicates on each, at `most` so many.

    The variance of the difference, v1 / n1 + v2 / n2, is least for n1 c1 + n2 c2 seconds when time is shared as sqrt(v c)
    (Neyman 1934, with costs: Cochran, "Sampling Techniques", 3rd ed., sec. 5.5). Rounded to powers of two, at which
    low-discrepancy sequences are best.
    """
    fixed = costs[0].fixed + costs[1].fixed
    replicates = np.clip(OVERHEAD * seconds / fixed if fixed > 0 else REPLICATES, FEWEST, REPLICATES)
    replicates = min(replicates, most or REPLICATES)
    weights = [np.sqrt(v * c.per_sample) for v, c in zip(noises, costs, strict=True)]
    share = np.clip(weights[0] / sum(weights), *SHARES) if min(noises) > 0 else 0.5
    available = max(seconds / replicates - fixed, 0.0)
    samples = [
        2 ** int(np.floor(np.log2(max(part * available / cost.per_sample, 1.0)) + 0.5))
        for part, cost in zip((share, 1 - share), costs, strict=True)
    ]
    return min(samples[0], MOST_SAMPLES), min(samples[1], MOST_SAMPLES)
