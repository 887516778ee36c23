# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: one light for each point, and a direction towards it; and how light sampling and lobe sampling share the work."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..effects.names import Effect
from ..lights.light import LightSample
from .kernel import LIGHT_BELOW, Kernel


@dataclass(frozen=True)
class LightSampling:
    """How the lights of one kernel are sampled.

    runs: directions towards lights are sampled. selects: there is a choice of lights. weighs: what both strategies find is weighted
    by the heuristic; `by_lobes`: else it is lobe sampling that counts, unless a light is a delta. below_faces: light reaches below
    smooth-shaded faces, as it does in Cycles.
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
        wanted = bool(kernel.light_is_delta.any()) or (bool(kernel.lights) and options.direct != "bsdf")
        return LightSampling(
            runs=wanted and needs(Effect.LIGHT_SAMPLING),
            selects=needs(Effect.LIGHT_SELECTION) and bool(kernel.lights),
            weighs=options.direct == "mis" and needs(Effect.MULTIPLE_IMPORTANCE_SAMPLING),
            by_lobes=options.direct == "bsdf",
            below_faces=LIGHT_BELOW in options.departures,
        )


@dataclass(frozen=True)
class LightChoice:
    """A light sample for each point, with the chance of its light and whether that light is a delta, () or (n,) each."""

    sample: LightSample
    probability: np.ndarray
    delta: np.ndarray

    def part(self, start: int, stop: int) -> LightChoice:
        """The samples from `start` to `stop`, sharing arrays."""
        piece = LightSample(*(a[..., start:stop] for a in self.sample))
        probability, delta = (a if np.ndim(a) == 0 else a[start:stop] for a in (self.probability, self.delta))
        return LightChoice(piece, probability, delta)


def choose_light(
    kernel: Kernel, selects: bool, position: np.ndarray, choice: np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> LightChoice:
    """Pick a light by power with `choice` if there is one to pick (`selects`), then a direction by (u1, u2), for each point (3, n)."""
    lights = kernel.lights
    if not selects:
        return LightChoice(lights[0].sample(position, u1, u2), np.float64(1.0), np.bool_(lights[0].delta))
    index, probability = kernel.selection.choose(choice)
    delta = np.take(kernel.light_is_delta, index) if kernel.light_is_delta.any() else np.bool_(False)
    return LightChoice(kernel.selection.sample(index, position, u1, u2), probability, delta)
