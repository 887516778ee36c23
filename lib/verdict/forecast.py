# SPDX-License-Identifier: GPL-3.0-or-later
"""What it would cost to decide the regions that are still open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, stdtrit

from ..film.moments import Moments
from .claims import WAYS_TO_DIFFER, Combination, tolerance_ends
from .sequential import GROWTH, SequentialTest, look_share

COVERAGE = 0.9
_MOST_GROWTH = 1e9


@dataclass(frozen=True)
class Forecast:
    """By which factor the replicates so far must grow until all open regions are decided, one way or the other.

    `factor` is the median; the true one lies between `low` and `high` with probability of at least `COVERAGE`. Infinite where it
    is beyond a thousand million: the difference sits on the tolerance itself.
    """

    factor: float
    low: float
    high: float
    regions: int


def passing_probability(z: np.ndarray, q: float, growth: float) -> np.ndarray:
    """Probability that a statistic, now `z` standard errors, is `q` or more once there are `growth` > 1 times the data.

    With the score process S(f) = theta f + W(f), S(1) = z, and theta unknown (flat prior), S(f) is N(z f, f (f - 1)) and must
    reach q sqrt(f): predictive power (Spiegelhalter, Freedman and Blackburn, "Monitoring clinical trials: conditional or
    predictive power?", 1986).
    """
    return ndtr((z * np.sqrt(growth) - q) / np.sqrt(growth - 1))


def forecast(test: SequentialTest, reference: Moments, candidate: Moments) -> Forecast | None:
    """The forecast for all open regions of `test`; None where none is open or fewer than two replicates are there.

    That all are decided is at most as probable as the least decided one, and at least 1 minus the sum of what
    is missing (Bonferroni): these give the interval, whatever the dependence; the median takes regions as independent.
    """
    open_regions = test.undecided & np.isfinite(reference.mean + candidate.mean).all(axis=1)
    if not open_regions.any() or min(reference.n, candidate.n) < 2:
        return None
    upper, lower = tolerance_ends(candidate, reference, test.tolerance, test.floor)
    inside = np.concatenate([_errors(upper, -1), _errors(lower, +1)], axis=1)[open_regions]
    nearest, farthest = inside.min(axis=1), (-inside).max(axis=1)
    df = float(np.median(np.stack([upper.df, lower.df])[:, open_regions]))
    quantiles = {"low": np.inf, "factor": np.inf, "high": np.inf}
    for growth in 1 + np.geomspace(1e-2, _MOST_GROWTH, 400):
        looks = len(test.looks) + max(1, round(np.log(growth) / np.log(GROWTH)))
        p = test.level * look_share(looks, last=False) / test.claims_left
        equivalent = passing_probability(nearest, -stdtrit(df * growth, p), growth)
        different = passing_probability(farthest, -stdtrit(df * growth, p / WAYS_TO_DIFFER), growth)
        decided = np.minimum(equivalent + different, 1.0)
        reached = {
            "low": decided.min() >= (1 - COVERAGE) / 2,
            "factor": decided.prod() >= 0.5,
            "high": (1 - decided).sum() <= (1 - COVERAGE) / 2,
        }
        quantiles = {k: min(v, float(growth)) if reached[k] else v for k, v in quantiles.items()}
    # Decisions fall at looks, and those are a factor apart.
    return Forecast(quantiles["factor"], quantiles["low"], GROWTH * quantiles["high"], int(open_regions.sum()))


def _errors(end: Combination, sign: int) -> np.ndarray:
    """How many standard errors a combination lies on the inner side of its end of the tolerance, (K, 3)."""
    value = sign * end.value
    far = np.where(value == 0, 0.0, np.copysign(np.inf, value))
    return np.divide(value, end.error, out=far, where=end.error > 0)
