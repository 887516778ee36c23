# SPDX-License-Identifier: GPL-3.0-or-later
"""Shares: the part of a difference that the effect of a departure makes up.

It is a ratio of two noisy numbers.
With the gap g = C - E of a region and the effect d that a set of departures has there, the share is d / g, in the
channel furthest off. g and d come from different replicates and are independent. A statement "the share is below s" is
one about the linear combination C - E - d / s, whose noise is known (Fieller 1954); no ratio of estimates is tested.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from ..film.moments import Moments
from .claims import Combination, combine, p_equivalent
from .fieller import fieller

# The channel furthest off is found from the data, so a statement about it counts for all three.
CHANNELS = 3


@dataclass(frozen=True)
class Sides:
    """Moments (N, 3) of the means of N regions on both sides.

    `scale` (N, 3) is what differences are relative to.
    """

    reference: Moments
    candidate: Moments
    scale: np.ndarray

    @property
    def gap(self) -> np.ndarray:
        """C - E as estimated, (N, 3)."""
        return self.candidate.mean - self.reference.mean

    @property
    def channel(self) -> np.ndarray:
        """The channel (N, 1) in which each region is furthest off."""
        with np.errstate(divide="ignore", invalid="ignore"):
            size = np.abs(self.gap / self.scale)
        return np.argmax(np.nan_to_num(size, nan=-1.0, posinf=np.inf), axis=1)[:, None]


def share(sides: Sides, effect: Moments) -> np.ndarray:
    """The share (N,) of `effect` (moments (N, 3) over pairs of replicates) as estimated."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return (_of(effect, sides.channel).mean / np.take_along_axis(sides.gap, sides.channel, 1))[:, 0]


def share_interval(sides: Sides, effect: Moments, tail: float) -> tuple[np.ndarray, np.ndarray]:
    """Both ends (N,) of Fieller's interval of the share, with probability `tail` beyond each.

    The degrees of freedom are Satterthwaite's for C - E - d, the combination that is zero where the share is 1. Infinite where the gap is
    not distinct from 0, and where a side or the effect has fewer than two replicates.
    """
    channel = sides.channel
    reference, candidate, d = (_of(moments, channel) for moments in (sides.reference, sides.candidate, effect))
    rest, gap = combine(candidate, reference, 1.0, shift=d), combine(candidate, reference, 1.0)
    with np.errstate(invalid="ignore"):
        q = -stdtrit(rest.df, tail)
        low, high = fieller(d.mean, gap.value, (d.variance / d.count, gap.error**2), 0.0, q)
    return low[:, 0], high[:, 0]


def p_share_between(sides: Sides, effect: Moments, low: float, high: float) -> np.ndarray:
    """p-value (N,) of "low < share < high", 0 < low < high, in the channel furthest off.

    The p-value accounts for the choice of this channel.
    Two one-sided tests of C - E - d / low and C - E - d / high; the sign of the gap is the estimated one, which is
    right where the region was shown to differ.
    """
    channel = sides.channel
    sign = np.sign(np.take_along_axis(sides.gap, channel, 1))
    ends = [_signed(less(sides, effect, end), channel, sign) for end in (low, high)]
    return np.minimum(CHANNELS * p_equivalent(*ends), 1.0)


def less(sides: Sides, effect: Moments, part: float) -> Combination:
    """C - E - d / part, (N, 3): zero where the share is `part`."""
    scaled = Moments(effect.n, effect.mean / part, effect.m2 / (part * part), effect.times)
    return combine(sides.candidate, sides.reference, 1.0, shift=scaled)


def _signed(c: Combination, channel: np.ndarray, sign: np.ndarray) -> Combination:
    value, error, df = (
        np.take_along_axis(np.broadcast_to(v, c.value.shape), channel, 1) for v in (c.value, c.error, c.df)
    )
    return Combination(sign * value, error, df)


def _of(moments: Moments, channel: np.ndarray) -> Moments:
    """The moments (N, 1) of one channel of each region."""
    mean, m2 = (np.take_along_axis(one, channel, 1) for one in (moments.mean, moments.m2))
    return Moments(moments.n, mean, m2, moments.times)
