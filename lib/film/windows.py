# SPDX-License-Identifier: GPL-3.0-or-later
"""Rectangles of pixels that are rendered while the rest of the image stays as it is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

# What a call of a renderer costs beside its pixels, in samples: rectangles are joined where that is cheaper.
CALL = 1 << 15
# There are no more rectangles than _MOST; they are put together from squares of _EDGE pixels or more, _TRIED rows of them at most.
_MOST, _EDGE, _TRIED = 32, 8, 256

Box = tuple[int, int, int, int]


@dataclass(frozen=True)
class Windows:
    """Rectangles in an image of `shape` (height, width); they may overlap.

    `boxes` has the first column, first row, last column and last row of each.
    """

    shape: tuple[int, int]
    boxes: tuple[Box, ...]

    @cached_property
    def mask(self) -> np.ndarray:
        """The pixels (height, width) inside."""
        inside = np.zeros(self.shape, bool)
        for left, top, right, bottom in self.boxes:
            inside[top : bottom + 1, left : right + 1] = True
        return inside

    @cached_property
    def pixels(self) -> int:
        """How many pixels are inside."""
        return int(self.mask.sum())

    @property
    def share(self) -> float:
        """The part of the image's pixels that is inside."""
        return self.pixels / self.mask.size


def windows_around(inside: np.ndarray, samples: int) -> Windows:
    """Return few rectangles that cover the pixels `inside` (height, width), as tightly as pays.

    Two rectangles become one if that adds less than a call costs.

    `samples` is how many a pixel gets in a call.
    """
    edge = _EDGE
    while len(boxes := _rows_of_squares(inside, edge)) > _TRIED:
        edge *= 2
    while len(boxes) > 1:
        low, high = np.minimum(boxes[:, None, :2], boxes[:, :2]), np.maximum(boxes[:, None, 2:], boxes[:, 2:])
        areas = _area(boxes)
        added = np.prod(high - low + 1, axis=2) - areas[:, None] - areas
        np.fill_diagonal(added, np.iinfo(added.dtype).max)
        one, other = np.unravel_index(int(np.argmin(added)), added.shape)
        if added[one, other] * samples > CALL and len(boxes) <= _MOST:
            break
        joined = np.append(low[one, other], high[one, other])
        boxes = np.append(np.delete(boxes, (one, other), axis=0), joined[None], axis=0)
    found = [_trimmed(inside, box) for box in boxes.tolist()]
    return Windows(inside.shape, tuple(sorted(found, key=lambda box: (box[1], box[0]))))


def _rows_of_squares(inside: np.ndarray, edge: int) -> np.ndarray:
    """Rectangles (N, 4) that cover the pixels `inside`, as in Windows.

    They are rows of squares of `edge` pixels, those of equal ends below each other as one.
    """
    height, width = inside.shape
    squares = np.logical_or.reduceat(np.logical_or.reduceat(inside, range(0, height, edge)), range(0, width, edge), 1)
    # The uppermost row of each, by its ends and its lowest row.
    found: dict[tuple[int, int, int], int] = {}
    for row, line in enumerate(squares):
        ends = np.flatnonzero(np.diff(np.concatenate([[False], line, [False]]).astype(np.int8)))
        for first, end in zip(ends[::2].tolist(), ends[1::2].tolist(), strict=True):
            top = found.pop((first, end - 1, row - 1), row)
            found[first, end - 1, row] = top
    boxes = np.array([(left, top, right, low) for (left, right, low), top in found.items()]).reshape(-1, 4) * edge
    boxes[:, 2:] += edge - 1
    return np.minimum(boxes, [width - 1, height - 1, width - 1, height - 1])


def _trimmed(inside: np.ndarray, box: list[int]) -> Box:
    """The rectangle without the rows and columns at its sides in which nothing is `inside`."""
    left, top, right, bottom = box
    part = inside[top : bottom + 1, left : right + 1]
    rows, columns = np.flatnonzero(part.any(axis=1)), np.flatnonzero(part.any(axis=0))
    return left + int(columns[0]), top + int(rows[0]), left + int(columns[-1]), top + int(rows[-1])


def _area(boxes: np.ndarray) -> np.ndarray:
    return np.prod(boxes[:, 2:] - boxes[:, :2] + 1, axis=1)
