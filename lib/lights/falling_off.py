# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that get brighter or dimmer with the length of the ray that meets them."""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from ..scene.lights import Falloff
from .light import Ball, LightSample, LightSampler, Meetable, Pair


def brightness_at(falloff: Falloff, distance: np.ndarray) -> np.ndarray:
    """What multiplies the light over `distance` (n,) metres: d^power d^2 / (smooth + d^2); 0 at no distance."""
    square = distance * distance
    fading = square + falloff.smooth
    return distance**falloff.power * np.divide(square, fading, out=np.zeros_like(square), where=fading > 0.0)


class FallingOff:
    """A light whose radiance is multiplied by `brightness_at`; samples are those of the light itself.

    It is chosen by its brightness over the radius of the scene.
    """

    def __init__(self, sampler: LightSampler, falloff: Falloff, scene_radius: float) -> None:
        self._sampler, self._falloff = sampler, falloff
        self.delta = sampler.delta
        self.power = sampler.power * float(brightness_at(falloff, np.array([scene_radius]))[0])

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """A direction to the light."""
        found = self._sampler.sample(point, u1, u2)
        return found._replace(radiance=found.radiance * brightness_at(self._falloff, found.distance))

    def candidates(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """As Meetable."""
        return self._met.candidates(origin, direction)

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """As Meetable."""
        distance, radiance = self._met.intersect(origin, direction)
        met = np.isfinite(distance)
        return distance, np.where(met, radiance * brightness_at(self._falloff, np.where(met, distance, 0.0)), 0.0)

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """As Meetable."""
        return self._met.pdf(origin, direction, distance)

    @property
    def _met(self) -> Meetable:
        if not isinstance(self._sampler, Meetable):
            raise TypeError("no ray meets this light")
        return self._sampler

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> NoReturn:
        """Raises TypeError: how bright a ray is depends on where it ends."""
        raise TypeError("rays that leave this light have no brightness of their own")
