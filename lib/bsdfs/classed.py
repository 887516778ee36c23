# SPDX-License-Identifier: GPL-3.0-or-later
"""A mixture whose lobes send out rays of several classes.

Rays of different classes do not see the same things, so no lobe stands in for one of another class.

The one-sample model (Veach 1997, section 9.2.4) weighs a direction by all lobes that may have given it. Where the
rays of two lobes meet different things, each class has an integral of its own, and a direction is weighed by the
lobes of its class.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..scene.rays import Kind
from ..vectors import put
from .lobe import Lobe
from .mixture import Mixture, take_color
from .split import Split


class ClassedMixture(Mixture):
    """The lobes of `mixture`; `class_of` (kinds,) is the class of each kind of ray."""

    def __init__(self, mixture: Mixture, class_of: np.ndarray) -> None:
        super().__init__(mixture.lobes, mixture.colors, mixture.size)
        self._class_of = class_of

    def classes(self, lobe: Lobe, wi: np.ndarray) -> np.ndarray:
        """The class (n,) of rays that a lobe sends along `wi` (3, n)."""
        near, far = (Kind.DIFFUSE, Kind.TRANSLUCENCE) if lobe.diffuse else (Kind.GLOSSY, Kind.TRANSMISSION)
        return np.where(lobe.reflects(wi), self._class_of[near], self._class_of[far])

    def evaluate_classes(self, wi: np.ndarray) -> Iterator[tuple[int, np.ndarray, list[tuple[int, np.ndarray]]]]:
        """Return, for each class, its density and the values of its lobes.

        The density (n,) is that of `sample_classes`. Each lobe has its number and its coloured value f |cos| (3, n).

        Deltas are left out.
        """
        found: dict[int, tuple[np.ndarray, list[tuple[int, np.ndarray]]]] = {}
        for j, (lobe, color, share) in enumerate(zip(self.lobes, self.colors, self.shares, strict=True)):
            if lobe.delta:
                continue
            value, density = lobe.evaluate(wi)
            classes = self.classes(lobe, wi)
            for k in np.unique(classes):
                here = classes == k
                pdf, parts = found.setdefault(int(k), (np.zeros(self.size), []))
                pdf += share * density * here
                parts.append((j, color * value * here))
        for k, (pdf, parts) in found.items():
            yield k, pdf, parts

    def sample_classes(
        self, pick: np.ndarray, u1: np.ndarray, u2: np.ndarray, split: Split | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """As `sample`, and the class (n,) of each ray."""
        wi, weight, pdf = np.zeros((3, self.size)), np.zeros((3, self.size)), np.zeros(self.size)
        classes = np.zeros(self.size, np.intp)
        chosen = (pick >= np.cumsum(self.shares, axis=0)[:-1]).sum(axis=0)
        for k, lobe in enumerate(self.lobes):
            index = np.flatnonzero(chosen == k)
            if index.size:
                found = self._sample_class(k, lobe.part(index), index, (u1[index], u2[index]), split)
                for whole, part in zip((wi, weight, pdf, classes), found, strict=True):
                    put(whole, index, part)
        return wi, weight, pdf, classes

    def _sample_class(
        self, k: int, lobe: Lobe, index: np.ndarray, uniforms: tuple[np.ndarray, np.ndarray], split: Split | None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Sample lobe `k` where it was picked, and weigh the direction by the lobes of its class."""
        direction, factor, density = lobe.sample(*uniforms)
        classes = self.classes(lobe, direction)
        color, share = take_color(self.colors[k], index), self.shares[k, index]
        if lobe.delta:
            pdf, parts = density, [(k, lobe, color * factor / share)]
        else:
            pdf, parts = share * density, [(k, lobe, color * (factor * density))]
            for j, other in enumerate(self.lobes):
                if j != k and not other.delta:
                    there = other.part(index)
                    value, other_density = there.evaluate(direction)
                    same = self.classes(there, direction) == classes
                    parts.append((j, there, take_color(self.colors[j], index) * value * same))
                    pdf = pdf + self.shares[j, index] * other_density * same
            inverse = (density != 0.0) / np.where(pdf > 0.0, pdf, 1.0)
            parts = [(j, there, value * inverse) for j, there, value in parts]
        if split is not None:
            for j, there, value in parts:
                split.add(j, there, direction, value, index)
        return direction, sum((value for _, _, value in parts), start=np.zeros((3, 1))), pdf, classes
