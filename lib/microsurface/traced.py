# SPDX-License-Identifier: GPL-3.0-or-later
"""What rays find on a height field.

They find which facets two directions see, and what a field of mirrors reflects.
"""

from __future__ import annotations

import numpy as np

from ..vectors import dot
from ..wavefront.raycaster import Raycaster
from .height_field import gaussian_field, tiled_mesh

_BOUNCES = 20
"""Reflections after which a ray counts as lost; fewer than one in 10^4 is on its way that long."""
_LAPS = 100
"""Times that a ray may cross the field before it counts as free: it is all but level then, and rises."""


class TracedField:
    """One periodic height field of `cells` x `cells`, and its ray caster.

    The ray caster covers the field and half of its neighbours.

    Rays that leave these are moved back by whole periods, so that the field has no end.
    """

    def __init__(self, rng: np.random.Generator, cells: int, correlation: float, alpha: float) -> None:
        heights = gaussian_field(rng, cells, correlation, alpha)
        self._rng, self._cells, self._top = rng, cells, float(heights.max())
        self._margin = cells // 2
        self._caster = Raycaster(tiled_mesh(heights, self._margin))

    def seen(self, directions: list[np.ndarray], count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the facets at `count` places that are uniform over the mean plane.

        The results are normals (3, n), area per place (n,), seen (directions, n).

        `directions` (3,) unit, upwards. A facet that faces away from a direction is not seen along it.
        """
        point, normal, offset = self._facets(count)
        found = np.zeros((len(directions), count), bool)
        for row, direction in zip(found, directions, strict=True):
            index = np.flatnonzero(dot(direction[:, None], normal) > 0.0)
            along = np.repeat(direction[:, None], index.size, axis=1)
            triangle, _ = self._next(point[:, index] + offset[index] * normal[:, index], along)
            row[index] = triangle < 0
        return normal, 1.0 / normal[2], found

    def reflected(self, direction: np.ndarray, count: int) -> tuple[float, float]:
        """Return the share of light that leaves white mirrors after one reflection, and after any.

        The light goes along -`direction` (3,). The second share counts any number of reflections.
        """
        point = np.concatenate([self._rng.uniform(0.0, self._cells, (2, count)), np.full((1, count), self._top + 1.0)])
        ray, free = np.repeat(-direction[:, None], count, axis=1), []
        for _ in range(_BOUNCES + 1):
            triangle, met = self._next(point, ray)
            keep = np.flatnonzero(triangle >= 0)
            free.append(triangle.size - keep.size)
            placed, normal, offset = self._caster.on_plane(triangle[keep], met[:, keep])
            ray = ray[:, keep]
            ray = ray - 2.0 * dot(ray, normal) * normal
            point = placed + offset * normal
        return free[1] / count, sum(free) / count

    def _next(self, origin: np.ndarray, ray: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the triangles (n,) that rays meet, and where (3, n).

        The triangle is -1 for rays that leave the field upwards. The places may be a whole period off.
        """
        triangle, met = np.full(origin.shape[1], -1, np.int32), origin.copy()
        index = np.arange(origin.shape[1])
        for _ in range(_LAPS):
            start = met[:, index]
            start[:2] %= self._cells
            along = ray[:, index]
            lap = self._margin / np.maximum(np.hypot(along[0], along[1]), 1e-3)
            hits = self._caster.closest(start, along, lap)
            step = np.where(hits.triangle < 0, lap, hits.distance)
            met[:, index], triangle[index] = start + step * along, hits.triangle
            on = (hits.triangle < 0) & ~((met[2, index] > self._top) & (along[2] >= 0.0))
            index = index[on]
            if index.size == 0:
                break
        return triangle, met

    def _facets(self, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return points (3, n) on the field above uniform places.

        The other results are the upward normals there, and the offsets that rays need.
        """
        place = self._rng.uniform(0.0, self._cells, (2, count))
        origin = np.concatenate([place, np.full((1, count), self._top + 1.0)])
        down = np.zeros((3, count))
        down[2] = -1.0
        hits = self._caster.closest(origin, down)
        placed, normal, offset = self._caster.on_plane(hits.triangle, origin + hits.distance * down)
        return placed, normal, offset
