# SPDX-License-Identifier: GPL-3.0-or-later
"""Rectangular lights, sampled uniformly in solid angle; parallelograms, by area."""

from __future__ import annotations

import numpy as np

from ..vectors import dot, gather, put
from .area import AreaSampler
from .light import LightSample
from .spherical_rectangle import SphericalRectangle

# Beyond this many diagonals from the centre a rectangle is sampled by area, at a quarter of the exact inversion's price. What that
# costs: with the distance the density's cube goes by a standard deviation of at most 3 / (sqrt(12) FAR) = 22 %, a variance of 0.05 a sample.
# At 1.5 diagonals it is 0.33, and a plane under a light, smooth otherwise, took six times the samples.
FAR = 4.0
# Below this solid angle (steradians) places are uniform in area: the two densities are then nearly one, and the inversion in
# solid angle would lose its digits, its error being about 1e-16 / solid angle.
SMALLEST_SOLID_ANGLE = 1e-7
# Where a larger share of the points is behind the light, the others are picked out first. To copy them there and back costs a tenth of
# a sample.
_MANY_BEHIND = 0.15


class ParallelogramSampler(AreaSampler):
    """A rectangle whose edges are not at right angles, sampled uniformly by area.

    It is a light under a sheared parent.
    """


class RectangleSampler(AreaSampler):
    """A rectangle, sampled uniformly in solid angle.

    Samples lie within the part of it that its spread lets shine on the point.

    Without spread, points `FAR` diagonals away or farther get places uniform in area.
    """

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Uniform in solid angle; uniform in area for points far away."""
        front = np.flatnonzero(dot(self.normal, point - self._center) > 0.0)
        size = point.shape[1]
        if front.size >= (1.0 - _MANY_BEHIND) * size:
            return self._sample_all(point, u1, u2)
        # No light reaches a point behind: any direction serves, and any density.
        direction = np.empty_like(point)
        direction[:] = -self.normal
        sample = LightSample(direction, np.ones(size), np.zeros_like(point), np.ones(size))
        if front.size:
            lit = self._sample_all(gather(point, front), gather(u1, front), gather(u2, front))
            for whole, part in zip(sample, lit, strict=True):
                put(whole, front, part)
        return sample

    def _sample_all(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Sample from all points, also from those behind the light."""
        near = self._near(point)
        if near.size == point.shape[1]:
            return self._sample_near(point, u1, u2)
        sample = super().sample(point, u1, u2)
        if near.size:
            close = self._sample_near(gather(point, near), gather(u1, near), gather(u2, near))
            for whole, part in zip(sample, close, strict=True):
                put(whole, near, part)
        return sample

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """The density of `sample` from each origin."""
        near = self._near(origin)
        if near.size == origin.shape[1]:
            return self._pdf_near(origin, direction, distance)
        pdf = super().pdf(origin, direction, distance)
        if near.size:
            pdf[near] = self._pdf_near(gather(origin, near), gather(direction, near), distance[near])
        return pdf

    def _near(self, point: np.ndarray) -> np.ndarray:
        """Indices of the points that are close, all of them where there is a spread."""
        if self._spread is not None:
            return np.arange(point.shape[1])
        offset = point - self._center
        return np.flatnonzero(dot(offset, offset) < FAR**2 * (self._length_u**2 + self._length_v**2))

    def _sample_near(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Uniform in solid angle; uniform in area where that is below `SMALLEST_SOLID_ANGLE`."""
        bounds, height, dark = self._seen(point)
        x0, x1, y0, y1 = bounds
        seen = SphericalRectangle(x0, x1, y0, y1, height)
        solid = seen.solid_angle
        x, y = seen.place(u1, u2)
        small = np.flatnonzero(solid < SMALLEST_SOLID_ANGLE)
        if small.size:
            x[small] = x0[small] + u1[small] * (x1 - x0)[small]
            y[small] = y0[small] + u2[small] * (y1 - y0)[small]
        across2, distance = self._reach(x, y, height)
        pdf = self._density_seen(bounds, height, solid, small, distance)
        return LightSample(self._direction(x, y, height, distance), distance, self._shine(across2, height, dark), pdf)

    def _pdf_near(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """One over the solid angle that is sampled."""
        bounds, height, dark = self._seen(origin)
        hit = np.isfinite(distance)
        x0, x1, y0, y1 = bounds
        solid = SphericalRectangle(x0, x1, y0, y1, height).solid_angle
        small = np.flatnonzero(solid < SMALLEST_SOLID_ANGLE)
        distance = np.where(hit, distance, 0.0)
        hit[dark] = False
        if self._spread is not None:
            across, up, _ = self._axes
            x, y = distance * dot(across, direction), distance * dot(up, direction)
            hit &= (x >= bounds[0]) & (x <= bounds[1]) & (y >= bounds[2]) & (y <= bounds[3])
        return self._density_seen(bounds, height, solid, small, distance) * hit

    def _seen(self, point: np.ndarray) -> tuple[tuple[np.ndarray, ...], np.ndarray, np.ndarray]:
        """Return the bounds (x0, x1, y0, y1) of what can shine on the points.

        They are relative to the feet of the points. Also returns the points' height, and where nothing can shine on
        them. There the numbers are those of a unit square 1 m away.
        """
        x, y, height = self.local(point)
        half_u, half_v = 0.5 * self._length_u, 0.5 * self._length_v
        x0, x1, y0, y1 = -half_u - x, np.subtract(half_u, x, out=x), -half_v - y, np.subtract(half_v, y, out=y)
        front = height > 0.0
        if self._spread is not None:
            reach = height * self._spread.tan_half
            x0, y0 = np.maximum(x0, -reach), np.maximum(y0, -reach)
            x1, y1 = np.minimum(x1, reach), np.minimum(y1, reach)
            front &= (x1 > x0) & (y1 > y0)
        dark = np.flatnonzero(~front)
        if dark.size:
            x0[dark], x1[dark], y0[dark], y1[dark], height[dark] = -0.5, 0.5, -0.5, 0.5, 1.0
        return (x0, x1, y0, y1), height, dark

    def _density_seen(
        self,
        bounds: tuple[np.ndarray, ...],
        height: np.ndarray,
        solid: np.ndarray,
        small: np.ndarray,
        distance: np.ndarray,
    ) -> np.ndarray:
        pdf = 1.0 / np.maximum(solid, SMALLEST_SOLID_ANGLE)
        if small.size:
            x0, x1, y0, y1 = (bound[small] for bound in bounds)
            pdf[small] = self._density(height[small], distance[small], (x1 - x0) * (y1 - y0))
        return pdf
