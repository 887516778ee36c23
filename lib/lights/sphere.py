# SPDX-License-Identifier: GPL-3.0-or-later
"""A sphere of uniform radiance, sampled by the cone that it fills (Shirley, Wang and Zimmerman 1996)."""

from __future__ import annotations

import numpy as np

from ..scene.lights import SphereLight
from ..vectors import dot
from .cone import density, uniform_cone
from .light import LightSample, column, luminance


class SphereSampler:
    """Sphere light; from inside it is seen in every direction, with the same radiance, as in Cycles."""

    delta = False

    def __init__(self, light: SphereLight) -> None:
        self.visible_camera = light.visible_camera
        self._center = column(light.position)
        self._radius2 = light.radius**2
        self._radiance = column(light.radiance)
        self.power = 4.0 * np.pi**2 * self._radius2 * float(luminance(np.abs(self._radiance))[0])

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Uniform in the cone that the sphere fills; in all directions from inside."""
        axis = self._center - point
        squared = dot(axis, axis)
        length = np.sqrt(squared)
        axis /= np.where(length > 0.0, length, np.inf)
        axis[2, length == 0.0] = 1.0
        solid = self._one_minus_cos(squared)
        wi, inner = uniform_cone(axis, solid, u1, u2)
        off_axis2 = inner * (2.0 - inner)
        off_axis2 *= squared
        distance = self._distance(squared, length * (1.0 - inner), np.maximum(self._radius2 - off_axis2, 0.0))
        radiance = np.empty_like(wi)
        radiance[:] = self._radiance
        return LightSample(wi, distance, radiance, density(solid))

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Nearest crossing from outside, the far one from inside."""
        offset = self._center - origin
        squared = dot(offset, offset)
        along = dot(offset, direction)
        # The distance from the axis by a difference of vectors: squared - along^2 would cancel far from the light.
        offset -= along * direction
        half_chord2 = self._radius2 - dot(offset, offset)
        hit = half_chord2 >= 0.0
        hit &= (along > 0.0) | (squared <= self._radius2)
        distance = np.full(hit.shape, np.inf)
        met = np.flatnonzero(hit)
        distance[met] = self._distance(squared[met], along[met], half_chord2[met])
        return distance, self._radiance * hit

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """One over the solid angle of the sphere, 1 / (4 pi) from inside."""
        offset = self._center - origin
        return density(self._one_minus_cos(dot(offset, offset))) * np.isfinite(distance)

    def inside(self, point: np.ndarray) -> np.ndarray:
        """Whether the points (3, n) lie inside, (n,)."""
        offset = self._center - point
        return dot(offset, offset) <= self._radius2

    def _one_minus_cos(self, squared: np.ndarray) -> np.ndarray:
        """1 - cos of the half angle under which the sphere is seen from a squared distance; 2 from inside.

        1 - cos = sin^2 / (1 + cos) does not cancel far away, cos^2 = (d^2 - r^2) / d^2 not close to the surface.
        """
        bounded = np.maximum(squared, self._radius2)
        solid = bounded - self._radius2
        solid /= bounded
        np.sqrt(solid, out=solid)
        solid += 1.0
        solid *= bounded
        np.divide(self._radius2, solid, out=solid)
        inside = squared <= self._radius2
        if inside.any():
            solid[inside] = 2.0
        return solid

    def _distance(self, squared: np.ndarray, along: np.ndarray, half_chord2: np.ndarray) -> np.ndarray:
        """Distance to the sphere along a ray, by the product of the roots, d^2 - r^2: exact just outside."""
        far = np.sqrt(half_chord2)
        far += along
        gap = squared - self._radius2
        inside = gap <= 0.0
        if not inside.any():
            return gap / far
        return np.where(inside, far, gap / np.where(inside, 1.0, far))
