# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that is carried by samples too rare to have been met.

Student's t knows only the noise that it has seen. A region of M pixels that got n samples in each, N = n M in all, and
met no sample of v times its mean or more, may still owe up to v ln(1/a) / N of its light to such samples: with a
greater share, one would have been met with probability 1 - a (the upper limit of a binomial probability after no
success, (1 - p)^N = a). So each claim on a region

- leaves room for a difference of `worth` ln(1/a) / N, where `worth` is what the largest isolated jump that was seen
  anywhere in the image, on either side, was worth: what one region met, another may not have met yet;
- excludes only light in samples of up to v* = N tolerance / ln(1/a) times the region's mean: its *blind spot* lies
  beyond.

Regions that show the world alone are an exception to the first. What makes jumps is scattered by surfaces; where no camera ray
has met one, and no two replicates differ, there is room for samples of LEAST_WORTH alone, as in an image without jumps.

A jump is isolated where one replicate of a region lies so many robust standard deviations above the median of its
replicates that normal noise practically never does (`jump_limit`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

# Robust standard deviations (1.4826 times the median absolute deviation: Rousseeuw and Croux, "Alternatives to the median absolute
# deviation", 1993) beyond which a replicate is an isolated jump, and the replicates that it takes to say so.
JUMP, FEWEST = 8.0, 5
# How often normal noise may pass for a jump, about: the robust deviation of few replicates is itself noisy, like Student's.
MISTAKEN = 1e-7
# Below this part of the median, deviations are rounding of float32 sums, not noise.
ROUNDING = 1e-5
# The shape of a tail is told from so many values on, of which a fifth are the tail; with fewer it is mostly noise.
TAIL_FROM = 100
# In units of a region's mean: samples of this worth are ruled out before any claim, whether or not a jump was seen.
LEAST_WORTH = 10.0


@dataclass(frozen=True)
class Tails:
    """How the replicates of K regions are distributed.

    `largest_share` (K,) is the part of a region's light beyond its median replicate that its largest replicate carries.
    `worth` (K,) is that of the largest isolated jump in samples of the region's mean, 0 without one.
    """

    largest_share: np.ndarray
    worth: np.ndarray


def jump_limit(replicates: np.ndarray) -> np.ndarray:
    """The distance from the median at which the largest replicate is an isolated jump.

    It is in robust standard deviations above the median of that many `replicates` (K,).
    """
    return np.maximum(JUMP, -stdtrit(np.maximum(replicates - 2, 1), MISTAKEN))


def describe_tails(series: np.ndarray, samples: np.ndarray, weights: np.ndarray) -> Tails:
    """The tails of replicate means `series` (R, K), NaN where a region was not sampled.

    Replicate i has `weights` (R,) times `samples` (K,). Negative means stand for no light and have no tail; fewer than FEWEST
    replicates tell of none.
    """
    known = np.isfinite(series)
    count = known.sum(axis=0)
    values = np.where(known, series, np.nan)
    nothing = np.zeros(series.shape[1])
    if not series.size or count.max(initial=0) < FEWEST:
        return Tails(nothing, nothing)
    usable = count >= FEWEST
    values = np.where(usable, values, 0.0)
    middle = median_of_known(values)
    weights = np.where(known, weights[:, None], 0.0)
    total = np.maximum(weights.sum(axis=0), 1.0)
    mean = np.nansum(weights * values, axis=0) / total
    lit = usable & (mean > 0.0)
    beyond = standardize(values, weights)
    spread = 1.4826 * median_of_known(np.abs(beyond))
    scale = np.maximum(spread, ROUNDING * np.abs(middle))
    # What each replicate holds beyond the median, in means of a replicate of weight 1.
    excess = np.fmax(weights * (values - middle), 0.0)
    share = np.divide(excess.max(axis=0), total * mean, out=nothing.copy(), where=lit)
    isolated = np.where(lit & (beyond > jump_limit(count) * scale), excess, 0.0).max(axis=0)
    worth = np.divide(isolated * samples, mean, out=nothing.copy(), where=isolated > 0.0)
    return Tails(share, worth)


def is_steady(series: np.ndarray) -> np.ndarray:
    """The regions (K,) whose replicate means `series` (R, K) are all equal, but for rounding; NaN does not count."""
    low, high = (
        of(series, axis=0, initial=limit) for of, limit in ((np.fmin.reduce, np.inf), (np.fmax.reduce, -np.inf))
    )
    return high - low <= ROUNDING * np.abs(high)


def standardize(series: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Deviations (R, K) of the replicates from their median, in equal spread.

    They are multiplied by the root of the replicates' `weights`, so that the spread does not depend on the weights.
    """
    return (series - median_of_known(series)) * np.sqrt(weights)


def median_of_known(values: np.ndarray) -> np.ndarray:
    """The median (K,) of the `values` (R, K) that are not NaN; NaN where all are.

    np.nanmedian goes through masked arrays, which takes ten times as long.
    """
    missing = np.isnan(values)
    if not missing.any():
        return np.median(values, axis=0)
    known = len(values) - missing.sum(axis=0)
    middle = np.stack([np.maximum(known - 1, 0) // 2, known // 2])
    return np.take_along_axis(np.sort(values, axis=0), middle, axis=0).mean(axis=0)  # NaN is sorted to the end


def room_for_rare_light(worth: np.ndarray | float, samples: np.ndarray | float, level: float) -> np.ndarray:
    """The relative difference (K,) that samples worth `worth` means or fewer may hide.

    The regions have `samples` (K,) in all.
    `level` is the probability of missing more. Infinite where there is no sample.
    """
    samples = np.asarray(samples, float)
    hidden = np.maximum(worth, LEAST_WORTH) * np.log(1.0 / level)
    return np.divide(hidden, samples, out=np.full(samples.shape, np.inf), where=samples > 0)


def blind_spot(samples: np.ndarray, tolerance: float, level: float) -> np.ndarray:
    """v* (K,): the worth of samples, in means of a region, that may not have been met.

    Light in samples of more than v* times a region's mean may make a difference of `tolerance`.
    """
    return np.asarray(samples, float) * tolerance / np.log(1.0 / level)


def pareto_shape(values: np.ndarray) -> float:
    """The shape k of the upper tail of `values` (R,); NaN below TAIL_FROM values.

    Above 1/2 the variance, above 1 the mean does not exist.
    A generalised Pareto distribution is fitted to the largest min(R / 5, 3 sqrt(R)) values (Vehtari et al., "Pareto
    smoothed importance sampling", 2024, section 2.2), by the estimator of Zhang and Stephens, "A new and efficient
    estimation method for the generalized Pareto distribution" (2009).
    """
    values = np.sort(values[np.isfinite(values)])
    if values.size < TAIL_FROM:
        return np.nan
    tail = int(min(np.ceil(values.size / 5), np.ceil(3 * np.sqrt(values.size))))
    excess = values[-tail:] - values[-tail - 1]
    if excess[-1] <= 0.0 or excess[0] <= 0.0:
        return np.nan
    candidates = 20 + int(np.sqrt(tail))
    quartile = excess[int(tail / 4 + 0.5) - 1]
    theta = 1.0 / excess[-1] + (1.0 - np.sqrt(candidates / (np.arange(candidates) + 0.5))) / (3.0 * quartile)
    k = np.log1p(-theta[:, None] * excess).mean(axis=1)
    likelihood = tail * (np.log(-theta / k) - k - 1.0)
    weight = 1.0 / np.exp(likelihood - likelihood[:, None]).sum(axis=1)
    theta = float(weight @ theta / weight.sum())
    k = float(np.log1p(-theta * excess).mean())
    return (tail * k + 5.0) / (tail + 10.0)  # a weak prior about 1/2, as in PSIS
