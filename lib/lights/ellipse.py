# SPDX-License-Identifier: GPL-3.0-or-later
"""Elliptic lights, sampled by area."""

from __future__ import annotations

import math

import numpy as np

from ..sampling.warps import uniform_disk
from .area import AreaSampler
from .light import LightSample


class EllipseSampler(AreaSampler):
    """A disk or ellipse, sampled uniformly by area.

    Where the disk that its spread lets shine on the point is smaller, samples are uniform in that disk.
    """

    _area_of_unit = math.pi / 4.0

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Uniform in area; a place beyond the rim of the light gives no radiance."""
        if self._spread is None:
            return super().sample(point, u1, u2)
        x, y, height = self.local(point)
        dark = self._unlit(height)
        reach = height * self._spread.tan_half
        area = np.minimum(math.pi * reach * reach, self._area)
        s, t = self._place(u1, u2)
        place_x, place_y = self._along_u(s, t), t * self._length_v
        narrow = np.flatnonzero(area < self._area)
        if narrow.size:
            reach = 2.0 * reach[narrow]
            place_x[narrow] = x[narrow] + reach * s[narrow]
            place_y[narrow] = y[narrow] + reach * t[narrow]
            beyond = narrow[~self.contains(place_x[narrow], place_y[narrow])]
            dark = np.concatenate([dark, beyond])
        return self._towards(place_x - x, place_y - y, height, dark, area)

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Return the area density times distance^2 / cosine at the light.

        It is 0 where the spread keeps the light from the point.
        """
        if self._spread is None:
            return super().pdf(origin, direction, distance)
        _, _, height = self.local(origin)
        reach2 = (height * self._spread.tan_half) ** 2
        density = self._density(height, distance, np.minimum(math.pi * reach2, self._area))
        return density * ((distance * distance - height * height <= reach2) | (math.pi * reach2 >= self._area))

    def _place(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, y = uniform_disk(u1, u2)
        x *= 0.5
        y *= 0.5
        return x, y

    def _holds(self, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        return s * s + t * t <= 0.25
