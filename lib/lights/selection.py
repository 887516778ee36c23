# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of several lights to sample, and samples of the chosen ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..sampling.tables import Distribution1D
from ..vectors import gather
from .by_place import LightGrid, chances_by_power
from .light import Divided, LightSample, LightSampler
from .sphere import Spheres, SphereSampler


class LightSelection:
    """Selects one light for each point: by `chances_by_power`, or by the place of the point.

    It goes by place where there is a `grid`. With a single light there is nothing to do.
    """

    def __init__(self, samplers: Sequence[LightSampler], grid: LightGrid | None = None) -> None:
        if not samplers:
            raise ValueError("there is no light to select")
        self.samplers = tuple(samplers)
        self.grid = grid
        self._choice = Distribution1D(chances_by_power(np.array([sampler.flux for sampler in samplers])))
        # Spheres are sampled all together, lights of other kinds one by one.
        spheres = {k: sampler for k, sampler in enumerate(samplers) if type(sampler) is SphereSampler}
        others = [k for k, sampler in enumerate(samplers) if type(sampler) is not SphereSampler]
        self._batches: list[Spheres | LightSampler] = [samplers[k] for k in others]
        self._batch_of, self._place = np.empty((2, len(samplers)), np.intp)
        self._batch_of[others] = np.arange(len(others))
        if spheres:
            self._batches.append(Spheres(list(spheres.values())))
            self._batch_of[list(spheres)], self._place[list(spheres)] = len(others), np.arange(len(spheres))

    def cells(self, point: np.ndarray) -> np.ndarray | None:
        """The cells (n,) of the grid that decide at points (3, n); None where there is no grid."""
        return None if self.grid is None else self.grid.cells.number(point)

    def everywhere(self, size: int) -> np.ndarray | None:
        """As many times the cell whose chances go by power alone; None where there is no grid."""
        return None if self.grid is None else np.full(size, self.grid.cells.everywhere, np.intp)

    def choose(self, u: np.ndarray, cell: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Index (n,) into `samplers` by the uniform `u`, and its probability (n,).

        `cell` (n,) is what `cells` or `everywhere` gave.
        """
        index = self._choice.index(u) if self.grid is None or cell is None else self.grid.choose(cell, u)
        return index, self.probability(index, cell)

    def probability(self, index: np.ndarray | int, cell: np.ndarray | None = None) -> np.ndarray:
        """Probability with which `choose` gives `index` in the cells, (n,)."""
        if self.grid is None or cell is None:
            return np.take(self._choice.probability, index)
        return self.grid.probability(index, cell)

    def sample(
        self, index: np.ndarray, cell: np.ndarray | None, point: np.ndarray, u1: np.ndarray, u2: np.ndarray
    ) -> LightSample:
        """A direction from each point (3, n) towards the light `index` (n,) there; `cell` as for `choose`."""
        if len(self._batches) == 1:
            return self._sample_batch(0, index, cell, point, u1, u2)
        batch = gather(self._batch_of, index).astype(np.int16)
        order = np.argsort(batch, kind="stable")
        index, point, u1, u2 = (gather(a, order) for a in (index, point, u1, u2))
        cell = None if cell is None else gather(cell, order)
        stops = np.cumsum(np.bincount(batch, minlength=len(self._batches)))
        count = index.shape[0]
        whole = LightSample(np.empty((3, count)), np.empty(count), np.empty((3, count)), np.empty(count))
        start = 0
        for k, stop in enumerate(stops):
            if stop > start:
                here = slice(start, stop)
                there = None if cell is None else cell[here]
                part = self._sample_batch(k, index[here], there, point[:, here], u1[here], u2[here])
                for array, values in zip(whole, part, strict=True):
                    array[..., here] = values
            start = stop
        back = np.empty_like(order)
        back[order] = np.arange(count)
        return LightSample(*(gather(array, back) for array in whole))

    def sample_only(self, cell: np.ndarray | None, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """A direction from each point (3, n) towards the only light; `cell` as for `choose`."""
        return _sample(self.samplers[0], cell, point, u1, u2)

    def _sample_batch(
        self,
        batch: int,
        index: np.ndarray,
        cell: np.ndarray | None,
        point: np.ndarray,
        u1: np.ndarray,
        u2: np.ndarray,
    ) -> LightSample:
        """Samples of lights of one batch."""
        sampler = self._batches[batch]
        if isinstance(sampler, Spheres):
            return sampler.sample(gather(self._place, index), point, u1, u2)
        return _sample(sampler, cell, point, u1, u2)


def _sample(
    sampler: LightSampler, cell: np.ndarray | None, point: np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> LightSample:
    """Samples of one light, of the parts that the cells (n,) choose where it has any."""
    if cell is not None and isinstance(sampler, Divided):
        return sampler.sample_from(cell, point, u1, u2)
    return sampler.sample(point, u1, u2)
