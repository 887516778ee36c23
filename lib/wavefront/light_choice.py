# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: one light for each point, and a direction towards it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..lights.light import LightSample
from .kernel import Kernel


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
    kernel: Kernel, position: np.ndarray, choice: np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> LightChoice:
    """Pick a light by power with `choice`, then a direction by (u1, u2), for each point (3, n)."""
    lights = kernel.lights
    if not kernel.selects_lights:
        return LightChoice(lights[0].sample(position, u1, u2), np.float64(1.0), np.bool_(lights[0].delta))
    index, probability = kernel.selection.choose(choice)
    delta = np.take(kernel.light_is_delta, index) if kernel.light_is_delta.any() else np.bool_(False)
    return LightChoice(kernel.selection.sample(index, position, u1, u2), probability, delta)
