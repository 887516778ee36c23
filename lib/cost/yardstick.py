# SPDX-License-Identifier: GPL-3.0-or-later
"""The relative squared error of images, from pairs of replicates and a truth.

The replicates are independent, and the truth is itself an estimate. With weights w = 1 / (T^2 + e^2) and replicates
a, b of one way, truths T', T'' of another run, all independent:

    variance  E[w (a - b)^2 / 2]         needs no truth
    bias^2    E[w (a - T')(b - T'')]     noise of neither image is left in the mean
    relMSE    variance + bias^2          of one replicate

Every pair has truths of its own, so that pairs are independent estimates and their spread is the error of their mean; T
in its weights is the mean of all others, for weights that follow T' and T'' would make a bias of their noise. Pixels
share point sets, in Cycles as here, and do not count as independent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

# Radiance below this share of the image's mean does not blow up relative errors.
FLOOR = 0.01
# The share of pixels with the largest errors that the trimmed mean leaves out.
TRIMMED = 0.01


@dataclass(frozen=True)
class Score:
    """One image's error by a pair of replicates.

    Each value is the mean over pixels and channels, in units of the weights. `trimmed` and `median` are over pixels,
    of the squared error against the whole truth, less the truth's own noise.
    """

    variance: float
    bias: float
    trimmed: float
    median: float


class Yardstick:
    """The truth for `pairs` pairs.

    It has two independent images for each, (height, width, 3), in order. `noise` is the relative squared error that
    their mean still has; `excluded` (height, width) marks pixels in which a sample was not finite.
    """

    def __init__(self, images: list[np.ndarray]) -> None:
        pieces = np.stack(images)
        self.excluded = ~np.isfinite(pieces).all(axis=(0, 3))
        pieces[:, self.excluded] = 0.0
        self.mean = pieces.mean(axis=0)
        used = ~self.excluded
        self._floor = max((FLOOR * self.mean[used].mean()) ** 2, 1e-300)
        self._pieces = pieces
        self.noise = _average(self._weight(self.mean) * pieces.var(axis=0, ddof=1) / len(pieces), used)

    @property
    def pairs(self) -> int:
        """For how many pairs there are truths."""
        return len(self._pieces) // 2

    def score(self, a: np.ndarray, b: np.ndarray, pair: int) -> Score:
        """The error of replicates `a` and `b` of one way.

        A pixel that is not finite in one of them does not count.
        """
        used = np.isfinite(a).all(axis=2) & np.isfinite(b).all(axis=2) & ~self.excluded
        a, b = (np.where(used[..., None], image, 0.0) for image in (a, b))
        one, two = self._pieces[2 * pair], self._pieces[2 * pair + 1]
        count = len(self._pieces)
        weight = self._weight((count * self.mean - one - two) / (count - 2)) if count > 2 else self._weight(self.mean)
        squares = [(self._weight(self.mean) * (image - self.mean) ** 2).mean(axis=2)[used] for image in (a, b)]
        whole = np.mean([s.mean() for s in squares])
        share = max(1.0 - self.noise / whole, 0.0) if whole > 0.0 else 0.0
        return Score(
            _average(0.5 * weight * (a - b) ** 2, used),
            _average(weight * (a - one) * (b - two), used),
            share * float(np.mean([_trimmed(s) for s in squares])),
            share * float(np.mean([np.median(s) for s in squares])),
        )

    def _weight(self, truth: np.ndarray) -> np.ndarray:
        return 1.0 / (truth**2 + self._floor)


def _average(image: np.ndarray, used: np.ndarray) -> float:
    return float(image.mean(axis=2)[used].mean())


def _trimmed(values: np.ndarray) -> float:
    kept = values.size - int(TRIMMED * values.size)
    return float(np.partition(values, kept - 1)[:kept].mean())
