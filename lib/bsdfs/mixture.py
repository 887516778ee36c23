# SPDX-License-Identifier: GPL-3.0-or-later
"""Several lobes at one point: one is picked to be sampled, all are counted (one-sample model, Veach 1997, section 9.2.4)."""

from __future__ import annotations

import numpy as np

from ..vectors import put
from .lobe import Lobe


class Mixture:
    """Coloured `lobes`; their `colors` are (3, 1) or (3, n) each. The pick is proportional to the mean of the colour.

    `shares` (lobes, n) are the chances of the pick.
    """

    def __init__(self, lobes: list[Lobe], colors: list[np.ndarray], size: int) -> None:
        self.lobes, self.colors, self.size = lobes, colors, size
        self.all_delta = all(lobe.delta for lobe in lobes)
        self.shares = np.broadcast_to(1.0, (1, size))
        if len(lobes) > 1:
            guesses = [np.abs(c).mean(axis=0) * lobe.estimate for lobe, c in zip(lobes, colors, strict=True)]
            weight = np.stack([np.broadcast_to(guess, (size,)) for guess in guesses])
            total = weight.sum(axis=0)
            self.shares = np.where(total > 0.0, weight / np.where(total > 0.0, total, 1.0), 1.0 / len(lobes))

    def evaluate(self, wi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coloured value f |cos| (3, n) and the density (n,) of `sample`, deltas left out."""
        if len(self.lobes) == 1:
            value, pdf = self.lobes[0].evaluate(wi)
            return self.colors[0] * value, pdf
        value, pdf = np.zeros_like(wi), np.zeros(self.size)
        for lobe, color, share in zip(self.lobes, self.colors, self.shares, strict=True):
            if not lobe.delta:
                one, density = lobe.evaluate(wi)
                value += color * one
                pdf += share * density
        return value, pdf

    def sample(self, pick: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Direction (3, n), coloured weight (3, n), density (n,), which is infinite where a delta lobe was picked."""
        if len(self.lobes) == 1:
            wi, weight, pdf = self.lobes[0].sample(u1, u2)
            return wi, self.colors[0] * weight, pdf
        wi, weight, pdf = np.zeros((3, self.size)), np.zeros((3, self.size)), np.zeros(self.size)
        chosen = (pick >= np.cumsum(self.shares, axis=0)[:-1]).sum(axis=0)
        for k, lobe in enumerate(self.lobes):
            index = np.flatnonzero(chosen == k)
            if index.size:
                self._sample_one(k, lobe.part(index), index, (u1[index], u2[index]), (wi, weight, pdf))
        return wi, weight, pdf

    def _sample_one(
        self,
        k: int,
        lobe: Lobe,
        index: np.ndarray,
        uniforms: tuple[np.ndarray, np.ndarray],
        out: tuple[np.ndarray, np.ndarray, np.ndarray],
    ) -> None:
        """Sample lobe `k` where it was picked, and weigh the direction by all lobes; fills `out` at `index`."""
        direction, factor, density = lobe.sample(*uniforms)
        color = take_color(self.colors[k], index)
        share = self.shares[k, index]
        if lobe.delta:
            total_weight, total_pdf = color * factor / share, density
        else:
            total_pdf = share * density
            others = np.zeros_like(direction)
            for j, other in enumerate(self.lobes):
                if j != k and not other.delta:
                    one, other_density = other.part(index).evaluate(direction)
                    others += take_color(self.colors[j], index) * one
                    total_pdf += self.shares[j, index] * other_density
            divisor = np.where(total_pdf > 0.0, total_pdf, 1.0)
            # Beside black lobes the first quotient is 1, and the weight is exactly the lobe's own.
            total_weight = color * (factor * (density / divisor)) + others / divisor
            total_weight *= density != 0.0
        for whole, part in zip(out, (direction, total_weight, total_pdf), strict=True):
            put(whole, index, part)


def take_color(color: np.ndarray, index: np.ndarray) -> np.ndarray:
    """A colour (3, 1) or (3, n) at the points `index`."""
    return color if color.shape[1] == 1 else np.take(color, index, axis=1)
