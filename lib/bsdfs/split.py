# SPDX-License-Identifier: GPL-3.0-or-later
"""What each family of lobes has of a mixture's value, by which the light passes part it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .lobe import Lobe


class Split:
    """Parts coloured values of a mixture's lobes by family, at n points.

    `families` says for each lobe the number of its family, from 0 to `count` - 1: one number, or two for a lobe that belongs
    to the first where it reflects and to the second where light passes.
    """

    def __init__(self, families: Sequence[tuple[int, ...]], count: int, size: int) -> None:
        self._families, self._count, self._size = families, count, size
        present = sorted({number for numbers in families for number in numbers})
        self._last = present[-1]
        # Of the last family nothing is kept: it has what the others leave.
        self._values = {number: np.zeros((3, size)) for number in present[:-1]}

    def add(
        self, lobe: int, shape: Lobe, wi: np.ndarray, value: np.ndarray, index: np.ndarray | slice = slice(None)
    ) -> None:
        """Add the `value` (3, n) of lobe number `lobe`, of `shape`, at the points `index`.

        It is that for light from `wi` (3, n).
        """
        numbers = self._families[lobe]
        for number in numbers:
            if number in self._values:
                part = value
                if len(numbers) > 1:
                    reflects = shape.reflects(wi)
                    part = value * (reflects if number == numbers[0] else ~reflects)
                self._values[number][:, index] += part

    def shares(self, total: np.ndarray) -> np.ndarray:
        """Return the share that each family but the last takes of what those before it leave.

        `total` is the value (3, n) of all lobes; the result is (count - 1, 3, n).

        So shares of 1 and 0 part exactly, and nothing is lost to rounding. 0 where nothing is left.
        """
        shares, left = np.zeros((self._count - 1, 3, self._size)), total
        for number, value in self._values.items():
            shares[number] = np.clip(value / np.where(left != 0.0, left, 1.0), 0.0, 1.0)
            left = left - value
        shares[self._last :] = 1.0
        return shares


def part_light(light: np.ndarray, shares: np.ndarray) -> list[np.ndarray]:
    """Split `light` (3, n) among the families by the `shares` of `Split`.

    The result, (families - 1, 3, n), adds up to the whole.
    """
    parts, rest = [], light
    for share in shares:
        parts.append(rest * share)
        rest = rest - parts[-1]
    return [*parts, rest]
