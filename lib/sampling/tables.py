# SPDX-License-Identifier: GPL-3.0-or-later
"""Piecewise-constant distributions in one and two dimensions, sampled by inversion.

Inversion keeps neighbouring uniforms neighbours, so that low-discrepancy points stay well spread; an alias table
would not. The search starts from a guide table (Chen and Asau 1974; Devroye 1986, section III.2.4), which leaves it
less than one comparison on the average, whatever the size of the table.
"""

from __future__ import annotations

import numpy as np

from ..vectors import gather

LARGEST_UNIFORM = np.nextafter(1.0, 0.0)
# Up to so many entries comparing with each edge beats the guide.
_FEW = 24
# Entries of the guide that are made at a time.
_GUIDED = 1 << 16


class Distribution1D:
    """Index i with probability weights[i] / sum(weights).

    `weights` (k,) finite and not negative; if all are zero every index is as likely as any other.
    `probability` (k,) is what `sample` gives.
    """

    def __init__(self, weights: np.ndarray) -> None:
        rows = Rows(np.asarray(weights, float)[None])
        self._rows = rows
        self.probability = rows.probability[0]

    def index(self, u: np.ndarray) -> np.ndarray:
        """Index (n,) intp for uniforms `u` in [0, 1)."""
        return self._rows.index(u)

    def sample(self, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the index (n,) intp for uniforms `u` in [0, 1), and the rest of `u`.

        The rest is a uniform again, (n,).
        """
        return self._rows.sample(None, u)


class Distribution2D:
    """Cell (row, column) with probability weights[row, column] / sum(weights).

    `weights` (h, w) finite and not negative; if all are zero every cell is as likely as any other.
    `probability` (h, w) is what `sample` gives.
    """

    def __init__(self, weights: np.ndarray) -> None:
        weights = np.asarray(weights, float)
        self._marginal = Distribution1D(weights.sum(axis=1))
        self._rows = Rows(weights)
        self.probability = self._rows.probability * self._marginal.probability[:, None]

    def sample(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the row by `u1`, the column by `u2`, and the rest of each uniform.

        Row and column are intp. The rests are the place in the cell, in [0, 1).
        """
        row, down = self._marginal.sample(u1)
        column, along = self._rows.sample(row, u2)
        return row, column, down, along


class Rows:
    """Independent distributions of the same length, one a row of `weights` (rows, k).

    `weights` are finite and not negative; if all of a row are zero, every index is as likely as any other there. `probability`
    (rows, k) is what `sample` gives. Raises ValueError for other weights.
    """

    def __init__(self, weights: np.ndarray) -> None:
        if weights.size == 0 or not np.all(weights >= 0.0) or not np.isfinite(weights).all():
            raise ValueError("weights must be finite, not negative, and at least one")
        count, length = weights.shape
        peak = weights.max(axis=1, keepdims=True)
        scaled = weights / np.where(peak > 0.0, peak, 1.0)  # the sum of a row can then not overflow
        scaled[peak[:, 0] == 0.0] = 1.0
        upper = np.cumsum(scaled, axis=1)
        self.probability = scaled / upper[:, -1:]
        upper /= upper[:, -1:]
        self._length = length
        self._upper = upper.ravel()
        # A row's guide says, for every bucket of u, the first index that it can mean; a power of two keeps u * buckets exact.
        self._buckets = 4 << (length - 1).bit_length()
        guide = np.empty((count, self._buckets + 1), np.min_scalar_type(length))
        step = max(_GUIDED // (self._buckets + 1), 1)
        for row in range(0, count, step):  # as many rows as fit into a cache
            part = upper[row : row + step]
            # Of each edge, the first bucket that begins there or after it.
            place = np.ceil(part * self._buckets).astype(np.intp)
            place += np.arange(len(part))[:, None] * (self._buckets + 1)
            found = np.bincount(place.ravel(), minlength=len(part) * (self._buckets + 1))
            guide[row : row + step] = np.cumsum(found.reshape(len(part), -1), axis=1)
        self._guide = np.minimum(guide, length - 1, out=guide).ravel()

    def index(self, u: np.ndarray) -> np.ndarray:
        """Index (n,) by `u` where there is one row only."""
        if self._length > _FEW:
            return self._flat_index(None, u)
        index = np.zeros(u.shape, np.uint8)
        for edge in self._upper[:-1]:
            index += (u >= edge).view(np.uint8)
        return index.astype(np.intp)

    def sample(self, row: np.ndarray | None, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the index (n,) by `u` within `row` (n,), and the rest of `u`.

        `row` is None where there is one row only.
        """
        if self._length == 1:
            return np.zeros(u.shape, np.intp), u.copy()
        flat = self._flat_index(row, u)
        upper = gather(self._upper, flat)
        lower = np.take(self._upper, flat - 1, mode="wrap")
        index = flat if row is None else flat - row * self._length
        lower *= index != 0
        upper -= lower
        rest = u - lower
        rest /= upper
        return index, np.clip(rest, 0.0, LARGEST_UNIFORM, out=rest)

    def _flat_index(self, row: np.ndarray | None, u: np.ndarray) -> np.ndarray:
        """Index by `u` into all rows one after the other."""
        bucket = (u * self._buckets).astype(np.intp)
        if row is not None:
            bucket += row * (self._buckets + 1)
        first = gather(self._guide, bucket).astype(np.intp)
        bucket += 1
        last = gather(self._guide, bucket).astype(np.intp)
        if row is not None:
            start = row * self._length
            first += start
            last += start
        open_ = np.flatnonzero(first < last)
        if open_.size:
            first[open_] = self._bisect(first[open_], last[open_], u[open_])
        return first

    def _bisect(self, first: np.ndarray, last: np.ndarray, u: np.ndarray) -> np.ndarray:
        """First index in [first, last] whose upper edge exceeds u."""
        for _ in range(int((last - first).max()).bit_length()):
            middle = (first + last) >> 1
            beyond = gather(self._upper, middle) <= u
            np.copyto(first, np.minimum(middle + 1, last), where=beyond)
            np.copyto(last, middle, where=~beyond)
        return first
