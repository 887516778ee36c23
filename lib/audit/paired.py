# SPDX-License-Identifier: GPL-3.0-or-later
"""Claims on the true relative difference of two images from the same random numbers.

They are made from replicates taken in pairs. Replicate i gives the mean of a region with the setting, u_i, and without
it, n_i. They are not independent of each other, and need not be: every claim is about one series of numbers,
u_i - (1 -+ t) n_i, whose mean and spread Student's t judges. The claims, their p-values and the floor below which a
difference is not relative to its region any more are those of the verdict (verdict/claims.py).
"""

from __future__ import annotations

import numpy as np
from scipy.special import stdtrit

from ..relative import relative_difference
from ..verdict.claims import Combination, p_different, p_equivalent
from ..verdict.fieller import fieller

CHANNELS = 3


def p_values(user: np.ndarray, neutral: np.ndarray, tolerance: float, floor: float) -> np.ndarray:
    """p-values (2, k) for series (replicates, k, 3).

    The claims are "inside the tolerance in every channel" and "outside it in some". 1 everywhere with fewer than two
    replicates.
    """
    mean = neutral.mean(axis=0)
    inside = np.abs(mean) >= floor
    slope = np.where(inside, tolerance * np.sign(mean), 0.0)
    step = np.where(inside, 0.0, tolerance * floor)
    upper = _combination(user - (1 + slope) * neutral - step)
    lower = _combination(user - (1 - slope) * neutral + step)
    p = np.stack([p_equivalent(upper, lower), p_different(upper, lower)])
    # Equal to the last bit, the two differ by nothing, however noisy they are.
    return np.where(_same(user, neutral).all(axis=1), [[0.0], [1.0]], p) if len(user) > 1 else p


def interval(user: np.ndarray, neutral: np.ndarray, floor: float, tail: float) -> tuple[np.ndarray, np.ndarray]:
    """Both ends (k, 3) of the interval of the relative difference.

    The probability beyond each end is `tail`. Fieller's for paired observations ("Some problems in interval
    estimation", 1954): all rho with |D - rho E| <= q s(d - rho n), where d = u - n; infinite ends where E is not
    distinct from 0, and (D -+ q s(d)) / floor where |E| is below `floor`. NaN with fewer than two replicates.
    """
    count = len(user)
    if count < 2:
        nothing = np.full(user.shape[1:], np.nan)
        return nothing, nothing
    q = -stdtrit(count - 1, tail)
    gap = user - neutral
    d, e = gap.mean(axis=0), neutral.mean(axis=0)
    of_d, of_e = gap - d, neutral - e
    dd, ee, de = ((a * b).sum(axis=0) / (count * (count - 1)) for a, b in ((of_d, of_d), (of_e, of_e), (of_d, of_e)))
    low, high = fieller(d, e, (dd, ee), de, q)
    dark = np.abs(e) < floor if floor > 0 else e == 0
    half, same = q * np.sqrt(dd), _same(user, neutral)
    low = np.where(dark, relative_difference(d - half, e, floor), low)
    high = np.where(dark, relative_difference(d + half, e, floor), high)
    return np.where(same, 0.0, low), np.where(same, 0.0, high)


def _same(user: np.ndarray, neutral: np.ndarray) -> np.ndarray:
    """Where (k, 3) two series are exactly equal in every replicate."""
    return (user == neutral).all(axis=0)


def _combination(series: np.ndarray) -> Combination:
    """Mean, standard error and degrees of freedom of a series (replicates, k, 3)."""
    count, mean = len(series), series.mean(axis=0)
    if count < 2:
        nothing = np.full(mean.shape, np.nan)
        return Combination(mean, nothing, nothing)
    return Combination(mean, series.std(axis=0, ddof=1) / np.sqrt(count), np.full(mean.shape, count - 1.0))
