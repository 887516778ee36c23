# SPDX-License-Identifier: GPL-3.0-or-later
"""How long rounds take, of the whole image and of parts of it."""

from __future__ import annotations

import numpy as np

# What was timed counts so much less with each time that is newer.
FADING = 0.7
# What is assumed of the fixed part counts as so many times.
ASSUMED = 0.1


class Pace:
    """Seconds of rounds of both sides: a fixed part for each, and a part for each replicate of each pixel.

    Both are found by least squares from what was timed. `fixed` is the part of a round of the whole image that its pixels do not cost, as
    far as is known before parts are timed.
    """

    def __init__(self, fixed: float = 0.0) -> None:
        self._fixed = fixed
        # Sums of squares and products of what was timed (replicates of the image, rounds, and seconds), and the seconds first thought fixed.
        self._squares, self._products, self._first = np.zeros((2, 2)), np.zeros(2), np.nan
        self.of_round, self.of_image = np.nan, np.nan
        """Seconds of a round without pixels, and of the pixels of one replicate of the image; NaN until something was timed."""

    @property
    def whole(self) -> float:
        """Seconds of one replicate of the whole image on both sides."""
        return self.of_round + self.of_image

    def learn(self, seconds: float, share: float, replicates: int, rounds: int) -> None:
        """Take the time of so many `rounds`, `replicates` by their weight, in a `share` of the image."""
        if rounds == 0:
            return
        if np.isnan(self._first):
            self._first = self._fixed * seconds / rounds
        timed = np.array([share * replicates / rounds, 1.0])
        self._squares = FADING * self._squares + np.outer(timed, timed)
        self._products = FADING * self._products + timed * seconds / rounds
        # As if a round without pixels had been timed, too: rounds that are alike do not tell the two parts from each other.
        assumed = np.array([0.0, ASSUMED])
        found = np.linalg.solve(self._squares + np.diag(assumed), self._products + assumed * self._first)
        if found.min() < 0.0:
            found = np.array([self._products[0] / self._squares[0, 0], 0.0])
        self.of_image, self.of_round = map(float, found)

    def seconds(self, work: float, rounds: float) -> float:
        """The time that so many `rounds` are expected to take, with the `work` of so many replicates of the image."""
        return work * self.of_image + rounds * self.of_round
