# SPDX-License-Identifier: GPL-3.0-or-later
"""A mixture whose lobes send out rays of several classes, which do not see the same things: no lobe stands in for one of another class.

The one-sample model (Veach 1997, section 9.2.4) weighs a direction by all lobes that may have given it. Where the rays of two lobes meet
different things, each class has an integral of its own, and a direction is weighed by the lobes of its class.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..scene.rays import Kind
from ..vectors import put
from .lobe import Lobe
from .mixture import Mixture, take_color


class ClassedMixture(Mixture):
    """The lobes of `mixture`; `class_of` (kinds,) is the class of each kind of ray."""

    def __init__(self, mixture: Mixture, class_of: np.ndarray) -> None:
        super().__init__(mixture.lobes, mixture.colors, mixture.size)
        self._class_of = class_of

    def classes(self, lobe: Lobe, wi: np.ndarray) -> np.ndarray:
        """The class (n,) of rays that a lobe sends along `wi` (3, n)."""
        near, far = (Kind.DIFFUSE, Kind.TRANSLUCENCE) if lobe.diffuse else (Kind.GLOSSY, Kind.TRANSMISSION)
        return np.where(lobe.crosses(wi), self._class_of[far], self._class_of[near])

    def evaluate_classes(self, wi: np.ndarray) -> Iterator[tuple[int, np.ndarray, np.ndarray]]:
        """Each class with its coloured value f |cos| (3, n) and the density (n,) of `sample_classes`, deltas left out."""
        found: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        for lobe, color, share in zip(self.lobes, self.colors, self.shares, strict=True):
            if lobe.delta:
                continue
            value, density = lobe.evaluate(wi)
            classes = self.classes(lobe, wi)
            for k in np.unique(classes):
                here = classes == k
                total, pdf = found.setdefault(int(k), (np.zeros_like(wi), np.zeros(self.size)))
                total += color * value * here
                pdf += share * density * here
        for k, (value, pdf) in found.items():
            yield k, value, pdf

    def sample_classes(
        self, pick: np.ndarray, u1: np.ndarray, u2: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """As `sample`, and the class (n,) of each ray."""
        wi, weight, pdf = np.zeros((3, self.size)), np.zeros((3, self.size)), np.zeros(self.size)
        classes = np.zeros(self.size, np.intp)
        chosen = (pick >= np.cumsum(self.shares, axis=0)[:-1]).sum(axis=0)
        for k, lobe in enumerate(self.lobes):
            index = np.flatnonzero(chosen == k)
            if index.size:
                found = self._sample_class(k, lobe.part(index), index, u1[index], u2[index])
                for whole, part in zip((wi, weight, pdf, classes), found, strict=True):
                    put(whole, index, part)
        return wi, weight, pdf, classes

    def _sample_class(
        self, k: int, lobe: Lobe, index: np.ndarray, u1: np.ndarray, u2: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Sample lobe `k` where it was picked, and weigh the direction by the lobes of its class."""
        direction, factor, density = lobe.sample(u1, u2)
        classes = self.classes(lobe, direction)
        color, share = take_color(self.colors[k], index), self.shares[k, index]
        if lobe.delta:
            return direction, color * factor / share, density, classes
        total, pdf = color * (factor * density), share * density
        for j, other in enumerate(self.lobes):
            if j != k and not other.delta:
                there = other.part(index)
                value, other_density = there.evaluate(direction)
                same = self.classes(there, direction) == classes
                total = total + take_color(self.colors[j], index) * value * same
                pdf = pdf + self.shares[j, index] * other_density * same
        weight = total / np.where(pdf > 0.0, pdf, 1.0) * (density != 0.0)
        return direction, weight, pdf, classes
