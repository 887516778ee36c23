# SPDX-License-Identifier: GPL-3.0-or-later
"""A grid of cells over the part of the scene about the lights, and the light that each cell can expect."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..scene.lights import USUAL_FALLOFF, Falloff
from ..vectors import dot
from .falloff import brightness_at

_MOST_CELLS = 4096
_MOST_CHANCES = 1 << 20


class Parts(NamedTuple):
    """Lights or parts of a light that have places.

    power (k,), luminance of flux, in W, before the `falloff` of all of them; center (3, k) and radius (k,) of balls that hold them, in
    metres.
    """

    power: np.ndarray
    center: np.ndarray
    radius: np.ndarray
    falloff: Falloff = USUAL_FALLOFF

    @property
    def everywhere_alike(self) -> bool:
        """Whether the light is the same at all distances."""
        return self.falloff.power == 2 and self.falloff.smooth == 0.0

    def brightness(self, square: np.ndarray) -> np.ndarray | float:
        """What the falloff makes of light over the squared distances `square` (n,), as a factor."""
        return 1.0 if self.falloff == USUAL_FALLOFF else brightness_at(self.falloff, np.sqrt(square))


class Cells:
    """Nearly cubic cells about `places` (3, k), within `bounds` (2, 3), metres.

    A place outside the grid has the number of the nearest cell. One number more, `everywhere`, stands for any place. `columns` are the
    lights that a table has for each cell: many of them leave fewer cells.
    """

    def __init__(self, places: np.ndarray, bounds: np.ndarray, columns: int) -> None:
        least, most = places.min(axis=1), places.max(axis=1)
        margin = 0.5 * (most - least).max()
        low, high = bounds
        least, most = np.clip(least - margin, low, high), np.clip(most + margin, low, high)
        extent = most - least
        longest = float(extent.max())
        limit = max(min(_MOST_CELLS, _MOST_CHANCES // max(columns, 1)), 1)
        self._count = _most_cells(extent / longest, limit) if longest > 0.0 else np.ones(3, np.intp)
        self._least, self._edge = least, extent / self._count
        self._per_metre = np.divide(1.0, self._edge, out=np.zeros(3), where=self._edge > 0.0)
        self.everywhere = int(self._count.prod())
        number = np.stack(np.unravel_index(np.arange(self.everywhere), tuple(self._count)))
        self._middles = self._least[:, None] + (number + 0.5) * self._edge[:, None]
        self._radius2 = 0.25 * float(np.square(self._edge).sum())

    def number(self, point: np.ndarray) -> np.ndarray:
        """The numbers (n,) of the cells that hold the points (3, n)."""
        number = np.zeros(point.shape[1], np.intp)
        for along in range(3):
            place = (point[along] - self._least[along]) * self._per_metre[along]
            number *= self._count[along]
            number += np.clip(place, 0.0, self._count[along] - 1.0).astype(np.intp)
        return number

    def expect(self, parts: Parts) -> np.ndarray:
        """Return the irradiance over pi (c, k), W m^-2, that cells can expect of parts.

        It is the power over 4 (d^2 + r^2 + R^2), with the distance d of their middles, the cell's radius r and the part's R, times
        what the falloff makes of it at the root of that sum.
        """
        expected = np.empty((self.everywhere, parts.power.size))
        for k, place in enumerate(parts.center.T):
            apart = np.square(self._middles - place[:, None]).sum(axis=0) + self._radius2 + parts.radius[k] ** 2
            expected[:, k] = parts.power[k] / (4.0 * np.maximum(apart, 1e-300)) * parts.brightness(apart)
        return expected


class Places(NamedTuple):
    """Places on faces that are to be lit: `position` (3, n), metres, and unit `normal` (3, n) of either sign."""

    position: np.ndarray
    normal: np.ndarray

    def expect(self, parts: Parts) -> np.ndarray:
        """Irradiance over pi (n, k), W m^-2, of parts of which nothing hides any, were they points."""
        expected = np.empty((self.position.shape[1], parts.power.size))
        for k, place in enumerate(parts.center.T):
            offset = place[:, None] - self.position
            apart = np.maximum(dot(offset, offset) + parts.radius[k] ** 2, 1e-200)
            level = parts.power[k] / 4.0 * np.abs(dot(offset, self.normal)) / (apart * np.sqrt(apart))
            expected[:, k] = level * parts.brightness(apart)
        return expected


def _most_cells(sides: np.ndarray, limit: int) -> np.ndarray:
    """The numbers of cells (3,) along the `sides` of a box, over its longest: as many as there may be, `limit` at most."""
    few, many = 1, limit + 1  # cells along the longest side: so many that fit, so many that do not
    while many - few > 1:
        along = (few + many) // 2
        few, many = (along, many) if _along(sides, along).prod() <= limit else (few, along)
    return _along(sides, few).astype(np.intp)


def _along(sides: np.ndarray, longest: int) -> np.ndarray:
    """The numbers of cells along sides (3,) where the longest has so many; rounding of the sides adds none."""
    return np.maximum(np.ceil(sides * longest - 1e-6), 1.0)
