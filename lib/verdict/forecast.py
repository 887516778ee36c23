# SPDX-License-Identifier: GPL-3.0-or-later
"""The cost of showing that all regions agree to within a tolerance, or that they do not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, stdtrit

from ..film.moments import Moments
from ..relative import difference_scale
from .boundaries import GROWTH
from .claims import WAYS_TO_DIFFER, Combination, combine, tolerance_ends
from .sequential import ONE_DIFFERS, SequentialTest

COVERAGE = 0.9
MOST = 0.9
# Beyond this many times the replicates so far there is no forecast: the data do not support one.
MOST_GROWTH = 100.0
# Bounds that are forecast where the tolerance is out of reach.
STEPS = (0.5, 0.3, 0.2, 0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.003, 0.002, 0.001)
# Standard errors that stand for infinitely many.
_FAR = 1e12
# Regions times factors that are looked at together.
_AT_A_TIME = 1 << 14


@dataclass(frozen=True)
class Forecast:
    """The factor by which the replicates so far must grow to decide the open regions.

    All `regions` are then within `bound`, or shown to differ by more.
    `factor` is the median; the true one lies between `low` and `high` with probability of at least `COVERAGE`. Infinite
    where it is beyond MOST_GROWTH. At `most`, the share MOST of them is expected to be decided.
    """

    bound: float
    factor: float
    low: float
    high: float
    most: float
    regions: int


def spread_of_differences(gap: np.ndarray, error: np.ndarray, least: float) -> float:
    """Variance tau^2 of the true differences over regions, never below `least`^2.

    The differences are taken as drawn from N(0, tau^2).
    `gap` and its standard `error` (K,), the estimates: the method of moments of DerSimonian and Laird, "Meta-analysis
    in clinical trials" (1986), with mean zero.
    """
    known = np.isfinite(gap) & (error > 0)
    precision = 1.0 / error[known] ** 2
    if not known.any():
        return least**2
    excess = float((gap[known] ** 2 * precision).sum()) - np.count_nonzero(known)
    return max(excess / float(precision.sum()), least**2)


def passing_probability(
    z: np.ndarray, gap: np.ndarray, share: np.ndarray, q: float | np.ndarray, growth: float | np.ndarray
) -> np.ndarray:
    """Probability that a statistic is `q` or more with `growth` > 1 times the data.

    It is `z` standard errors now.
    Predictive power (Spiegelhalter, Freedman and Blackburn, "Monitoring clinical trials: conditional or predictive
    power?", 1986) with a normal prior about zero for the true difference: `gap` is the part of z that is the estimated
    difference, and `share` = tau^2 / (tau^2 + error^2) is how much of it is expected in new data (1: all of it, a flat
    prior).
    """
    fresh = (growth - 1.0) / growth
    mean = np.sqrt(growth) * (z - gap * fresh * (1.0 - share))
    return ndtr((mean - q) / np.sqrt(fresh * ((growth - 1.0) * share + 1.0)))


def forecast(test: SequentialTest, reference: Moments, candidate: Moments) -> Forecast | None:
    """The forecast for the tolerance, or for the smallest bound of STEPS in reach.

    The latter where the tolerance is out of reach.
    None where no region is open, fewer than two replicates are there, or no bound below the present one is in reach.
    """
    if not test.undecided.any() or min(reference.most, candidate.most) < 2:
        return None
    present = test.overall_bound(test.undecided)
    for bound in (test.tolerance, *sorted(step for step in STEPS if test.tolerance < step < present)):
        found = forecast_bound(test, reference, candidate, bound)
        if found is not None and np.isfinite(found.high):
            return found
    return None


def forecast_bound(test: SequentialTest, reference: Moments, candidate: Moments, bound: float) -> Forecast | None:
    """The forecast for all open regions of `test`, of being within `bound`.

    None where no open region has a mean.
    That all are decided is at most as probable as the least decided one, and at least 1 minus the sum of what
    is missing (Bonferroni): these give the interval, whatever the dependence; the median takes regions as independent.
    """
    open_regions = test.undecided & ~test.blocked & np.isfinite(reference.mean + candidate.mean).all(axis=1)
    if not open_regions.any():
        return None
    within = np.maximum(bound - test.unsupported, 0.0)[:, None]
    upper, lower = tolerance_ends(candidate, reference, within, test.floor)
    inside = np.concatenate([_errors(upper.value, upper, -1), _errors(lower.value, lower, +1)], axis=1)[open_regions]
    gap, share = _prior(test, reference, candidate)
    gaps = np.concatenate([_errors(gap, upper, -1), _errors(gap, lower, +1)], axis=1)[open_regions]
    shares = np.concatenate([share, share], axis=1)[open_regions]
    room = test.rare[:, None] * difference_scale(reference.mean, test.floor)
    rooms = np.concatenate([_errors(room, upper, +1), _errors(room, lower, +1)], axis=1)[open_regions]
    rows = np.arange(inside.shape[0])
    worst, best = inside.argmin(axis=1), (-inside).argmax(axis=1)
    near, far = (rows, worst), (rows, best)
    df = float(np.median(np.stack([upper.df, lower.df])[:, open_regions]))
    growths = 1 + np.geomspace(1e-2, MOST_GROWTH, 400)[:, None]
    quantiles = dict.fromkeys(("low", "factor", "high", "most"), np.inf)
    at_a_time = max(_AT_A_TIME // rows.size, 1)
    for start in range(0, growths.size, at_a_time):
        growth = growths[start : start + at_a_time]
        # The room for light that was not met shrinks like 1 / growth, its standard errors like 1 / sqrt(growth).
        met = _less(inside[near], rooms[near] / growth)
        enough = -stdtrit(df * growth, test.looks[-1].level)
        decided = passing_probability(met, _finite(gaps[near]), shares[near], enough, growth)
        if bound == test.tolerance:
            spent = np.array([test.share_after(one) for one in growth.flat])[:, None]
            p = test.level * ONE_DIFFERS * spent / (WAYS_TO_DIFFER * test.outcomes.size)
            met = _less(-inside[far], rooms[far] / growth)
            decided = decided + passing_probability(
                met, _finite(-gaps[far]), shares[far], -stdtrit(df * growth, p), growth
            )
        decided = np.minimum(decided, 1.0)
        reached = {
            "low": decided.min(axis=1) >= (1 - COVERAGE) / 2,
            "factor": decided.prod(axis=1) >= 0.5,
            "high": (1 - decided).sum(axis=1) <= (1 - COVERAGE) / 2,
            "most": decided.mean(axis=1) >= MOST,
        }
        quantiles = {k: min(v, float(growth[reached[k]].min(initial=np.inf))) for k, v in quantiles.items()}
        if np.isfinite(list(quantiles.values())).all():
            break
    # Decisions fall at looks, and those are a factor apart.
    high = GROWTH * quantiles["high"]
    return Forecast(bound, quantiles["factor"], quantiles["low"], high, quantiles["most"], int(open_regions.sum()))


def _prior(test: SequentialTest, reference: Moments, candidate: Moments) -> tuple[np.ndarray, np.ndarray]:
    """Estimated differences C - E (K, 3), and what share of each is expected to last."""
    plain = combine(candidate, reference, 1.0)
    scale = difference_scale(reference.mean, test.floor)
    scale = np.where(scale > 0, scale, 1.0)
    gap, error = plain.value / scale, plain.error / scale
    variance = [spread_of_differences(gap[:, k], error[:, k], test.tolerance / 10) for k in range(gap.shape[1])]
    return plain.value, variance / (np.array(variance) + error**2)


def _errors(value: np.ndarray, end: Combination, sign: int) -> np.ndarray:
    """`value` in standard errors of an end of the tolerance, towards its inner side, (K, 3)."""
    value = sign * value
    far = np.where(value == 0, 0.0, np.copysign(np.inf, value))
    return np.divide(value, end.error, out=far, where=end.error > 0)


def _less(z: np.ndarray, room: np.ndarray) -> np.ndarray:
    """`z` less `room`; where both are infinite, as without noise, -inf: nothing is passed."""
    with np.errstate(invalid="ignore"):
        return _finite(np.nan_to_num(z - room, nan=-np.inf, posinf=np.inf, neginf=-np.inf))


def _finite(z: np.ndarray) -> np.ndarray:
    """`z` with infinite ones, which no noise can move, as numbers that none will."""
    return np.clip(z, -_FAR, _FAR)
