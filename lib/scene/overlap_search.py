# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of boxes in a plane that overlap, for many planes at once: a sweep over small groups, a grid for large ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

_SMALL = 24
_PAIRS_AT_ONCE = 1 << 18
# Levels of the grid for each power of two of the boxes' size.
_LEVELS = 2

Pairs = Iterator[tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Boxes:
    """Boxes in planes: the group (m,) int that each is in, sorted, and its sides (m,)."""

    group: np.ndarray
    left: np.ndarray
    low: np.ndarray
    right: np.ndarray
    high: np.ndarray

    def at(self, index: np.ndarray) -> Boxes:
        """The boxes at `index`, as copies."""
        return Boxes(*(values[index] for values in vars(self).values()))

    def overlap(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Whether boxes overlap, (n,) bool."""
        hit = np.take(self.left, first) < np.take(self.right, second)
        hit &= np.take(self.left, second) < np.take(self.right, first)
        hit &= np.take(self.low, first) < np.take(self.high, second)
        hit &= np.take(self.low, second) < np.take(self.high, first)
        return hit


def near_pairs(boxes: Boxes) -> Pairs:
    """Pairs (k,), (k,) of overlapping boxes of one group, each pair once, in batches."""
    if boxes.group.size == 0:
        return
    edges = np.flatnonzero(np.append(True, boxes.group[1:] != boxes.group[:-1]))
    sizes = np.diff(np.append(edges, boxes.group.size))
    small = np.repeat(sizes <= _SMALL, sizes)
    for chosen, search in ((small, _sweep), (~small, _grid)):
        index = np.flatnonzero(chosen)
        for first, second in search(boxes.at(index)):
            yield index[first], index[second]


def _sweep(boxes: Boxes) -> Pairs:
    """Each box against those that follow in its group."""
    active = np.arange(boxes.group.size)
    step = 0
    while active.size:
        step += 1
        active = active[active + step < boxes.group.size]
        active = active[boxes.group[active] == boxes.group[active + step]]
        hit = np.flatnonzero(boxes.overlap(active, active + step))
        if hit.size:
            yield active[hit], active[hit] + step


def _grid(boxes: Boxes) -> Pairs:
    """Each box against those in cells near it, of its size and of each larger one."""
    extent = np.maximum(np.maximum(boxes.right - boxes.left, boxes.high - boxes.low), 1e-300)
    level = np.ceil(_LEVELS * np.log2(extent)).astype(np.int64)
    for one in np.unique(level):
        size = 2.0 ** (float(one) / _LEVELS)
        x, y = np.floor(boxes.left / size).astype(np.int64), np.floor(boxes.low / size).astype(np.int64)
        columns, rows = np.ptp(x) + 3, np.ptp(y) + 3
        cell = (boxes.group * columns + (x - x.min() + 1)) * rows + (y - y.min() + 1)
        entries = np.flatnonzero(level == one)
        entries = entries[np.argsort(cell[entries], kind="stable")]
        finer = np.flatnonzero((level < one) & np.isin(boxes.group, boxes.group[entries]))
        # A box reaches at most one cell beyond that of its lower corner, so those that overlap lie in 3 x 3 cells;
        # between boxes of one level half of these give each pair once.
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                offset = dx * rows + dy
                if offset >= 0:
                    yield from _joined(boxes, cell, entries, entries, offset, halved=offset == 0)
                if finer.size:
                    yield from _joined(boxes, cell, entries, finer, offset, halved=False)


def _joined(
    boxes: Boxes, cell: np.ndarray, entries: np.ndarray, asking: np.ndarray, offset: int, halved: bool
) -> Pairs:
    """The boxes `asking` beside those `entries`, sorted by cell, whose cell is by `offset` further on."""
    keys = cell[entries]
    starts = np.flatnonzero(np.append(True, keys[1:] != keys[:-1]))
    counts = np.diff(np.append(starts, keys.size))
    wanted = cell[asking] + offset
    at = np.searchsorted(keys[starts], wanted)
    found = np.flatnonzero(keys[starts[np.minimum(at, starts.size - 1)]] == wanted)
    start, count, asking = starts[at[found]], counts[at[found]], asking[found]
    total = np.cumsum(count)
    begin = 0
    while begin < count.size:
        before = total[begin - 1] if begin else 0
        end = max(int(np.searchsorted(total, before + _PAIRS_AT_ONCE, "right")), begin + 1)
        n = count[begin:end]
        first = np.repeat(asking[begin:end], n)
        second = entries[np.repeat(start[begin:end] - np.cumsum(n) + n, n) + np.arange(first.size)]
        hit = boxes.overlap(first, second)
        if halved:
            hit &= first < second
        index = np.flatnonzero(hit)
        if index.size:
            yield first[index], second[index]
        begin = end
