# SPDX-License-Identifier: GPL-3.0-or-later
"""Count, mean and sum of squared deviations, merged pairwise, never E[x^2] - E[x]^2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Moments:
    """`n` observations of an array: their `mean` and `m2`, the sum of squared deviations from it, both of the array's shape."""

    n: int
    mean: np.ndarray
    m2: np.ndarray

    @classmethod
    def empty(cls, shape: tuple[int, ...]) -> Moments:
        """No observation yet."""
        return cls(0, np.zeros(shape), np.zeros(shape))

    @property
    def variance(self) -> np.ndarray:
        """Unbiased variance of one observation; NaN where fewer than two were made."""
        if self.n < 2:
            return np.full(self.mean.shape, np.nan)
        return self.m2 / (self.n - 1)

    @property
    def standard_error(self) -> np.ndarray:
        """Standard deviation of the mean; NaN where fewer than two observations were made."""
        return np.sqrt(self.variance / max(self.n, 1))

    def add(self, values: np.ndarray) -> Moments:
        """These moments and one observation more: `merge` with n = 1, in three arrays instead of seven."""
        n = self.n + 1
        delta = values - self.mean
        mean = delta * (1.0 / n)
        mean += self.mean
        delta *= delta
        delta *= self.n / n
        delta += self.m2
        return Moments(n, mean, delta)


def merge(a: Moments, b: Moments) -> Moments:
    """Moments of the observations of `a` and `b` together.

    Chan, Golub and LeVeque, "Updating formulae and a pairwise algorithm for computing sample variances" (1979),
    eq. 2.1: exact in exact arithmetic, so that tiles, seeds and machines merge in any order.
    """
    if a.n == 0 or b.n == 0:
        return b if a.n == 0 else a
    n = a.n + b.n
    delta = b.mean - a.mean
    mean = a.mean + delta * (b.n / n)
    m2 = a.m2 + b.m2 + delta * delta * (a.n * b.n / n)
    return Moments(n, mean, m2)
