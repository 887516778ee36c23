# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of boxes in a plane that overlap, for many planes at once.

A sweep finds them in small groups, a grid in large ones.
"""

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
    if boxes.group.size == 0:
        return
    extent = np.maximum(np.maximum(boxes.right - boxes.left, boxes.high - boxes.low), 1e-300)
    level = np.ceil(_LEVELS * np.log2(extent)).astype(np.int64)
    group = np.cumsum(np.append(False, boxes.group[1:] != boxes.group[:-1]))
    for one in np.unique(level):
        has_level = np.zeros(group[-1] + 1, bool)
        has_level[group[level == one]] = True
        within = np.flatnonzero((level <= one) & has_level[group])
        cell, rows = _cells(boxes, within, group, 2.0 ** (float(one) / _LEVELS))
        own = level[within] == one
        entries = _Table(within[own], cell[own])
        finer, their_cell = within[~own], cell[~own]
        # A box reaches at most one cell beyond that of its lower corner, so those that overlap lie in 3 x 3 cells;
        # between boxes of one level half of these give each pair once.
        offsets = [dx * rows + dy for dx in (-1, 0, 1) for dy in (-1, 0, 1)]
        for offset in offsets:
            if offset >= 0:
                yield from _joined(boxes, entries, entries.box, entries.cell + offset, halved=offset == 0)
        if (
            entries.box.size < finer.size
        ):  # all nine at once: the few into nine cells each, so that the many are looked up once
            spread = _Table(np.tile(entries.box, 9), np.concatenate([entries.cell - offset for offset in offsets]))
            yield from _joined(boxes, spread, finer, their_cell, halved=False)
        elif finer.size:
            for offset in offsets:
                yield from _joined(boxes, entries, finer, their_cell + offset, halved=False)


def _cells(boxes: Boxes, index: np.ndarray, group: np.ndarray, size: float) -> tuple[np.ndarray, int]:
    """The cell (k,), of `size`, of the lower corner of each box at `index` (k,).

    Each group numbers its own cells. Also returns the number of cells in a column.
    """
    x = np.floor(boxes.left[index] / size).astype(np.int64)
    y = np.floor(boxes.low[index] / size).astype(np.int64)
    columns, rows = int(np.ptp(x)) + 3, int(np.ptp(y)) + 3
    return (group[index] * columns + (x - x.min() + 1)) * rows + (y - y.min() + 1), rows


class _Table:
    """Boxes (n,) sorted by the cell (n,) that each is in.

    It knows where each cell that has any box begins.
    """

    def __init__(self, box: np.ndarray, cell: np.ndarray) -> None:
        order = np.argsort(cell, kind="stable")
        self.box, self.cell = box[order], cell[order]
        self._starts = np.flatnonzero(np.append(True, self.cell[1:] != self.cell[:-1]))
        self._counts = np.diff(np.append(self._starts, self.cell.size))

    def find(self, cell: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Which of the cells (k,) have boxes, where these begin, and how many there are."""
        at = np.searchsorted(self.cell[self._starts], cell)
        at = np.minimum(at, self._starts.size - 1)
        found = np.flatnonzero(self.cell[self._starts[at]] == cell)
        return found, self._starts[at[found]], self._counts[at[found]]


def _joined(boxes: Boxes, entries: _Table, asking: np.ndarray, cell: np.ndarray, halved: bool) -> Pairs:
    """The boxes `asking` (k,) with those entries in `cell` (k,) that they overlap."""
    found, start, count = entries.find(cell)
    asking = asking[found]
    total = np.cumsum(count)
    begin = 0
    while begin < count.size:
        before = total[begin - 1] if begin else 0
        end = max(int(np.searchsorted(total, before + _PAIRS_AT_ONCE, "right")), begin + 1)
        n = count[begin:end]
        first = np.repeat(asking[begin:end], n)
        second = entries.box[np.repeat(start[begin:end] - np.cumsum(n) + n, n) + np.arange(first.size)]
        hit = boxes.overlap(first, second)
        if halved:
            hit &= first < second
        index = np.flatnonzero(hit)
        if index.size:
            yield first[index], second[index]
        begin = end
