# SPDX-License-Identifier: GPL-3.0-or-later
"""Count, mean and sum of squared deviations, merged pairwise, never E[x^2] - E[x]^2."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# Elements handled at a time: what adding an image needs beside the moments themselves.
_AT_A_TIME = 1 << 16


@dataclass
class Moments:
    """Observations of an array: their `mean` and `m2`, the sum of squared deviations from it, both of the array's shape.

    `n` is how many, or, once some entries have been observed more often, how many of each along the leading axes.
    """

    n: int | np.ndarray
    mean: np.ndarray
    m2: np.ndarray

    @classmethod
    def empty(cls, shape: tuple[int, ...]) -> Moments:
        """No observation yet."""
        return cls(0, np.zeros(shape), np.zeros(shape))

    def part(self, rows: slice) -> Moments:
        """The moments of some of the entries along the first axis, as views."""
        return Moments(self.n if np.ndim(self.n) == 0 else self.n[rows], self.mean[rows], self.m2[rows])

    @property
    def most(self) -> int:
        """The number of observations of the entry that has most."""
        return int(self.n.max()) if isinstance(self.n, np.ndarray) else self.n

    @property
    def least(self) -> int:
        """The number of observations of the entry that has fewest."""
        return int(self.n.min()) if isinstance(self.n, np.ndarray) else self.n

    @property
    def count(self) -> int | np.ndarray:
        """`n` in a shape that broadcasts against the mean."""
        if not isinstance(self.n, np.ndarray):
            return self.n
        return self.n.reshape(self.n.shape + (1,) * (self.mean.ndim - self.n.ndim))

    @property
    def variance(self) -> np.ndarray:
        """Unbiased variance of one observation; NaN where fewer than two were made."""
        n = self.count
        if not isinstance(n, np.ndarray):
            return self.m2 * (np.nan if n < 2 else 1.0 / (n - 1))
        return self.m2 * np.where(n < 2, np.nan, 1.0 / np.maximum(n - 1, 1))

    @property
    def standard_error(self) -> np.ndarray:
        """Standard deviation of the mean; NaN where fewer than two observations were made."""
        error = self.variance
        error /= np.maximum(self.count, 1)
        return np.sqrt(error, out=error)

    def add(self, values: np.ndarray, where: np.ndarray | None = None) -> None:
        """Take one observation more into these moments: `merge` with n = 1.

        With `where`, a mask over the leading axes, those entries alone are observed, and each keeps its own count from then on.
        """
        if where is not None:
            self.n = np.full(where.shape, self.n, np.int32) if np.ndim(self.n) == 0 else self.n
            self.n[where] += 1
            self._update(where, values[where], self.count[where])
            return
        self.n = self.n + 1
        rows = max(_AT_A_TIME // max(values[:1].size, 1), 1)
        for start in range(0, len(values), rows):
            part = slice(start, start + rows)
            self._update(part, values[part], self.count if np.ndim(self.n) == 0 else self.count[part])

    def _update(self, part: slice | np.ndarray, values: np.ndarray, n: int | np.ndarray) -> None:
        delta = values - self.mean[part]
        self.mean[part] += delta * (1.0 / n)
        delta *= delta
        delta *= (n - 1) / n
        self.m2[part] += delta


def merge(a: Moments, b: Moments) -> Moments:
    """Moments of the observations of `a` and `b` together, each with one count for all entries.

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
