# SPDX-License-Identifier: GPL-3.0-or-later
"""Weight, mean and sum of squared deviations, merged pairwise, never E[x^2] - E[x]^2."""

from __future__ import annotations

from dataclasses import dataclass
from typing import overload

import numpy as np

# Elements handled at a time: what adding an image needs beside the moments themselves.
_AT_A_TIME = 1 << 16


@dataclass
class Moments:
    """The mean and the squared deviations of observations of an array.

    `mean`, and `m2`, the sum of squared deviations from it, both have the array's shape.

    `n` is the sum of their weights, the number of observations where each has the weight 1, or, once some entries
    have been observed more often, that of each along the leading axes. An observation of weight w is one whose
    variance is 1 / w of the usual, such as the mean of w usual ones; `m2` counts its squared deviation w times.
    `times` is how many observations were made where some weights are not 1, of the shape of `n`; None where it is
    `n`.
    """

    n: int | np.ndarray
    mean: np.ndarray
    m2: np.ndarray
    times: int | np.ndarray | None = None

    @classmethod
    def empty(cls, shape: tuple[int, ...]) -> Moments:
        """No observation yet."""
        return cls(0, np.zeros(shape), np.zeros(shape))

    def part(self, rows: slice) -> Moments:
        """The moments of some of the entries along the first axis, as views."""
        times = None if self.times is None else _rows(self.times, rows)
        return Moments(_rows(self.n, rows), self.mean[rows], self.m2[rows], times)

    @property
    def most(self) -> int:
        """The weight of the entry that has most."""
        return int(self.n.max()) if isinstance(self.n, np.ndarray) else self.n

    @property
    def least(self) -> int:
        """The weight of the entry that has least."""
        return int(self.n.min()) if isinstance(self.n, np.ndarray) else self.n

    @property
    def count(self) -> int | np.ndarray:
        """`n` in a shape that broadcasts against the mean."""
        return self._spread_out(self.n)

    @property
    def df(self) -> int | np.ndarray:
        """The degrees of freedom of `variance`, one less than there are observations.

        Their shape broadcasts against the mean.
        """
        return self._spread_out(self.n if self.times is None else self.times) - 1

    @overload
    def _spread_out(self, counts: np.ndarray) -> np.ndarray: ...
    @overload
    def _spread_out(self, counts: int) -> int: ...
    @overload
    def _spread_out(self, counts: int | np.ndarray) -> int | np.ndarray: ...
    def _spread_out(self, counts: int | np.ndarray) -> int | np.ndarray:
        if not isinstance(counts, np.ndarray):
            return counts
        return counts.reshape(counts.shape + (1,) * (self.mean.ndim - counts.ndim))

    @property
    def variance(self) -> np.ndarray:
        """The unbiased variance of one observation of weight 1.

        NaN where fewer than two observations were made.
        """
        df = self.df
        if not isinstance(df, np.ndarray):
            return self.m2 * (np.nan if df < 1 else 1.0 / df)
        return self.m2 * np.where(df < 1, np.nan, 1.0 / np.maximum(df, 1))

    @property
    def standard_error(self) -> np.ndarray:
        """Standard deviation of the mean; NaN where fewer than two observations were made."""
        error = self.variance
        error /= np.maximum(self.count, 1)
        return np.sqrt(error, out=error)

    def add(self, values: np.ndarray, where: np.ndarray | None = None, weight: int = 1) -> None:
        """Take one observation more into these moments: `merge` with n = `weight`.

        With `where`, a mask over the leading axes, those entries alone are observed, and each keeps its own count from then on.
        """
        if weight != 1 and self.times is None:
            self.times = np.copy(self.n) if isinstance(self.n, np.ndarray) else self.n
        if where is not None:
            self.n = counts = _counted(self.n, where, weight)
            self.times = None if self.times is None else _counted(self.times, where, 1)
            self._update(where, values[where], self._spread_out(counts)[where], weight)
            return
        self.n = self.n + weight
        self.times = None if self.times is None else self.times + 1
        rows = max(_AT_A_TIME // max(values[:1].size, 1), 1)
        for start in range(0, len(values), rows):
            part = slice(start, start + rows)
            self._update(part, values[part], _rows(self.count, part), weight)

    def _update(self, part: slice | np.ndarray, values: np.ndarray, n: int | np.ndarray, weight: int) -> None:
        delta = values - self.mean[part]
        self.mean[part] += delta * (weight / n)
        delta *= delta
        delta *= weight * (n - weight) / n
        self.m2[part] += delta


def _rows(counts: int | np.ndarray, rows: slice) -> int | np.ndarray:
    """`counts` of some of the entries along the first axis."""
    return counts[rows] if isinstance(counts, np.ndarray) else counts


def _counted(counts: int | np.ndarray, where: np.ndarray, by: int) -> np.ndarray:
    """`counts` of each entry, raised `by` so much `where` it was observed."""
    each = counts if isinstance(counts, np.ndarray) else np.full(where.shape, counts, np.int32)
    each[where] += by
    return each


def merge(a: Moments, b: Moments) -> Moments:
    """Return the moments of the observations of `a` and `b` together.

    Both have one count for all entries, and all their weights are 1.

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
