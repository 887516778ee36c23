# SPDX-License-Identifier: GPL-3.0-or-later
"""Stage: one light for each point, and a direction towards it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..lights.light import LightSample
from .kernel import Kernel


@dataclass(frozen=True)
class LightChoice:
    """A light sample for each point, with the chance (n,) of its light and whether that light is a delta (n,), or () both."""

    sample: LightSample
    probability: np.ndarray
    delta: np.ndarray

    def part(self, start: int, stop: int) -> LightChoice:
        """The samples from `start` to `stop`, sharing arrays."""
        piece = LightSample(*(a[..., start:stop] for a in self.sample))
        if np.ndim(self.delta) == 0:
            return LightChoice(piece, self.probability, self.delta)
        return LightChoice(piece, self.probability[start:stop], self.delta[start:stop])


def choose_light(
    kernel: Kernel, position: np.ndarray, choice: np.ndarray, u1: np.ndarray, u2: np.ndarray
) -> LightChoice:
    """Pick a light by power with `choice`, then a direction by (u1, u2), for each point (3, n)."""
    lights = kernel.lights
    if len(lights) == 1:
        return LightChoice(lights[0].sample(position, u1, u2), np.float64(1.0), np.bool_(lights[0].delta))
    index, probability, _ = kernel.selection.choose(choice)
    count = position.shape[1]
    wi, radiance = np.empty((3, count)), np.empty((3, count))
    distance, pdf = np.empty(count), np.empty(count)
    for k in np.flatnonzero(np.bincount(index, minlength=len(lights))):
        at = np.flatnonzero(index == k)
        one = lights[k].sample(np.take(position, at, axis=1), u1[at], u2[at])
        wi[:, at], distance[at], radiance[:, at], pdf[at] = one
    return LightChoice(LightSample(wi, distance, radiance, pdf), probability, kernel.light_is_delta[index])
