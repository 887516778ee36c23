# SPDX-License-Identifier: GPL-3.0-or-later
"""A departure: where area lights overlap in one plane, rays meet only one of them.

In Cycles the lights are found by light samples too, so that a part of their light stays. Which part depends on its
densities, so the departure takes away all of it: Cycles lies between that and the sum.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..lights.area import AreaSampler
from ..lights.falling_off import FallingOff
from ..lights.falloff import brightness_at
from ..lights.light import LightSampler
from ..scene.light_overlaps import find_light_overlaps
from ..scene.lights import Falloff, Light

LIGHTS_IN_ONE_PLANE = "lights in one plane"
"""The departure that has rays meet one of the area lights that overlap in one plane."""


class _Panel(NamedTuple):
    """An area light before it falls off, and its falloff."""

    shape: AreaSampler
    falloff: Falloff

    def brightness(self, distance: np.ndarray) -> np.ndarray:
        """Power per area over `distance` (n,)."""
        return self.shape.power / self.shape.area * brightness_at(self.falloff, distance)

    def covers(self, point: np.ndarray) -> np.ndarray:
        """Whether points (3, n) of its plane are within it, (n,) bool."""
        x, y, _ = self.shape.local(point)
        return self.shape.contains(x, y)


class CoplanarLights:
    """The lights that hide others; read-only once made.

    Of two lights that overlap the one that is dimmer at the ray's origin is met, since that is all that Cycles may lose; of equals, the
    first.
    """

    def __init__(self, lights: Sequence[Light], samplers: Sequence[LightSampler]) -> None:
        self._panels = {k: _panel(*pair) for k, pair in enumerate(zip(lights, samplers, strict=True))}
        self._beside: dict[int, list[int]] = {}
        for a, b, _ in find_light_overlaps(lights):
            self._beside.setdefault(a, []).append(b)
            self._beside.setdefault(b, []).append(a)

    def hides(self, light: int, point: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Whether another light is met in place of light number `light` at `point` (3, n), (n,) bool.

        The rays come from a `distance` (n,).
        """
        hidden, own = np.zeros(point.shape[1], bool), self._panels[light]
        for number in self._beside.get(light, ()):
            other = self._panels[number]
            if own is not None and other is not None:
                ours, theirs = own.brightness(distance), other.brightness(distance)
                hidden |= other.covers(point) & ((theirs < ours) | ((theirs == ours) & (number < light)))
        return hidden


def _panel(light: Light, sampler: LightSampler) -> _Panel | None:
    shape = sampler.usual if isinstance(sampler, FallingOff) else sampler
    return _Panel(shape, light.falloff) if isinstance(shape, AreaSampler) else None
