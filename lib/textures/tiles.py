# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiled images (UDIM): which of their tiles a point lies in."""

from __future__ import annotations

import numpy as np

FIRST = 1001
COLUMNS = 10


def tile_corner(number: int) -> tuple[int, int]:
    """The column and row of tile `number`: its lower left corner in texture coordinates."""
    row, column = divmod(number - FIRST, COLUMNS)
    return column, row


def lies_in_tile(point: np.ndarray, number: int) -> np.ndarray:
    """Whether `point` (3, n) lies in tile `number`, (n,) of booleans.

    Whole parts are cut off towards 0, as Cycles does, so that coordinates between -1 and 0 belong to the first column or row.
    """
    column, row = np.trunc(point[:2])
    return (column == tile_corner(number)[0]) & (row == tile_corner(number)[1])
