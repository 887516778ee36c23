# SPDX-License-Identifier: GPL-3.0-or-later
"""The chances of lights by the place that they are to light: a grid of cells, each with chances of its own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..sampling.tables import Rows
from .light import Aimable, LightSampler

EVEN_SHARE = 1.0 / 16.0
"""What all lights that shine share evenly, whatever their power and place."""
NEAR_SHARE = 3.0 / 4.0
"""What of the rest goes by the light that a place can expect, and not by power alone."""
_MOST_CELLS = 4096
_MOST_CHANCES = 1 << 20


def chances_by_power(power: np.ndarray) -> np.ndarray:
    """Return the chances (k,) of lights of `power` (k,), by power but for EVEN_SHARE.

    All lights that shine have an equal part of EVEN_SHARE.

    A lamp in a closed room is all of its light, however bright the sun outside is. By this defensive mixture
    (Hesterberg 1995) no sample weighs more than 1 / EVEN_SHARE times what it would by even chances. All 0 where
    nothing shines.
    """
    total, shines = float(power.sum()), power > 0.0
    if not total > 0.0:
        return np.zeros(power.shape)
    return (1.0 - EVEN_SHARE) * (power / total) + EVEN_SHARE * shines / shines.sum()


def chances_by_place(power: np.ndarray, expected: np.ndarray) -> np.ndarray:
    """Return the chances (c, k) of lights in c cells, by the light that each cell can expect.

    `power` (k,); `expected` (c, k), not negative, 0 where the power is. As `chances_by_power`, but NEAR_SHARE of what goes by power
    there goes by what is expected. The rest bounds what a sample weighs where walls hide the near lights.
    """
    total = expected.sum(axis=1, keepdims=True)
    by_power = power / max(float(power.sum()), 1e-300)
    near = np.divide(expected, total, out=np.broadcast_to(by_power, expected.shape).copy(), where=total > 0.0)
    return chances_by_power(power) + (1.0 - EVEN_SHARE) * NEAR_SHARE * (near - by_power)


class LightGrid:
    """Chances of lights in the cells of a grid over the part of the scene about the lights.

    `samplers`: at least one. `bounds` (2, 3): least and greatest coordinates of what is to be lit, metres. `radius`, metres: the scene's,
    as that of suns and worlds. A place outside the grid has the chances of the nearest cell. There is one cell more, `everywhere`,
    whose chances go by power alone. `useful`: whether the cells differ.

    What a cell expects of a light with a place is its power over 4 (d^2 + r^2 + R^2), with the distance d of their middles, the cell's
    radius r and the light's R; of a sun or a world its power over `radius`^2. Both are irradiance, but for a factor of pi.
    """

    def __init__(self, samplers: Sequence[LightSampler], bounds: np.ndarray, radius: float) -> None:
        power = np.array([sampler.power for sampler in samplers])
        power = power / max(float(power.max()), 1e-300)
        balls = {
            k: sampler.extent for k, sampler in enumerate(samplers) if power[k] > 0.0 and isinstance(sampler, Aimable)
        }
        center = np.hstack([ball.center for ball in balls.values()]) if balls else np.zeros((3, 1))
        self._lay_out(center, bounds)
        expected = np.empty((self.everywhere, power.size))
        expected[:] = power / max(radius, 1e-150) ** 2
        middles, half = self._middles()
        for (k, ball), place in zip(balls.items(), center.T, strict=False):
            apart = np.square(middles - place[:, None]).sum(axis=0) + half + ball.radius**2
            expected[:, k] = power[k] / (4.0 * np.maximum(apart, 1e-300))
        self.useful = self.everywhere > 1 and len(balls) > 0
        chances = np.vstack([chances_by_place(power, expected), chances_by_power(power)])
        self._rows = Rows(chances)
        self._probability = self._rows.probability

    def _lay_out(self, center: np.ndarray, bounds: np.ndarray) -> None:
        """Choose the cells: about the lights' middles (3, k), within `bounds`, nearly cubes."""
        least, most = center.min(axis=1), center.max(axis=1)
        margin = 0.5 * (most - least).max()
        low, high = bounds
        least, most = np.clip(least - margin, low, high), np.clip(most + margin, low, high)
        extent = most - least
        longest = float(extent.max())
        limit = max(min(_MOST_CELLS, _MOST_CHANCES // max(center.shape[1], 1)), 1)
        self._count = np.ones(3, np.intp)
        for along in range(limit, 1, -1) if longest > 0.0 else ():
            count = np.maximum(np.ceil(extent / longest * along), 1.0)
            if count.prod() <= limit:
                self._count = count.astype(np.intp)
                break
        self._least, self._edge = least, extent / self._count
        self._per_metre = np.divide(1.0, self._edge, out=np.zeros(3), where=self._edge > 0.0)
        self.everywhere = int(self._count.prod())

    def _middles(self) -> tuple[np.ndarray, float]:
        """The cells' middles (3, c) in the order of their numbers, and their squared radius."""
        number = np.stack(np.unravel_index(np.arange(self.everywhere), tuple(self._count)))
        middles = self._least[:, None] + (number + 0.5) * self._edge[:, None]
        return middles, 0.25 * float(np.square(self._edge).sum())

    def cell(self, point: np.ndarray) -> np.ndarray:
        """The numbers (n,) of the cells that hold the points (3, n)."""
        number = np.zeros(point.shape[1], np.intp)
        for along in range(3):
            place = (point[along] - self._least[along]) * self._per_metre[along]
            number *= self._count[along]
            number += np.clip(place, 0.0, self._count[along] - 1.0).astype(np.intp)
        return number

    def choose(self, cell: np.ndarray, u: np.ndarray) -> np.ndarray:
        """The lights (n,) that the uniforms `u` (n,) choose in the cells (n,)."""
        return self._rows.sample(cell, u)[0]

    def probability(self, light: np.ndarray | int, cell: np.ndarray) -> np.ndarray:
        """Probability (n,) with which `choose` gives `light`, () or (n,), in the cells (n,)."""
        return self._probability[cell, light]
