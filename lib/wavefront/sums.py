# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums over the samples of each pixel of a tile."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from ..effects.names import Stage
from ..film.light_passes import LightPass
from ..film.parts import BounceLimit, EmitterLight, Part
from .part_sums import BounceSums, EmitterSums
from .pass_sums import PassSums


class PixelSums:
    """Radiance sums (3, p) and counts of non-finite contributions (p,).

    A pixel that had a non-finite contribution is NaN; it is never averaged away.
    `unknown` (p,) counts how often paths met an unsupported material. `passes`, `bounces` and `emitters` have the same
    light in parts, where these are asked for.
    """

    def __init__(
        self,
        pixels: int,
        passes: PassSums | None = None,
        bounces: BounceSums | None = None,
        emitters: EmitterSums | None = None,
    ) -> None:
        self.passes, self.bounces, self.emitters = passes, bounces, emitters
        self.radiance = np.zeros((3, pixels))
        self.nonfinite = np.zeros(pixels, np.int64)
        self.unknown = np.zeros(pixels, np.int64)

    def add(self, pixel: np.ndarray, contribution: np.ndarray) -> None:
        """Add contributions (3, n) to the pixels (n,) they belong to."""
        count = self.nonfinite.shape[0]
        for k in range(3):
            self.radiance[k] += np.bincount(pixel, contribution[k], count)
        if not np.isfinite(contribution.sum()):
            self._set_aside(pixel, contribution)

    def add_unknown(self, pixel: np.ndarray) -> None:
        """Count one meeting with a material that is not known for each of the pixels (n,)."""
        self.unknown += np.bincount(pixel, minlength=self.unknown.shape[0])

    def part_radiance(self, part: Part) -> np.ndarray:
        """The radiance sums (3, p) of one part of the image.

        NaN where a contribution was not finite.
        """
        if isinstance(part, BounceLimit) and self.bounces is not None:
            radiance = self.bounces.radiance(part)
        elif isinstance(part, EmitterLight) and self.emitters is not None:
            radiance = self.emitters.radiance(part)
        elif isinstance(part, LightPass) and self.passes is not None:
            radiance = self.passes.radiance.get(part, np.zeros_like(self.radiance))
        else:
            raise KeyError(f"the light was not summed by {part}")
        return np.where(self.nonfinite > 0, np.nan, radiance) if self.nonfinite.any() else radiance

    def _set_aside(self, pixel: np.ndarray, contribution: np.ndarray) -> None:
        bad = ~np.isfinite(contribution).all(axis=0)
        self.nonfinite += np.bincount(pixel[bad], minlength=self.nonfinite.shape[0])
        touched = np.unique(pixel[bad])
        self.radiance[:, touched] = np.nan


class StageClock:
    """Seconds spent in each stage, by laps."""

    def __init__(self) -> None:
        self._last = perf_counter()
        self.seconds: dict[str, float] = {}

    def lap(self, stage: Stage) -> None:
        """Charge the time since the last lap to `stage`."""
        now = perf_counter()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self._last
        self._last = now
