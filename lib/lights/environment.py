# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as a light: directions chosen where it is bright."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..sampling.tables import Distribution2D
from ..sampling.warps import circle
from .light import Ball, Emitted, LightSample, Pair, emit_distant, luminance

# Each cell is looked at in PROBES x PROBES places, so that what interpolation spreads from a bright texel into its neighbours is seen.
PROBES = 2
# Part of the mean radiance that every direction counts as having, so that light between the probes can still be found.
FLOOR = 0.01
_CHUNK = 16384


class EnvironmentSampler:
    """Importance sampling of the sphere of directions by a table over an equirectangular grid.

    Column u = 1/2 - atan2(y, x) / 2 pi and row v = acos(z) / pi, from the top. A cell of the grid is chosen by its mean luminance times
    its solid angle, a direction in it uniformly in solid angle (z, not theta), so that the density is constant in a cell and has no
    pole. The table only steers: the radiance is always that of `radiance_function`, (3, n) for unit directions (3, n).
    `table_resolution` is (width, height); `scene_radius` in metres sets the power.

    `nonfinite` counts the probes that were NaN or infinite; their cells are sampled as if black, and the radiance found there later is
    passed on as it is, for the film to count.
    """

    delta = False

    def __init__(
        self,
        radiance_function: Callable[[np.ndarray], np.ndarray],
        table_resolution: tuple[int, int],
        scene_radius: float = 1.0,
    ) -> None:
        width, height = table_resolution
        self._radiance = radiance_function
        self._columns, self._rows = width, height
        edges = np.linspace(0.0, np.pi, height + 1)
        self._top = np.cos(edges[:-1])
        # cos a - cos b by a product: next to the poles a difference would lose half its digits.
        self._drop = 2.0 * np.sin(0.5 * (edges[1:] + edges[:-1])) * np.sin(0.5 * (edges[1:] - edges[:-1]))
        solid = (2.0 * np.pi / width) * self._drop[:, None]
        mean, self.nonfinite, from_all = self._probe(solid)
        self.flux = np.pi * scene_radius**2 * from_all
        total = float((mean * solid).sum())
        self.power = np.pi * scene_radius**2 * total
        floor = FLOOR * total / (4.0 * np.pi) if total > 0.0 else 1.0
        self._table = Distribution2D((mean + floor) * solid)
        self._density = (self._table.probability / solid).ravel()

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """A direction where the world is bright; the same from every `point`."""
        row, column, down, along = self._table.sample(u1, u2)
        z = np.take(self._top, row)
        down *= np.take(self._drop, row)
        z -= down
        along += column
        along *= -1.0 / self._columns
        along += 0.5  # u = 1/2 - angle / 2 pi
        x, y = circle(along)
        sine = np.sqrt(np.maximum(1.0 - z * z, 0.0))
        x *= sine
        y *= sine
        wi = np.stack((x, y, z))
        row *= self._columns
        row += column
        return LightSample(wi, np.full(z.shape, np.inf), self._radiance(wi), np.take(self._density, row))

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance inf and the radiance of the world."""
        return np.full(direction.shape[1], np.inf), self._radiance(direction)

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Density of the cell in which a direction lies."""
        x, y, z = direction
        u = np.arctan2(y, x)
        u *= -0.5 / np.pi
        u += 0.5
        u *= self._columns
        v = np.arccos(np.clip(z, -1.0, 1.0))
        v *= self._rows / np.pi
        cell = np.minimum(v.astype(np.intp), self._rows - 1)
        cell *= self._columns
        cell += np.minimum(u.astype(np.intp), self._columns - 1)
        return np.take(self._density, cell)

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Through the ball, from where the world is bright."""
        return emit_distant(self.sample(np.empty((3, heading[0].size)), *heading), ball, place)

    def _probe(self, solid: np.ndarray) -> tuple[np.ndarray, int, np.ndarray]:
        """Return the mean luminance (magnitude) of every cell (rows, columns).

        Also returns how many probes were not finite, and the integral (3,) of the radiance's magnitude over the cells of `solid` angle
        (rows, 1), steradians.
        """
        place = (np.arange(PROBES) + 0.5) / PROBES
        z = (self._top[:, None] - self._drop[:, None] * place).ravel()
        angle = 2.0 * np.pi * (0.5 - ((np.arange(self._columns)[:, None] + place) / self._columns).ravel())
        around = np.stack((np.cos(angle), np.sin(angle)))
        sine = np.sqrt(1.0 - z * z)
        mean, nonfinite, from_all = np.empty((self._rows, self._columns)), 0, np.zeros(3)
        step = max(1, _CHUNK // (PROBES * angle.size))
        for first in range(0, self._rows, step):
            rows = slice(PROBES * first, PROBES * min(first + step, self._rows))
            direction = np.empty((3, z[rows].size, angle.size))
            np.multiply(around[:, None, :], sine[rows, None], out=direction[:2])
            direction[2] = z[rows, None]
            radiance = self._radiance(direction.reshape(3, -1))
            seen = np.abs(luminance(radiance))
            good = np.isfinite(seen)
            nonfinite += int(seen.size - np.count_nonzero(good))
            cells = np.where(good, seen, 0.0).reshape(-1, PROBES, self._columns, PROBES)
            mean[first : first + step] = cells.mean(axis=(1, 3))
            each = np.where(good, np.abs(radiance), 0.0).reshape(3, -1, angle.size).mean(axis=2)
            from_all += each @ np.repeat(self._columns * solid[first : first + step, 0] / PROBES, PROBES)
        return mean, nonfinite, from_all
