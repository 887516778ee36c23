# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimates with intervals from a few independent values."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Estimate:
    """A value and the interval that covers the true one with probability `CONFIDENCE`.

    Its ends are NaN where nothing can be said.
    """

    value: float
    low: float = math.nan
    high: float = math.nan

    def map(self, function: Callable[[float], float]) -> Estimate:
        """`function`, increasing, of the value and of both ends."""
        return Estimate(*(float(function(v)) for v in (self.value, self.low, self.high)))


def quantile(values: np.ndarray, confidence: float = CONFIDENCE) -> float:
    """Student's quantile for the mean of that many values; NaN for a single one."""
    return float(stdtrit(values.size - 1, 0.5 + 0.5 * confidence)) if values.size > 1 else math.nan


def standard_error(values: np.ndarray) -> float:
    """Of the mean; NaN for a single value."""
    return float(values.std(ddof=1) / np.sqrt(values.size)) if values.size > 1 else math.nan


def of_mean(values: np.ndarray) -> Estimate:
    """The mean of independent values of either sign (Student's t)."""
    values = np.asarray(values, float)
    mean, half = float(values.mean()), quantile(values) * standard_error(values)
    return Estimate(mean, mean - half, mean + half)


def of_positive_mean(values: np.ndarray) -> Estimate:
    """The mean of positive values.

    Its interval is Student's t on the logarithm's scale, to first order, so that no end is below zero.
    """
    values = np.asarray(values, float)
    mean = float(values.mean())
    if mean <= 0.0:
        return Estimate(mean)
    factor = math.exp(quantile(values) * standard_error(values) / mean)
    return Estimate(mean, mean / factor, mean * factor)


def of_geometric_mean(values: np.ndarray) -> Estimate:
    """The geometric mean of positive values (Student's t on logarithms).

    NaN where one of them is not positive.
    """
    values = np.asarray(values, float)
    if not np.all(values > 0.0):
        return Estimate(math.nan)
    return of_mean(np.log(values)).map(np.exp)
