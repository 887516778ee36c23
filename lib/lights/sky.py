# SPDX-License-Identifier: GPL-3.0-or-later
"""The world as a light where small suns stand in it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..scene.expressions import Expression
from ..scene.lights import SunLight
from ..scene.sky import Sky
from ..textures.fold import walk
from ..textures.sky import toward
from ..vectors import put
from .cone import uniform_cone
from .environment import EnvironmentSampler
from .light import Ball, Emitted, LightSample, Pair, column, emit_distant, luminance
from .sun import SunSampler

Sun = tuple[tuple[float, float, float], float]
"""A unit direction and a half angle in radians."""

# A sun is looked at in PROBES x PROBES places.
PROBES = 8


def suns_of(radiance: Expression) -> list[Sun]:
    """The suns of all skies in a world's radiance, each once."""
    skies = (node for node in walk(radiance) if isinstance(node, Sky))
    discs = ((sky.azimuth, sky.sun) for sky in skies if sky.sun is not None)
    return list(dict.fromkeys((toward(sun.elevation, azimuth), 0.5 * sun.diameter) for azimuth, sun in discs))


class SunnySampler:
    """Directions in the cones of suns, or else by a table of the rest of the world.

    A table's cells would miss slivers of their discs. A part is chosen half by its power, half evenly. Everything else as EnvironmentSampler.
    """

    delta = False

    def __init__(
        self,
        radiance_function: Callable[[np.ndarray], np.ndarray],
        table_resolution: tuple[int, int],
        suns: Sequence[Sun],
        scene_radius: float = 1.0,
    ) -> None:
        self._radiance = radiance_function
        self._suns = [self._sun(direction, half_angle, scene_radius) for direction, half_angle in suns]
        self._rest = EnvironmentSampler(self._beside, table_resolution, scene_radius)
        self.nonfinite = self._rest.nonfinite
        powers = np.array([self._rest.power, *(sun.power for sun in self._suns)])
        self.flux = sum((sun.flux for sun in self._suns), self._rest.flux)
        self.power = float(powers.sum())
        shares = powers / self.power if self.power > 0.0 else np.full(powers.shape, 1.0 / powers.size)
        self._chance = 0.5 * (shares + 1.0 / powers.size)
        self._edges = np.cumsum(self._chance)[:-1]

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """A direction into a sun or to where the rest is bright; the same from every `point`."""
        part = np.searchsorted(self._edges, u1, side="right")
        wi, radiance = np.empty((3, u1.size)), np.empty((3, u1.size))
        for k, sampler in enumerate((self._rest, *self._suns)):
            at = np.flatnonzero(part == k)
            again = (np.take(u1, at) - (self._edges[k - 1] if k else 0.0)) / self._chance[k]
            drawn = sampler.sample(np.take(point, at, axis=1), np.clip(again, 0.0, 1.0 - 1e-16), np.take(u2, at))
            put(wi, at, drawn.wi)
            put(radiance, at, drawn.radiance)
        in_sun = np.flatnonzero(self._within(wi))
        put(radiance, in_sun, self._radiance(np.take(wi, in_sun, axis=1)))
        distance = np.full(u1.size, np.inf)
        return LightSample(wi, distance, radiance, self.pdf(point, wi, distance))

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distance inf and the radiance of the world."""
        return np.full(direction.shape[1], np.inf), self._radiance(direction)

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """The parts' densities, each times its chance."""
        total = self._chance[0] * self._rest.pdf(origin, direction, distance)
        for chance, sun in zip(self._chance[1:], self._suns, strict=True):
            total += chance * sun.pdf(origin, direction, distance)
        return total

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Through the ball, from where the world is bright."""
        return emit_distant(self.sample(np.empty((3, heading[0].size)), *heading), ball, place)

    def _sun(self, direction: tuple[float, float, float], half_angle: float, scene_radius: float) -> SunSampler:
        """A sun as bright on average as what stands there."""
        place = (np.arange(PROBES) + 0.5) / PROBES
        u1, u2 = (u.ravel() for u in np.meshgrid(place, place))
        wi, _ = uniform_cone(column(direction), 2.0 * np.sin(0.5 * half_angle) ** 2, u1, u2)
        seen = np.abs(luminance(self._radiance(wi)))
        mean = float(np.where(np.isfinite(seen), seen, 0.0).mean())
        irradiance = (mean * np.pi * np.sin(half_angle) ** 2,) * 3
        return SunSampler(SunLight("", direction, half_angle, irradiance), scene_radius)

    def _within(self, direction: np.ndarray) -> np.ndarray:
        """Whether directions point into any sun."""
        return np.any([sun.pdf(direction, direction, direction[0]) > 0.0 for sun in self._suns], axis=0)

    def _beside(self, direction: np.ndarray) -> np.ndarray:
        """The radiance of the world where there is no sun."""
        return np.where(self._within(direction), 0.0, self._radiance(direction))
