# SPDX-License-Identifier: GPL-3.0-or-later
"""Several lobes at one point: one of them is sampled, and all of them are counted.

This is the one-sample model (Veach 1997, section 9.2.4).
"""

from __future__ import annotations

import numpy as np

from ..vectors import gather, put
from .lobe import Lobe
from .split import Split


class Mixture:
    """Several coloured `lobes`, one of which is picked to be sampled.

    Their `colors` are (3, 1) or (3, n) each. A lobe's chance is proportional to the mean of its colour.

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

    def evaluate(self, wi: np.ndarray, split: Split | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Return the coloured value f |cos| (3, n) and the density (n,) of `sample`.

        Deltas are left out. Each lobe's part goes to the `split`.
        """
        if len(self.lobes) == 1:
            value, pdf = self.lobes[0].evaluate(wi)
            value = self.colors[0] * value
            if split is not None:
                split.add(0, self.lobes[0], wi, value)
            return value, pdf
        value, pdf = np.zeros_like(wi), np.zeros(self.size)
        for k, (lobe, color, share) in enumerate(zip(self.lobes, self.colors, self.shares, strict=True)):
            if not lobe.delta:
                one, density = lobe.evaluate(wi)
                one = color * one
                value += one
                pdf += share * density
                if split is not None:
                    split.add(k, lobe, wi, one)
        return value, pdf

    def sample(
        self, pick: np.ndarray, u1: np.ndarray, u2: np.ndarray, split: Split | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return a direction (3, n), its coloured weight (3, n) and its density (n,).

        The density is infinite where a delta lobe was picked.

        Each lobe's part of the weight goes to the `split`.
        """
        if len(self.lobes) == 1:
            wi, weight, pdf = self.lobes[0].sample(u1, u2)
            weight = self.colors[0] * weight
            if split is not None:
                split.add(0, self.lobes[0], wi, weight)
            return wi, weight, pdf
        wi, weight, pdf = np.zeros((3, self.size)), np.zeros((3, self.size)), np.zeros(self.size)
        chosen = (pick >= np.cumsum(self.shares, axis=0)[:-1]).sum(axis=0)
        for k, lobe in enumerate(self.lobes):
            index = np.flatnonzero(chosen == k)
            if index.size:
                self._sample_one(k, lobe.part(index), index, (u1[index], u2[index]), (wi, weight, pdf), split)
        return wi, weight, pdf

    def _sample_one(
        self,
        k: int,
        lobe: Lobe,
        index: np.ndarray,
        uniforms: tuple[np.ndarray, np.ndarray],
        out: tuple[np.ndarray, np.ndarray, np.ndarray],
        split: Split | None,
    ) -> None:
        """Sample lobe `k` where it was picked, and weight the direction by all lobes.

        Fills `out` and `split` at `index`.
        """
        direction, factor, density = lobe.sample(*uniforms)
        color = take_color(self.colors[k], index)
        share = self.shares[k, index]
        if lobe.delta:
            total_weight, total_pdf = color * factor / share, density
            if split is not None:
                split.add(k, lobe, direction, total_weight, index)
        else:
            total_pdf = share * density
            others, parts = np.zeros_like(direction), []
            for j, other in enumerate(self.lobes):
                if j != k and not other.delta:
                    there = other.part(index)
                    one, other_density = there.evaluate(direction)
                    one = take_color(self.colors[j], index) * one
                    others += one
                    parts.append((j, there, one))
                    total_pdf += self.shares[j, index] * other_density
            divisor = np.where(total_pdf > 0.0, total_pdf, 1.0)
            # Beside black lobes the first quotient is 1, and the weight is exactly the lobe's own.
            own = color * (factor * (density / divisor))
            total_weight = own + others / divisor
            total_weight *= density != 0.0
            if split is not None:
                split.add(k, lobe, direction, own, index)
                for j, there, one in parts:
                    split.add(j, there, direction, one / divisor, index)
        for whole, part in zip(out, (direction, total_weight, total_pdf), strict=True):
            put(whole, index, part)


def take_color(color: np.ndarray, index: np.ndarray) -> np.ndarray:
    """A colour (3, 1) or (3, n) at the points `index`."""
    return color if color.shape[1] == 1 else gather(color, index)
