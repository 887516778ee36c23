# SPDX-License-Identifier: GPL-3.0-or-later
"""How an expected value is written down."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Expectation:
    """The mean radiance (RGB, W m^-2 sr^-1) of a region, and where the number comes from.

    `rows` and `columns` are half-open ranges of pixels of the whole image, row 0 on top; `tolerance` is relative: how
    far a right image of any sample count may be away once its noise has gone.
    """

    name: str
    rows: tuple[int, int]
    columns: tuple[int, int]
    radiance: tuple[float, float, float]
    tolerance: float
    origin: str
