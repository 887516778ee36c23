# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of boxes about triangles that overlap, for many planes at once.

A sweep finds them in small groups, a grid in large ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

_SMALL = 24
_PAIRS_AT_ONCE = 1 << 16
# Levels of the grid for each power of two of the boxes' size.
_LEVELS = 2
# Cells with more boxes than this, on average, are searched by height.
_LONG = 4
# Steps of height that are told apart in a column of the grid.
_HEIGHT_BITS = 30
_ALL_LOWEST = 0b1111

Pairs = Iterator[tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True)
class Boxes:
    """Boxes about triangles: two axes in their plane, and the height above a plane that their group shares.

    `group` (m,) int, sorted; `lowest` (m,) uint8: bits, see Rows; `low` and `high` (3 axes, m).
    """

    group: np.ndarray
    lowest: np.ndarray
    low: np.ndarray
    high: np.ndarray

    def at(self, index: np.ndarray) -> Boxes:
        """The boxes at `index`, as copies."""
        return Boxes(*(np.take(values, index, axis=-1) for values in vars(self).values()))


def near_pairs(boxes: Boxes) -> Pairs:
    """Pairs (k,), (k,) of overlapping boxes of one group, in batches.

    Of two triangles that share several groups, only the one in which each bit is set for either gives their pair.
    """
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
        first, second = _overlapping(boxes, active, boxes, active + step)
        if first.size:
            yield first, second


def _grid(boxes: Boxes) -> Pairs:
    """Each box against those in cells near it, of its size and of each larger one."""
    if boxes.group.size == 0:
        return
    extent = np.maximum((boxes.high - boxes.low)[:2].max(axis=0), 1e-300)
    level = np.ceil(_LEVELS * np.log2(extent)).astype(np.int64)
    group = np.cumsum(np.append(False, boxes.group[1:] != boxes.group[:-1]))
    for one in np.unique(level):
        has_level = np.zeros(group[-1] + 1, bool)
        has_level[group[level == one]] = True
        within = np.flatnonzero((level <= one) & has_level[group])
        cell, rows = _cells(boxes, within, group, 2.0 ** (float(one) / _LEVELS))
        own = level[within] == one
        entries = _Table(boxes, within[own], cell[own])
        # A box reaches at most one cell beyond that of its lower corner, so those that overlap lie in 3 x 3 cells;
        # between boxes of one level half of these give each pair once.
        offsets = [dx * rows + dy for dx in (-1, 0, 1) for dy in (-1, 0, 1)]
        yield from entries.within_cells()
        for offset in offsets[5:]:
            yield from entries.joined(entries.boxes, entries.index, entries.cell + offset)
        finer, their_cell = within[~own], cell[~own]
        if finer.size == 0:
            continue
        asking = boxes.at(finer)
        if entries.index.size < finer.size:
            # All nine at once: the few into nine cells each, so that the many are looked up once.
            spread = np.concatenate([entries.cell - offset for offset in offsets])
            yield from _Table(boxes, np.tile(entries.index, 9), spread).joined(asking, finer, their_cell)
        else:
            for offset in offsets:
                yield from entries.joined(asking, finer, their_cell + offset)


def _cells(boxes: Boxes, index: np.ndarray, group: np.ndarray, size: float) -> tuple[np.ndarray, int]:
    """The cell (k,), of `size`, of the lower corner of each box at `index` (k,).

    Each group numbers its own cells. Also returns the number of cells in a column.
    """
    x, y = (np.floor(low[index] / size).astype(np.int64) for low in boxes.low[:2])
    columns, rows = int(np.ptp(x)) + 3, int(np.ptp(y)) + 3
    return (group[index] * columns + (x - x.min() + 1)) * rows + (y - y.min() + 1), rows


class _Table:
    """Boxes (n,) sorted by the cell (n,) that each is in, and where cells are long, there by height.

    It knows where the run of each cell that has any box begins.
    """

    def __init__(self, boxes: Boxes, index: np.ndarray, cell: np.ndarray) -> None:
        order = np.argsort(cell, kind="stable")
        cell = cell[order]
        starts = np.flatnonzero(np.append(True, cell[1:] != cell[:-1]))
        self._starts, self._ends = starts, np.append(starts[1:], cell.size)
        self._numbers = cell[starts]
        self._run = np.repeat(np.arange(starts.size), self._ends - starts)
        self._key = None
        if cell.size > _LONG * starts.size:
            bottom, top = boxes.low[2, index[order]], boxes.high[2, index[order]]
            self._thickness = np.maximum.reduceat(top - bottom, starts)
            self._lowest = bottom.min()
            self._step = max(float(np.ptp(bottom)), 1e-300) / 2.0**_HEIGHT_BITS
            key = self._keys(self._run, bottom)
            by_height = np.argsort(key, kind="stable")
            self._key, order = key[by_height], order[by_height]
        self.index, self.cell = index[order], cell
        self.boxes = boxes.at(self.index)

    def _keys(self, run: np.ndarray, height: np.ndarray) -> np.ndarray:
        """Numbers that order boxes by the run of their cell, and then by height."""
        steps = (height - (self._lowest - self._step)) / self._step
        np.clip(steps, 0.0, 2.0**_HEIGHT_BITS + 2.0, out=steps)
        return (run << (_HEIGHT_BITS + 1)) + steps.astype(np.int64)

    def within_cells(self) -> Pairs:
        """Those that overlap others of their own cell, each pair once."""
        own = np.arange(self.cell.size)
        return self._tested(self.boxes, self.index, own, own + 1, self._end(self._run, self.boxes.high[2]))

    def joined(self, asking: Boxes, index: np.ndarray, cell: np.ndarray) -> Pairs:
        """The boxes `asking`, with their `index` (k,), and those in `cell` (k,) that they overlap."""
        run = np.minimum(np.searchsorted(self._numbers, cell), self._numbers.size - 1)
        found = np.flatnonzero(self._numbers[run] == cell)
        run = run[found]
        start, end = self._start(run, asking.low[2, found]), self._end(run, asking.high[2, found])
        return self._tested(asking, index, found, start, end)

    def _start(self, run: np.ndarray, bottom: np.ndarray) -> np.ndarray:
        """Where boxes begin in each `run` (k,) that may reach above `bottom` (k,)."""
        if self._key is None:
            return self._starts[run]
        return np.searchsorted(self._key, self._keys(run, bottom - self._thickness[run]))

    def _end(self, run: np.ndarray, top: np.ndarray) -> np.ndarray:
        """Where boxes end in each `run` (k,) that may begin below `top` (k,)."""
        if self._key is None:
            return self._ends[run]
        return np.searchsorted(self._key, self._keys(run, top), "right")

    def _tested(
        self, asking: Boxes, index: np.ndarray, number: np.ndarray, start: np.ndarray, end: np.ndarray
    ) -> Pairs:
        """Those of `asking` at `number` (k,), each with the boxes from `start` to `end` (k,) that it overlaps."""
        some = np.flatnonzero(end > start)
        number, start, count = number[some], start[some], (end - start)[some]
        total = np.cumsum(count)
        begin = 0
        while begin < count.size:
            before = total[begin - 1] if begin else 0
            last = max(int(np.searchsorted(total, before + _PAIRS_AT_ONCE, "right")), begin + 1)
            n = count[begin:last]
            first = np.repeat(number[begin:last], n)
            second = np.repeat(start[begin:last] - np.cumsum(n) + n, n) + np.arange(first.size)
            first, second = _overlapping(asking, first, self.boxes, second)
            if first.size:
                yield index[first], self.index[second]
            begin = last


def _overlapping(one: Boxes, first: np.ndarray, other: Boxes, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The pairs of boxes (n,), (n,) that overlap, in the group that gives their pair."""
    for k in range(3):
        hit = np.take(one.low[k], first) < np.take(other.high[k], second)
        hit &= np.take(other.low[k], second) < np.take(one.high[k], first)
        left = np.flatnonzero(hit)
        first, second = first[left], second[left]
    left = np.flatnonzero((np.take(one.lowest, first) | np.take(other.lowest, second)) == _ALL_LOWEST)
    return first[left], second[left]
