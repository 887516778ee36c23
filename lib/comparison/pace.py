# SPDX-License-Identifier: GPL-3.0-or-later
"""How long rounds take, of the whole image and of parts of it."""

from __future__ import annotations

import math

# The weight of the latest rounds in the estimate.
NEWEST = 0.4


class Pace:
    """Seconds of rounds of both sides.

    `fixed` is the part of a round of the whole image that its pixels do not cost: each call of a renderer has it, however small its part.
    """

    def __init__(self, fixed: float = 0.0) -> None:
        self.fixed = fixed
        self.whole = math.nan
        """Seconds of one replicate of the whole image on both sides; NaN until one was timed."""

    def learn(self, seconds: float, share: float, replicates: int, rounds: int) -> None:
        """Take the time of so many `rounds`, `replicates` by their weight, in a `share` of the image."""
        if rounds == 0:
            return
        whole = seconds / self._wholes(share, replicates, rounds)
        self.whole = whole if math.isnan(self.whole) else self.whole + NEWEST * (whole - self.whole)

    def seconds(self, share: float, replicates: int, rounds: int) -> float:
        """The time that they are expected to take."""
        return self.whole * self._wholes(share, replicates, rounds)

    def _wholes(self, share: float, replicates: int, rounds: int) -> float:
        return max(rounds * self.fixed + (1.0 - self.fixed) * share * replicates, 1e-9)
