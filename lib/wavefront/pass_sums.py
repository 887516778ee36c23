# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums over the samples of each pixel of a tile, by light pass.

The pass depends on what scattered the light first, and on how often it was scattered.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ..bsdfs.split import part_light
from ..film.light_passes import Family, LightPass, direct, indirect
from .paths import Paths

Index = np.ndarray | slice


class PassSums:
    """The light of one tile, parted by light pass: radiance sums (3, p) of p pixels.

    The tile traces the samples `start` to `start` + `depth` - 1 of each pixel, and its lobes are of the `families`. Contributions are
    parted by the shares (families - 1, 3) that the lobes of the first scattering have in it (Cycles, kernel/film/light_passes.h).
    """

    def __init__(self, families: Sequence[Family], pixels: int, start: int, depth: int) -> None:
        self._families, self._pixels, self._start, self._depth = tuple(families), pixels, start, depth
        self._direct = [direct(family) for family in families]
        self._indirect = [indirect(family) for family in families]
        self.radiance: dict[LightPass, np.ndarray] = {}
        # Of the first scattering of each path; one family alone has everything.
        self._shares = np.zeros((len(families) - 1, 3, pixels * depth)) if self.parts else None

    @property
    def parts(self) -> bool:
        """Whether there are several families, so that shares are asked for."""
        return len(self._families) > 1

    def add_emission(self, paths: Paths, index: Index, arriving: np.ndarray, seen: LightPass) -> None:
        """Add light (3, n) that the paths at `index` met by themselves.

        It goes to the pass `seen` where they have not scattered yet.
        """
        for scatterings, here in _by_scatterings(paths, index, arriving.shape[1]):
            pixel, light = paths.pixel[index][here], arriving[:, here]
            if scatterings == 0:
                self._add(seen, pixel, light)
            else:
                names = self._direct if scatterings == 1 else self._indirect
                self._part(names, pixel, light, self._of_first(paths, index, here))

    def add_direct(self, paths: Paths, index: np.ndarray, arriving: np.ndarray, shares: np.ndarray | None) -> None:
        """Add light (3, n) from sampled lights that the paths at `index` scatter.

        `shares` (families - 1, 3, n) are those of this light. They count at the first scattering; later ones use what
        `remember` stored.
        """
        for scatterings, here in _by_scatterings(paths, index, arriving.shape[1]):
            pixel, light = paths.pixel[index][here], arriving[:, here]
            if scatterings == 0:
                self._part(self._direct, pixel, light, None if shares is None else shares[:, :, here])
            else:
                self._part(self._indirect, pixel, light, self._of_first(paths, index, here))

    def remember(self, paths: Paths, shares: np.ndarray | None) -> None:
        """Store the shares (families - 1, 3, n) of light at the first scattering of each path."""
        if shares is None or self._shares is None:
            return
        for scatterings, here in _by_scatterings(paths, slice(None), paths.size):
            if scatterings == 0:
                self._shares[:, :, self._slot(paths, slice(None))[here]] = shares[:, :, here]

    def _slot(self, paths: Paths, index: Index) -> np.ndarray:
        return paths.pixel[index] * self._depth + (paths.sample[index] - self._start)

    def _of_first(self, paths: Paths, index: Index, here: Index) -> np.ndarray | None:
        if self._shares is None:
            return None
        return np.take(self._shares, self._slot(paths, index)[here], axis=2)

    def _part(
        self, names: Sequence[LightPass], pixel: np.ndarray, light: np.ndarray, shares: np.ndarray | None
    ) -> None:
        if shares is None:
            self._add(names[0], pixel, light)
            return
        for name, part in zip(names, part_light(light, shares), strict=True):
            if part.any():
                self._add(name, pixel, part)

    def _add(self, name: LightPass, pixel: np.ndarray, light: np.ndarray) -> None:
        if name not in self.radiance:
            self.radiance[name] = np.zeros((3, self._pixels))
        for total, channel in zip(self.radiance[name], light, strict=True):
            total += np.bincount(pixel, channel, self._pixels)


def _by_scatterings(paths: Paths, index: Index, count: int) -> Iterator[tuple[int, Index]]:
    """Split paths by how often they have scattered: 0, 1, or 2 for more.

    Yields this number, and which of the `count` paths at `index` have it.
    """
    if not count:
        return
    if isinstance(paths.scatterings, int):
        yield min(paths.scatterings, 2), slice(None)
        return
    scatterings = np.minimum(paths.scatterings[index], 2)
    for times in range(3):
        here = np.flatnonzero(scatterings == times)
        if here.size:
            yield times, here
