# SPDX-License-Identifier: GPL-3.0-or-later
"""An area light whose spread is zero: a beam of parallel light."""

from __future__ import annotations

import math

import numpy as np

from ..scene.lights import AreaLight
from .area import AreaSampler
from .light import Ball, Emitted, LightSample, Pair, column


class BeamSampler:
    """A flat light of spread 0, which is a delta light.

    The limit is an irradiance of pi radiance on what faces the light within its outline.
    """

    delta = True

    def __init__(self, light: AreaLight, shape: AreaSampler) -> None:
        self._shape = shape
        self._towards = -shape.normal
        self._irradiance = math.pi * column(light.radiance)
        self.flux, self.power = shape.flux, shape.power

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Straight back to the light."""
        x, y, height = self._shape.local(point)
        lit = self._shape.contains(x, y)
        lit &= height > 0.0
        wi = np.empty(point.shape)
        wi[:] = self._towards
        return LightSample(wi, np.abs(height), self._irradiance * lit, np.ones_like(height))

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Uniform by area, along the normal."""
        emitted = self._shape.emit(ball, place, heading)
        direction = np.broadcast_to(-self._towards, emitted.direction.shape)
        weight = np.broadcast_to(self._irradiance * self._shape.area, direction.shape)
        return Emitted(emitted.origin, direction, weight, np.full(weight.shape[1], np.inf))
