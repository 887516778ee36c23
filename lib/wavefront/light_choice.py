# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: choice of one light for each point, and of a direction towards it.

It also weighs light sampling against lobe sampling.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..departures.light_below import LIGHT_BELOW
from ..effects.names import Effect
from ..lights.light import LightSample
from ..sampling.mis import cutoff_power_heuristic, power_heuristic
from .kernel import Kernel


@dataclass(frozen=True)
class LightSampling:
    """How the lights of one kernel are sampled.

    runs: directions towards lights are sampled. selects: there is a choice of lights. weighs: what both strategies find is weighted
    by the heuristic; `by_lobes`: else it is lobe sampling that counts, unless light sampling alone finds a light. below_faces: light
    reaches below faces whose shading normal leans, as it does in Cycles.
    """

    runs: bool
    selects: bool
    weighs: bool
    by_lobes: bool
    below_faces: bool

    @staticmethod
    def of(kernel: Kernel) -> LightSampling:
        """What the kernel's plan and options call for."""
        needs, options = kernel.plan.needs, kernel.options
        # Light sampling is called for by lights that nothing else finds, and wherever it is one of the strategies.
        wanted = bool(kernel.sight.alone.any()) or (bool(kernel.lights) and options.direct != "bsdf")
        return LightSampling(
            runs=wanted and needs(Effect.LIGHT_SAMPLING),
            selects=kernel.selects and bool(kernel.lights),
            weighs=options.direct == "mis" and needs(Effect.MULTIPLE_IMPORTANCE_SAMPLING),
            by_lobes=options.direct == "bsdf",
            below_faces=LIGHT_BELOW in options.departures,
        )


@dataclass(frozen=True)
class LightChoice:
    """A light sample for each point.

    `number` is its light's, `probability` the chance of that light, `alone` whether only light sampling finds it, () or
    (n,) each. `cell` (n,) is where the light and its part were chosen, None where no chance depends on a place (lights/by_place.py).
    """

    sample: LightSample
    number: np.ndarray
    probability: np.ndarray
    alone: np.ndarray
    cell: np.ndarray | None = None

    def part(self, start: int, stop: int) -> LightChoice:
        """The samples from `start` to `stop`, sharing arrays."""
        piece = LightSample(*(a[..., start:stop] for a in self.sample))
        number, probability, alone = (
            a if np.ndim(a) == 0 else a[start:stop] for a in (self.number, self.probability, self.alone)
        )
        cell = None if self.cell is None else self.cell[start:stop]
        return LightChoice(piece, number, probability, alone, cell)

    def within_bounces(self, kernel: Kernel, scatterings: np.ndarray | int) -> LightChoice:
        """The samples, without light where a light's limit of bounces is below `scatterings`.

        `scatterings`, () or (n,), is how often each path has scattered.
        """
        limits = kernel.sight.max_bounces
        return self if limits is None else self.where(limits[self.number] >= scatterings)

    def where(self, lit: np.ndarray) -> LightChoice:
        """The samples with no light where it is not `lit`, () or (n,) bool."""
        return replace(self, sample=self.sample._replace(radiance=self.sample.radiance * lit))


def choose_light(
    kernel: Kernel,
    selects: bool,
    position: np.ndarray,
    cell: np.ndarray | None,
    choice: np.ndarray,
    u1: np.ndarray,
    u2: np.ndarray,
) -> LightChoice:
    """Pick a light for each point (3, n), then a direction towards it.

    `choice` picks the light where there is more than one (`selects`), by the chances of `cell` (n,), or by power where it is None;
    (u1, u2) give the part of the light, by the same chances, and the direction.
    """
    if not selects:
        sample = kernel.selection.sample_only(cell, position, u1, u2)
        return LightChoice(sample, np.asarray(0, np.intp), np.asarray(1.0), kernel.sight.alone[0], cell)
    index, probability = kernel.selection.choose(choice, cell)
    alone = np.take(kernel.sight.alone, index) if kernel.sight.alone.any() else np.asarray(False)
    return LightChoice(kernel.selection.sample(index, cell, position, u1, u2), index, probability, alone, cell)


def weigh_light(
    sampling: LightSampling, light: LightChoice, pdf: np.ndarray, below: np.ndarray | None = None
) -> np.ndarray:
    """The weight of light samples over their density, (n,).

    `pdf` (n,) is the density with which lobes or phase functions are sampled in their directions. What is `below` (n,) bool, where
    lobe sampling finds no light, keeps the weight that it has in Cycles, by the power heuristic.
    """
    density = light.sample.pdf * light.probability
    if sampling.weighs:
        other = np.where(light.alone, 0.0, pdf) if light.alone.any() else pdf
        factor = cutoff_power_heuristic(density, other)
        if below is not None:
            factor = np.where(below, power_heuristic(density, other), factor)
        factor /= density
        return factor
    if sampling.by_lobes:
        return np.where(light.alone, 1.0 / density, 0.0)
    return 1.0 / density
