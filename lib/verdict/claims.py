# SPDX-License-Identifier: GPL-3.0-or-later
"""The two claims about a region, as p-values, and the confidence interval with them.

With C the candidate's true mean of a region and E the reference's, per channel, the allowed gap is
t max(|E|, floor): relative to the reference, absolute where that is nearly black. Both means are noisy; so every
statement is made about the linear combinations C - (1 -+ t) E, whose noise is known, never about the ratio of two
estimates (Fieller, "Some problems in interval estimation", 1954).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtr, stdtrit

from ..film.moments import Moments
from ..relative import relative_difference

# Below this share of the image's median, tolerance is absolute: a relative one would ask for noise-free black.
FLOOR_SHARE = 1e-3
# Three channels, and two ends of the tolerance, each of which alone can show a difference.
WAYS_TO_DIFFER = 6


@dataclass(frozen=True)
class Combination:
    """A linear combination of the two sides' means.

    Its `value`, standard `error` and `df` are arrays (K, 3).
    """

    value: np.ndarray
    error: np.ndarray
    df: np.ndarray


def combine(
    candidate: Moments,
    reference: Moments,
    factor: np.ndarray | float,
    offset: np.ndarray | float = 0.0,
    shift: Moments | None = None,
) -> Combination:
    """C - factor (E + shift) - offset, of three independent means; `shift` may be missing.

    Welch, "The generalization of 'Student's' problem when several different population variances are involved" (1947), with
    Satterthwaite's degrees of freedom. All NaN where a side has fewer than two replicates.
    """
    parts = [candidate, reference] + ([] if shift is None else [shift])
    mean = reference.mean if shift is None else reference.mean + shift.mean
    value = candidate.mean - factor * mean - offset
    if min(np.max(part.df) for part in parts) < 1:
        nothing = np.full(value.shape, np.nan)
        return Combination(value, nothing, nothing)
    square = factor * factor
    variances = [part.variance * (1.0 if k == 0 else square) / part.count for k, part in enumerate(parts)]
    total = sum(variances[1:], variances[0])
    noisy = total > 0
    scale = np.where(noisy, total, 1.0)
    # Without noise each has an equal share.
    shares = [np.where(noisy, v / scale, 1.0 / len(parts)) for v in variances]
    inverses = [share * share / part.df for share, part in zip(shares, parts, strict=True)]
    return Combination(value, np.sqrt(total), 1.0 / sum(inverses[1:], inverses[0]))


def tolerance_ends(
    candidate: Moments,
    reference: Moments,
    tolerance: np.ndarray | float,
    floor: np.ndarray | float,
    shift: Moments | None = None,
) -> tuple[Combination, Combination]:
    """C - E minus, and plus, the allowed gap.

    The first is below zero and the second above where C is inside.
    With a `shift`, a mean of its own, E stands for the sum of both. Which of |E| and `floor` is greater is read off the
    estimate; near the switch both forms agree to tolerance times noise.
    """
    mean = reference.mean if shift is None else reference.mean + shift.mean
    relative = np.abs(mean) >= floor
    slope = np.where(relative, tolerance * np.sign(mean), 0.0)
    step = np.where(relative, 0.0, tolerance * floor)
    upper = combine(candidate, reference, 1 + slope, step, shift)
    lower = combine(candidate, reference, 1 - slope, -step, shift)
    return upper, lower


def _p_below(c: Combination, at_zero: float) -> np.ndarray:
    """p-value of the claim that a combination is below zero.

    Without noise it is 0 or 1, and `at_zero` exactly at zero.
    """
    exact = np.where(c.value < 0, 0.0, np.where(c.value > 0, 1.0, at_zero))
    noisy = c.error > 0
    t = np.divide(c.value, c.error, out=np.zeros(c.value.shape), where=noisy)
    p = np.where(noisy, stdtr(np.where(noisy, c.df, 1.0), t), exact)
    return np.where(np.isnan(c.error) | np.isnan(c.value), 1.0, p)


def _mirrored(c: Combination) -> Combination:
    return Combination(-c.value, c.error, c.df)


def p_equivalent(upper: Combination, lower: Combination) -> np.ndarray:
    """p-value (K,) of "inside the tolerance in every channel".

    Two one-sided tests (Schuirmann, "A comparison of the two one-sided tests procedure and the power approach", 1987); all must hold, so
    the worst p-value is the joint one (Berger, "Multiparameter hypothesis testing and acceptance sampling", 1982).
    Two sides that are equal to the last bit, without noise, are equivalent.
    """
    return np.maximum(_p_below(upper, 0.0), _p_below(_mirrored(lower), 0.0)).max(axis=1)


def p_different(upper: Combination, lower: Combination, only_darker: np.ndarray | bool = False) -> np.ndarray:
    """p-value (K,) of "outside the tolerance in some channel".

    Bonferroni over three channels and two ends.
    In regions `only_darker` (K,), a candidate that is brighter than the reference shows nothing.
    """
    brighter = np.where(np.asarray(only_darker)[..., None], 1.0, _p_below(_mirrored(upper), 1.0))
    best = np.minimum(brighter, _p_below(lower, 1.0)).min(axis=1)
    return np.minimum(WAYS_TO_DIFFER * best, 1.0)


def difference(candidate: Moments, reference: Moments, floor: np.ndarray | float) -> np.ndarray:
    """The estimated (C - E) / max(|E|, floor), (K, 3).

    It is 0 where both are 0, infinite where only the reference is.
    """
    return relative_difference(candidate.mean - reference.mean, reference.mean, floor)


def interval(
    candidate: Moments, reference: Moments, floor: np.ndarray | float, tail: np.ndarray | float
) -> tuple[np.ndarray, np.ndarray]:
    """Both ends (K, 3) of the confidence interval of the relative difference.

    The probability beyond each end is `tail`.
    Fieller's: all rho with (C - rho E)^2 <= q^2 (var C + rho^2 var E); infinite ends where E is not
    distinct from 0, and about (C - E) / floor where |E| is below `floor`. NaN where a side has fewer than two
    replicates.
    """
    plain = combine(candidate, reference, 1.0)
    if np.isnan(plain.df).all():
        return plain.df, plain.df
    q = -stdtrit(plain.df, tail)
    c, e = candidate.mean, reference.mean
    qa, qb = q * q * candidate.variance / candidate.count, q * q * reference.variance / reference.count
    with np.errstate(divide="ignore", invalid="ignore"):
        lead = e * e - qb
        root = np.sqrt(np.maximum(c * c * qb + e * e * qa - qa * qb, 0.0))
        bounded = lead > 0
        low = np.where(bounded, (c * e - root) / lead - 1, -np.inf)
        high = np.where(bounded, (c * e + root) / lead - 1, np.inf)
        dark = np.abs(e) < floor
        low = np.where(dark, (plain.value - q * plain.error) / floor, low)
        high = np.where(dark, (plain.value + q * plain.error) / floor, high)
    exact = (plain.error == 0) & ~bounded & ~dark
    sure = difference(candidate, reference, floor)
    missing = np.isnan(plain.value)
    low, high = np.where(exact, sure, low), np.where(exact, sure, high)
    return np.where(missing, np.nan, low), np.where(missing, np.nan, high)


def bound(candidate: Moments, reference: Moments, floor: np.ndarray | float, tail: np.ndarray | float) -> np.ndarray:
    """The smallest tolerance (K,) at which each region would be within it.

    Each claim has error `tail`. NaN without a mean.
    It is the larger end of the interval, in the channel furthest off: two one-sided tests at `tail` pass for a
    tolerance exactly where the interval lies inside (Schuirmann 1987). Infinite where a side has fewer than two
    replicates.
    """
    low, high = interval(candidate, reference, floor, tail)
    ends = np.maximum(np.abs(low), np.abs(high))
    ends = np.where(np.isnan(ends), np.inf, ends).max(axis=1)
    return np.where(np.isnan(candidate.mean + reference.mean).any(axis=1), np.nan, ends)
