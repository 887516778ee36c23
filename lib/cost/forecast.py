# SPDX-License-Identifier: GPL-3.0-or-later
"""Forecasts of the time that each way takes to an error.

They are drawn from what the pilots leave open, so that the interval is that of the next run. A way's relMSE is
variance(N) + bias^2. Between measured points the variance is read off the line through them on log axes; beyond the
last it falls as N^-r. Theory gives r = 1 for independent samples; for low-discrepancy points it is at least 1 in the
long run, the slope measured so far may last or not, and each draw takes a value from a range that holds both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from .estimates import of_mean
from .measure import Measured, Point
from .ways import Bias

COVERAGE = 0.9
DRAWS = 1000
# The slope of a way of which a single point is known lies between 1 and this.
STEEPEST_UNKNOWN, STEEPEST = 1.5, 2.0


@dataclass(frozen=True)
class Range:
    """The median of a future value, and the ends of its interval.

    The interval holds the value with probability `COVERAGE`; its ends are infinite where the target is not reached.
    """

    median: float
    low: float
    high: float

    @classmethod
    def of(cls, draws: np.ndarray) -> Range:
        """From equally probable values, which may be infinite."""
        ends = np.quantile(draws, ((1 - COVERAGE) / 2, 0.5, (1 + COVERAGE) / 2), method="nearest")
        return cls(float(ends[1]), float(ends[0]), float(ends[2]))


@dataclass(frozen=True)
class Forecast:
    """What the error `target` (relative RMSE of one image) takes.

    It is `samples` a pixel, seconds of rendering alone and of the `whole` command. Samples and seconds are infinite
    where the way's bias, or what was measured of it, stays above the target.
    """

    target: float
    samples: Range
    seconds: Range
    whole: Range

    @property
    def reached(self) -> bool:
        """Whether it is more likely than not to get there."""
        return math.isfinite(self.seconds.median)


def forecast(measured: Measured, target: float, seed: int = 0) -> Forecast | None:
    """The forecast for one way; None where nothing was measured."""
    points = measured.points
    if not points:
        return None
    rng = np.random.default_rng(seed)
    logs = np.log([p.samples for p in points])
    if measured.way.bias is Bias.UNKNOWN:
        total = np.stack([_positive(p.column("variance") + p.column("bias"), rng) for p in points], axis=1)
        n = _crossing(logs, total, np.full(DRAWS, 2.0 * math.log(target)), np.full(DRAWS, np.inf))
    else:
        variance = np.stack([_positive(p.column("variance"), rng) for p in points], axis=1)
        floor = _any(points[-1].column("bias"), rng) if found_floor(measured) > 0.0 else np.zeros(DRAWS)
        allowed = target**2 - np.maximum(floor, 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            goal = np.where(allowed > 0.0, np.log(np.maximum(allowed, 1e-300)), -np.inf)
        n = _crossing(logs, variance, goal, _slopes(logs, variance, measured.way.rate, rng))
    samples = _rounded(n)
    seconds = _seconds(points, samples, rng)
    outside = max(float(np.median(points[-1].wall - points[-1].seconds)), 0.0)
    return Forecast(target, Range.of(samples), Range.of(seconds), Range.of(measured.setup + seconds + outside))


def found_floor(measured: Measured) -> float:
    """The squared bias of a way that ends in a floor.

    0 where its 95 % interval holds 0: a floor that was not found counts as none.
    """
    found = of_mean(measured.points[-1].column("bias"))
    return found.value if measured.way.bias is Bias.FLOOR and found.low > 0.0 else 0.0


def _positive(values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Draws of the logarithm of a positive mean, (DRAWS,).

    A single value has no known spread, nor has a mean that is not positive.
    """
    mean = float(values.mean())
    if mean <= 0.0:
        return np.full(DRAWS, -np.inf)
    return math.log(mean) + _any(values, rng, centred=True) / mean


def _any(values: np.ndarray, rng: np.random.Generator, *, centred: bool = False) -> np.ndarray:
    """Draws of a mean, (DRAWS,), or of its error."""
    spread = values.std(ddof=1) / math.sqrt(values.size) if values.size > 1 else 0.0
    error = spread * stdtrit(max(values.size - 1, 1), rng.random(DRAWS))
    return error if centred else values.mean() + error


def _slopes(logs: np.ndarray, variance: np.ndarray, rate: float | None, rng: np.random.Generator) -> np.ndarray:
    """The power by which variance falls beyond the last point, (DRAWS,)."""
    if rate is not None:
        return np.full(DRAWS, rate)
    steepest = np.full(DRAWS, STEEPEST_UNKNOWN)
    if logs.size > 1:
        x = logs[-3:] - logs[-3:].mean()
        with np.errstate(invalid="ignore"):
            measured = -(variance[:, -3:] * x).sum(axis=1) / (x @ x)
        steepest = np.clip(np.nan_to_num(measured, nan=1.0), 1.0, STEEPEST)
    # Both ends lie well inside the central 90 %.
    return 1.0 + rng.uniform(-0.25, 1.25, DRAWS) * (steepest - 1.0)


def _crossing(logs: np.ndarray, curves: np.ndarray, goal: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Samples (DRAWS,) at which each curve first is as low as its `goal`.

    Curves are logarithms (DRAWS, levels) at `logs`. Infinite where a curve never is as low.
    """
    with np.errstate(invalid="ignore"):
        beyond = np.where(np.isfinite(slope), logs[-1] + (curves[:, -1] - goal) / slope, np.inf)
    n = np.where(curves[:, -1] <= goal, logs[-1], beyond)
    for k in range(logs.size - 2, -1, -1):
        with np.errstate(invalid="ignore"):
            step = np.where(curves[:, k] > curves[:, k + 1], curves[:, k] - curves[:, k + 1], 1.0)
            part = np.clip((curves[:, k] - goal) / step, 0.0, 1.0)
        inside = logs[k] + (logs[k + 1] - logs[k]) * part
        n = np.where(curves[:, k] <= goal, logs[k], np.where(curves[:, k + 1] <= goal, inside, n))
    with np.errstate(over="ignore"):
        return np.exp(n)


def _rounded(n: np.ndarray) -> np.ndarray:
    """Whole samples, at most an eighth more.

    Low-discrepancy points are best in numbers with few binary digits.
    """
    n = np.maximum(n, 1.0)
    step = 2.0 ** np.maximum(np.floor(np.log2(np.where(np.isfinite(n), n, 1.0))) - 3.0, 0.0)
    return np.where(np.isfinite(n), np.ceil(n / step - 1e-9) * step, np.inf)


def _seconds(points: list[Point], samples: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Seconds of rendering (DRAWS,).

    They go through the mean times of the points, and on a line beyond them, with the spread of single calls.
    """
    n = np.array([p.samples for p in points], float)
    mean = np.array([p.seconds.mean() for p in points])
    slope = mean[-1] / n[-1]
    if n.size > 1:
        slope = np.clip((mean[-1] - mean[-2]) / (n[-1] - n[-2]), 0.1 * slope, slope)
    known = np.interp(np.minimum(samples, n[-1]), n, mean)
    with np.errstate(invalid="ignore"):
        seconds = np.where(samples > n[-1], mean[-1] + slope * (samples - n[-1]), known)
    calls = points[-1].seconds / mean[-1]
    spread = calls.std(ddof=1) * math.sqrt(1.0 + 1.0 / calls.size)
    return seconds * np.exp(spread * stdtrit(calls.size - 1, rng.random(DRAWS)))
