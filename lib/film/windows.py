# SPDX-License-Identifier: GPL-3.0-or-later
"""Rectangles of pixels that are rendered while the rest of the image stays as it is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

# What a call of a renderer costs beside its pixels, in samples: rectangles are joined where that is cheaper.
_CALL = 1 << 15
# So many are weighed against each other; where there are more, those that are so many pixels apart become one first.
_MOST, _STEP = 32, 8

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

    @property
    def pixels(self) -> int:
        """How many pixels are inside."""
        return int(self.mask.sum())


def windows_around(inside: np.ndarray, samples: int) -> Windows:
    """Return few rectangles that cover the pixels `inside` (height, width).

    Two rectangles become one if that adds less than a call costs.

    `samples` is how many a pixel gets in a call.
    """
    wide = inside
    while True:
        labels, count = scipy.ndimage.label(wide, np.ones((3, 3)))
        if count <= _MOST:
            break
        wide = scipy.ndimage.binary_dilation(wide, np.ones((3, 3)), iterations=_STEP)
    parts = scipy.ndimage.find_objects(labels)
    left = [(x.start, y.start, x.stop - 1, y.stop - 1) for y, x in parts]
    while len(left) > 1:
        joined = {(i, j): _join(left[i], left[j]) for i in range(len(left)) for j in range(i)}
        added = {pair: _area(box) - _area(left[pair[0]]) - _area(left[pair[1]]) for pair, box in joined.items()}
        pair = min(added, key=added.__getitem__)
        if added[pair] * samples > _CALL:
            break
        left = [box for k, box in enumerate(left) if k not in pair] + [joined[pair]]
    return Windows(inside.shape, tuple(sorted(left, key=lambda box: (box[1], box[0]))))


def _join(a: Box, b: Box) -> Box:
    return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])


def _area(box: Box) -> int:
    return (box[2] - box[0] + 1) * (box[3] - box[1] + 1)
