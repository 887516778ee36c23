# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums over the samples of each pixel of a tile, by number of bounces and by emitter."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..film.parts import BounceLimit, EmitterLight
from .paths import Paths


class BounceSums:
    """The light of one tile by the length of its paths.

    It has radiance sums (3, p) of p pixels, for each limit of bounces up to `most`.
    A path of at most b bounces, in Cycles' count, scatters at most b + 1 times. The light of a path is the same under
    every limit that the path keeps, so one render has them all.
    """

    def __init__(self, most: int, pixels: int) -> None:
        self._most = most
        # By the number of scatterings, from 0 to most + 1.
        self._sums = np.zeros((most + 2, 3, pixels))

    def add(self, paths: Paths, index: np.ndarray | slice, light: np.ndarray, further: int) -> None:
        """Add light (3, n) of the paths at `index`.

        It scattered `further` times beyond what the paths themselves did.
        """
        count = light.shape[1]
        scatterings = paths.scatterings
        if not isinstance(scatterings, int):
            scatterings = scatterings[index]
        scatterings = np.broadcast_to(scatterings, count) + further
        keeps = np.flatnonzero(scatterings <= self._most + 1)
        pixels = self._sums.shape[2]
        slot = scatterings[keeps] * pixels + paths.pixel[index][keeps]
        for k in range(3):
            added = np.bincount(slot, light[k, keeps], self._sums.shape[0] * pixels)
            self._sums[:, k] += added.reshape(-1, pixels)

    def radiance(self, part: BounceLimit) -> np.ndarray:
        """The radiance sums (3, p) under one limit."""
        return self._sums[: part.bounces + 2].sum(axis=0)


class EmitterSums:
    """The light of one tile by its emitter.

    It has radiance sums (3, p) of p pixels, for each of `names`.
    """

    def __init__(self, names: Sequence[EmitterLight], pixels: int) -> None:
        self._names = tuple(names)
        self._sums = np.zeros((len(names), 3, pixels))

    def add(self, pixel: np.ndarray, light: np.ndarray, emitter: np.ndarray | int) -> None:
        """Add light (3, n) to the pixels (n,).

        `emitter` () or (n,) is the index of its emitter among the names.
        """
        if np.ndim(emitter) == 0:
            for k in range(3):
                self._sums[int(emitter), k] += np.bincount(pixel, light[k], self._sums.shape[2])
            return
        pixels = self._sums.shape[2]
        for k in range(3):
            added = np.bincount(emitter * pixels + pixel, light[k], self._sums.shape[0] * pixels)
            self._sums[:, k] += added.reshape(-1, pixels)

    def radiance(self, part: EmitterLight) -> np.ndarray:
        """The radiance sums (3, p) of one emitter's light."""
        return self._sums[self._names.index(part)]
