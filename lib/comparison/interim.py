# SPDX-License-Identifier: GPL-3.0-or-later
"""The interim results that a comparison reports while it runs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..film.regions import Regions
from .sides import Side


@dataclass(frozen=True)
class BoundAt:
    """A bound that was shown: all regions agree to within `bound`.

    It was shown after so many `seconds`, from so many `replicates` of both sides. `first` marks the first look, on a
    coarse grid, whose samples the verdict does not use.
    """

    seconds: float
    replicates: int
    bound: float
    first: bool


@dataclass(frozen=True, eq=False)
class Interim:
    """The findings of a comparison at a look: the bound, and both sides.

    The films of the sides change when the next replicate is added. `outcomes` (K,) are those of the `regions` so far;
    `floor`, `tolerance` and `left_out` as in the Verdict and the Comparison.
    """

    bound: BoundAt
    reference: Side
    candidate: Side
    regions: Regions
    outcomes: np.ndarray
    floor: np.ndarray
    tolerance: float
    left_out: np.ndarray
