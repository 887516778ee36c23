# SPDX-License-Identifier: GPL-3.0-or-later
"""Efficiency, 1 / (relMSE x seconds), and its ratio between two ways of one run."""

from __future__ import annotations

import math

import numpy as np

from .estimates import Estimate, of_geometric_mean
from .measure import Measured, Point
from .ways import Bias

MEASURES = ("mean", "trimmed", "median")
"""How squared errors are taken over pixels."""


def relmse(measured: Measured, point: Point, measure: str = "mean") -> np.ndarray:
    """The relative squared error of one image, a value a pair.

    The bias is left out where theory says that there is none.
    """
    if measure != "mean":
        return point.column(measure)
    variance = point.column("variance")
    return variance if measured.way.bias is Bias.NONE else variance + point.column("bias")


def efficiency(measured: Measured, measure: str = "mean") -> Estimate:
    """1 / (relMSE x seconds of rendering alone) at the way's last point, s^-1.

    NaN where there is no point.
    """
    if not measured.points:
        return Estimate(math.nan)
    return of_geometric_mean(_pairs(measured, measured.points[-1], measure))


def ratio(measured: Measured, other: Measured, measure: str = "mean") -> Estimate:
    """Efficiency of `measured` over that of `other`.

    It is taken at the largest number of samples that both have, pair by pair: what slows the machine for a while slows
    both.
    """
    shared = min(len(measured.points), len(other.points)) - 1
    if shared < 0:
        return Estimate(math.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        values = _pairs(measured, measured.points[shared], measure) / _pairs(other, other.points[shared], measure)
    return of_geometric_mean(values)


def _pairs(measured: Measured, point: Point, measure: str) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return 1.0 / (relmse(measured, point, measure) * point.pair_seconds)
