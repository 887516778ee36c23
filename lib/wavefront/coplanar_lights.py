# SPDX-License-Identifier: GPL-3.0-or-later
"""A departure: where area lights overlap in one plane, rays meet only one of them.

In Cycles the lights are found by light samples too, so that a part of their light stays. Which part depends on its
densities, so the departure takes away all of it: Cycles lies between that and the sum.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..lights.area import AreaSampler
from ..lights.light import LightSampler
from ..scene.light_overlaps import find_light_overlaps
from ..scene.lights import Light

LIGHTS_IN_ONE_PLANE = "lights in one plane"
"""The departure that has rays meet one of the area lights that overlap in one plane."""


class CoplanarLights:
    """The lights that hide others; read-only once made.

    Of two lights that overlap the dimmer one is met, since that is all that Cycles may lose; of equals, the first.
    """

    def __init__(self, lights: Sequence[Light], samplers: Sequence[LightSampler]) -> None:
        self._hiding: dict[int, list[AreaSampler]] = {}
        for a, b, _ in find_light_overlaps(lights):
            first, second = samplers[a], samplers[b]
            if isinstance(first, AreaSampler) and isinstance(second, AreaSampler):
                is_dimmer = second.power / second.area < first.power / first.area
                hidden, met = (a, second) if is_dimmer else (b, first)
                self._hiding.setdefault(hidden, []).append(met)

    def hides(self, light: int, point: np.ndarray) -> np.ndarray:
        """Whether another light is met in place of light number `light` at `point` (3, n), (n,) bool."""
        hidden = np.zeros(point.shape[1], bool)
        for sampler in self._hiding.get(light, ()):
            x, y, _ = sampler.local(point)
            hidden |= sampler.contains(x, y)
        return hidden
