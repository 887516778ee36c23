# SPDX-License-Identifier: GPL-3.0-or-later
"""Spheres of uniform radiance, sampled by the cone that they fill.

Shirley, Wang and Zimmerman 1996.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..sampling.warps import uniform_disk, uniform_sphere
from ..scene.lights import SphereLight
from ..vectors import dot, gather, orthonormal_basis
from .cone import density, uniform_cone
from .light import Ball, Emitted, LightSample, Pair, aimed_at_ball, column, luminance, power_of


class SphereSampler:
    """A sphere light.

    From inside it is seen in every direction, with the same radiance, as in Cycles.
    """

    delta = False

    def __init__(self, light: SphereLight) -> None:
        self.center = column(light.position)
        self.radius2 = light.radius**2
        self.radiance = column(light.radiance)
        self.flux = 4.0 * np.pi**2 * self.radius2 * np.abs(self.radiance[:, 0])
        self.power = power_of(self.flux)

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Uniform in the cone that the sphere fills; in all directions from inside."""
        radiance = np.empty_like(point)
        radiance[:] = self.radiance
        return _sample(self.center, self.radius2, radiance, point, u1, u2)

    def candidates(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Rays that all but pass the sphere."""
        return aimed_at_ball(self.center, self.radius2, origin, direction)

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nearest crossing from outside, the far one from inside."""
        offset = self.center - origin
        squared = dot(offset, offset)
        along = dot(offset, direction)
        # The distance from the axis by a difference of vectors: squared - along^2 would cancel far from the light.
        offset -= along * direction
        half_chord2 = self.radius2 - dot(offset, offset)
        hit = half_chord2 >= 0.0
        hit &= (along > 0.0) | (squared <= self.radius2)
        distance = np.full(hit.shape, np.inf)
        met = np.flatnonzero(hit)
        distance[met] = _distance(squared[met] - self.radius2, along[met], half_chord2[met])
        return distance, self.radiance * hit

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """One over the solid angle of the sphere, 1 / (4 pi) from inside."""
        offset = self.center - origin
        return density(_one_minus_cos(dot(offset, offset), self.radius2)) * np.isfinite(distance)

    @property
    def extent(self) -> Ball:
        """The ball itself."""
        return Ball(self.center, math.sqrt(self.radius2), 0.0)

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Return rays outwards, uniform over the sphere and by the cosine there.

        What the light sends to its inside is not among them.
        """
        return self.emit_along(uniform_sphere(*heading), 1.0 / (4.0 * np.pi), place)

    def emit_along(self, direction: np.ndarray, density: np.ndarray | float, place: Pair) -> Emitted:
        """Return rays of given directions (3, n), uniform on the disc that is seen from there.

        The directions were sampled with `density` per steradian.
        """
        x, y = uniform_disk(*place)
        rise = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
        t, s = orthonormal_basis(direction)
        origin = self.center + math.sqrt(self.radius2) * (t * x + s * y + direction * rise)
        weight = np.broadcast_to(self.radiance * (np.pi * self.radius2 / density), direction.shape)
        return Emitted(origin, direction, weight, np.full(x.shape, float(luminance(self.radiance)[0])))

    def inside(self, point: np.ndarray) -> np.ndarray:
        """Whether the points (3, n) lie inside, (n,)."""
        offset = self.center - point
        return dot(offset, offset) <= self.radius2


class Spheres:
    """Several sphere lights, a chosen one sampled from each point."""

    def __init__(self, lights: Sequence[SphereSampler]) -> None:
        self._center = np.hstack([light.center for light in lights])
        self._radius2 = np.array([light.radius2 for light in lights])
        self._radiance = np.hstack([light.radiance for light in lights])

    def sample(self, which: np.ndarray, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """As `SphereSampler.sample` by the light `which` (n,)."""
        center, radius2, radiance = (gather(table, which) for table in (self._center, self._radius2, self._radiance))
        return _sample(center, radius2, radiance, point, u1, u2)


def _sample(
    center: np.ndarray,
    radius2: np.ndarray | float,
    radiance: np.ndarray,
    point: np.ndarray,
    u1: np.ndarray,
    u2: np.ndarray,
) -> LightSample:
    """Uniform in the cone of spheres about `center` (3, 1) or (3, n)."""
    axis = center - point
    squared = dot(axis, axis)
    length = np.sqrt(squared)
    solid = _one_minus_cos(squared, radius2)
    if not length.all():
        axis[2, length == 0.0] = 1.0
        axis /= np.where(length > 0.0, length, 1.0)
    else:
        axis /= length
    wi, inner = uniform_cone(axis, solid, u1, u2)
    # What is left of the radius beside the ray, r^2 - d^2 sin^2.
    half_chord2 = 2.0 - inner
    half_chord2 *= inner
    half_chord2 *= squared
    np.subtract(radius2, half_chord2, out=half_chord2)
    np.clip(half_chord2, 0.0, None, out=half_chord2)
    squared -= radius2
    np.subtract(1.0, inner, out=inner)
    inner *= length
    return LightSample(wi, _distance(squared, inner, half_chord2), radiance, density(solid))


def _one_minus_cos(squared: np.ndarray, radius2: np.ndarray | float) -> np.ndarray:
    """Return 1 - cos of the half angle of a sphere, seen from a squared distance.

    It is 2 from inside.

    1 - cos = sin^2 / (1 + cos) does not cancel far away, cos^2 = (d^2 - r^2) / d^2 not close to the surface.
    """
    bounded = np.maximum(squared, radius2)
    solid = bounded - radius2
    solid /= bounded
    np.sqrt(solid, out=solid)
    solid += 1.0
    solid *= bounded
    np.divide(radius2, solid, out=solid)
    inside = squared <= radius2
    if inside.any():
        solid[inside] = 2.0
    return solid


def _distance(gap: np.ndarray, along: np.ndarray, half_chord2: np.ndarray) -> np.ndarray:
    """Return the distance to the sphere along a ray, by the product of the roots.

    It is exact just outside the sphere; `gap` = d^2 - r^2.
    """
    far = np.sqrt(half_chord2)
    far += along
    inside = gap <= 0.0
    if not inside.any():
        return np.divide(gap, far, out=far)
    return np.where(inside, far, gap / np.where(inside, 1.0, far))
