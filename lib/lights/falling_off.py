# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that get brighter or dimmer with the length of the ray that meets them."""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from ..scene.lights import Falloff
from .cells import Parts
from .falloff import brightness_at
from .light import Aimable, Ball, LightSample, LightSampler, Meetable, Pair, power_of


class FallingOff:
    """A light whose radiance is multiplied by `brightness_at`; samples are those of the light itself.

    Its `flux` and `power` are those over the radius of the scene. `usual` is the light as if it fell off as usual.
    """

    def __init__(self, sampler: LightSampler, falloff: Falloff, scene_radius: float) -> None:
        self.usual, self._falloff = sampler, falloff
        self.delta = sampler.delta
        self.flux = sampler.flux * brightness_at(falloff, np.array([scene_radius]))[0]
        self.power = power_of(self.flux)

    @property
    def part(self) -> Parts | None:
        """The light as the only part of itself, by which it can be chosen at a place; None where that does not matter."""
        if not isinstance(self.usual, Aimable):
            return None
        ball = self.usual.extent
        return Parts(np.array([self.usual.power]), ball.center, np.array([ball.radius]), self._falloff)

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """A direction to the light."""
        found = self.usual.sample(point, u1, u2)
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
        if not isinstance(self.usual, Meetable):
            raise TypeError("no ray meets this light")
        return self.usual

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> NoReturn:
        """Raises TypeError: how bright a ray is depends on where it ends."""
        raise TypeError("rays that leave this light have no brightness of their own")
