# SPDX-License-Identifier: GPL-3.0-or-later
"""A point that sends the same intensity in all directions."""

from __future__ import annotations

import numpy as np

from ..sampling.warps import uniform_sphere
from ..scene.lights import PointLight
from ..vectors import dot
from .light import Ball, Emitted, LightSample, Pair, column, power_of


class PointSampler:
    """A point light, which is a delta light: one direction leads to it from any point.

    A point at the light itself gets nothing, and wi is zero.
    """

    delta = True

    def __init__(self, light: PointLight) -> None:
        self._position = column(light.position)
        self._intensity = column(light.intensity)
        self.flux = 4.0 * np.pi * np.abs(self._intensity[:, 0])
        self.power = power_of(self.flux)

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """The one direction; radiance = intensity / distance^2."""
        wi = self._position - point
        squared = dot(wi, wi)
        distance = np.sqrt(squared)
        inverse = 1.0 / np.where(distance > 0.0, distance, np.inf)
        wi *= inverse
        inverse *= inverse
        return LightSample(wi, distance, self._intensity * inverse, np.ones_like(distance))

    @property
    def extent(self) -> Ball:
        """The ball about the light, without size."""
        return Ball(self._position, 0.0, 0.0)

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Uniform in all directions."""
        return self.emit_along(uniform_sphere(*heading), 1.0 / (4.0 * np.pi), place)

    def emit_along(self, direction: np.ndarray, density: np.ndarray | float, place: Pair) -> Emitted:
        """Rays of given directions (3, n), sampled with `density` per steradian."""
        weight = np.broadcast_to(self._intensity / density, direction.shape)
        origin = np.broadcast_to(self._position, direction.shape)
        return Emitted(origin, direction, weight, np.full(direction.shape[1], np.inf))
