# SPDX-License-Identifier: GPL-3.0-or-later
"""Light from a narrow cone at infinity."""

from __future__ import annotations

import math

import numpy as np

from ..scene.lights import SunLight
from ..vectors import dot
from .cone import density, uniform_cone
from .light import Ball, Emitted, LightSample, Pair, column, emit_distant, power_of


class SunSampler:
    """A sun: one direction where its angle is 0, otherwise a cone of uniform radiance.

    `scene_radius` in metres sets its power.
    """

    def __init__(self, light: SunLight, scene_radius: float = 1.0) -> None:
        self.delta = light.half_angle == 0.0
        self._direction = column(light.direction)
        self._one_minus_cos = 2.0 * math.sin(0.5 * light.half_angle) ** 2
        received = column(light.irradiance)
        self._radiance = received if self.delta else received / (math.pi * math.sin(light.half_angle) ** 2)
        self.flux = math.pi * scene_radius**2 * np.abs(received[:, 0])
        self.power = power_of(self.flux)

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Uniform in the cone of the sun."""
        count = point.shape[1]
        wi, radiance = np.empty((3, count)), np.empty((3, count))
        radiance[:] = self._radiance
        if self.delta:
            wi[:] = self._direction
            return LightSample(wi, np.full(count, np.inf), radiance, np.ones(count))
        wi, _ = uniform_cone(self._direction, self._one_minus_cos, u1, u2)
        return LightSample(wi, np.full(count, np.inf), radiance, np.full(count, density(self._one_minus_cos)))

    def candidates(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Rays in the cone of the sun."""
        return np.flatnonzero(self._within(direction))

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance inf everywhere; the radiance tells who sees the sun."""
        return np.full(direction.shape[1], np.inf), self._radiance * self._within(direction)

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """One over the solid angle of the sun."""
        return density(self._one_minus_cos) * self._within(direction)

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Through the ball, from directions uniform in the cone."""
        sample = self.sample(np.empty((3, heading[0].size)), *heading)
        emitted = emit_distant(sample, ball, place)
        return emitted._replace(brightness=np.full(sample.pdf.shape, np.inf)) if self.delta else emitted

    def _within(self, direction: np.ndarray) -> np.ndarray:
        """Return whether directions lie in the cone, by |a - b|^2 = 2 (1 - cos).

        This form keeps its digits in a narrow cone.
        """
        difference = direction - self._direction
        return dot(difference, difference) <= 2.0 * self._one_minus_cos
