# SPDX-License-Identifier: GPL-3.0-or-later
"""What rectangles and ellipses share.

It is the plane, one emitting side, the spread, and sampling by area.
"""

from __future__ import annotations

import math

import numpy as np

from ..sampling.warps import uniform_disk
from ..scene.lights import AreaLight
from ..vectors import dot
from .light import Ball, Emitted, LightSample, Pair, aimed_at_ball, column, luminance, power_of
from .spread import Spread

_SMALLEST = 1e-300


class AreaSampler:
    """A flat light, sampled uniformly by area.

    rectangle.py and ellipse.py define its shape.

    Its frame has x along `edge_u` and z along the emitting normal; a point in it is (x, y, height). The light is the
    image of the square |s| <= 1/2, |t| <= 1/2 under x = s length_u + t skew, y = t length_v. A light without area is
    lit nowhere.
    """

    delta = False
    _area_of_unit = 1.0

    def __init__(self, light: AreaLight) -> None:
        self._center = column(light.center)
        edge_u, edge_v = np.array(light.edge_u, float), np.array(light.edge_v, float)
        normal = np.cross(edge_u, edge_v)
        area = float(np.linalg.norm(normal))
        self._area = area * self._area_of_unit or 1.0  # what one divides by, also where nothing is lit
        self._lights = area > 0.0
        if area > 0.0:
            normal /= math.copysign(area, float(normal @ light.normal))
            self._length_u = float(np.linalg.norm(edge_u))
            across = edge_u / self._length_u
            up = np.cross(normal, across)
            self._length_v, self._skew = float(edge_v @ up), float(edge_v @ across)
            if abs(self._skew) <= 1e-12 * abs(self._length_v):
                self._skew = 0.0
            if self._length_v < 0.0:  # the shape is the same with the edge turned round
                self._length_v, self._skew = -self._length_v, -self._skew
            self._axes = (across.reshape(3, 1), up.reshape(3, 1), normal.reshape(3, 1))
        else:
            self._length_u = self._length_v = 1.0
            self._skew = 0.0
            self._axes = (column((1.0, 0.0, 0.0)), column((0.0, 1.0, 0.0)), column((0.0, 0.0, 1.0)))
        self.normal = self._axes[2]
        self.sheared = self._skew != 0.0
        self._reach2 = 0.25 * ((self._length_u + abs(self._skew)) ** 2 + self._length_v**2)
        self._radiance = column(light.radiance)
        self._spread = Spread(light.spread) if 0.0 < light.spread < math.pi else None
        self.flux = math.pi * area * self._area_of_unit * np.abs(self._radiance[:, 0])
        self.power = power_of(self.flux)

    @property
    def area(self) -> float:
        """Square metres, 0 for a light that is lit nowhere."""
        return self._area if self._lights else 0.0

    def sample(self, point: np.ndarray, u1: np.ndarray, u2: np.ndarray) -> LightSample:
        """Uniform over the area."""
        x, y, height = self.local(point)
        dark = self._unlit(height)
        s, t = self._place(u1, u2)
        np.subtract(self._along_u(s, t), x, out=x)
        t *= self._length_v
        np.subtract(t, y, out=y)
        return self._towards(x, y, height, dark, self._area)

    def candidates(self, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
        """Rays that pass the ball about the light."""
        return aimed_at_ball(self._center, self._reach2, origin, direction)

    def intersect(self, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Hit on the emitting side only."""
        x, y, height = self.local(origin)
        across, up, normal = self._axes
        falling = -dot(normal, direction)
        distance = np.full(height.shape, np.inf)
        radiance = np.zeros(direction.shape)
        ahead = np.flatnonzero((height > 0.0) & (falling > 0.0))
        if not ahead.size:
            return distance, radiance
        toward, falling = np.take(direction, ahead, axis=1), falling[ahead]
        reach = height[ahead] / falling
        toward_x, toward_y = dot(across, toward), dot(up, toward)
        hit = self.contains(x[ahead] + reach * toward_x, y[ahead] + reach * toward_y)
        met = ahead[hit]
        distance[met] = reach[hit]
        if self._spread is None:
            radiance[:, met] = self._radiance
        else:
            tan_theta = np.sqrt(toward_x[hit] ** 2 + toward_y[hit] ** 2) / falling[hit]
            radiance[:, met] = self._radiance * self._spread(tan_theta)
        return distance, radiance

    def pdf(self, origin: np.ndarray, direction: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Area density times distance^2 / cosine at the light."""
        _, _, height = self.local(origin)
        return self._density(height, distance, self._area)

    @property
    def extent(self) -> Ball:
        """The ball about the light."""
        return Ball(self._center, math.sqrt(self._reach2), 0.0)

    def emit(self, ball: Ball, place: Pair, heading: Pair) -> Emitted:
        """Uniform by area, and by the cosine within the spread."""
        across, up, normal = self._axes
        widest = 1.0 if self._spread is None else self._spread.sin2_half
        x, y = uniform_disk(*heading)
        x, y = x * math.sqrt(widest), y * math.sqrt(widest)
        z = np.sqrt(1.0 - x * x - y * y)
        return self.emit_along(across * x + up * y + normal * z, z / (math.pi * widest), place)

    def emit_along(self, direction: np.ndarray, density: np.ndarray, place: Pair) -> Emitted:
        """Return rays of given directions (3, n), uniform by area.

        The directions were sampled with `density` (n,) per steradian.
        """
        s, t = self._place(*place)
        across, up, normal = self._axes
        origin = self._center + across * self._along_u(s, t) + up * (t * self._length_v)
        cosine = np.maximum(dot(normal, direction), 0.0)
        factor = (cosine > 0.0).astype(np.float64)
        if self._spread is not None:
            sine2 = np.square(dot(across, direction)) + np.square(dot(up, direction))
            factor *= self._spread(np.sqrt(sine2) / np.maximum(cosine, _SMALLEST))
        radiance = self._radiance * factor
        return Emitted(origin, direction, radiance * (cosine * self.area / density), luminance(radiance))

    def local(self, point: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Components (n,) of points (3, n) in the light's frame; height > 0 on the emitting side."""
        offset = point - self._center
        across, up, normal = self._axes
        height = dot(normal, offset)
        if not self._lights:
            height[:] = -1.0
        return dot(across, offset), dot(up, offset), height

    def contains(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Whether points of the light's plane belong to it, (n,)."""
        t = y / self._length_v
        s = x - t * self._skew if self._skew else x
        return self._holds(s / self._length_u, t)

    def _along_u(self, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """The x of the place (s, t)."""
        x = s * self._length_u
        if self._skew:
            x += t * self._skew
        return x

    @staticmethod
    def _unlit(height: np.ndarray) -> np.ndarray:
        """Return the indices of the points that the light does not reach.

        Their height becomes 1, which keeps all that follows finite.
        """
        dark = np.flatnonzero(~(height > 0.0))
        if dark.size:
            height[dark] = 1.0
        return dark

    def _towards(
        self, x: np.ndarray, y: np.ndarray, height: np.ndarray, dark: np.ndarray, area: np.ndarray | float
    ) -> LightSample:
        """Return the sample whose end lies x and y from the foot of the point.

        The light does not reach the points at `dark`.

        `area` is what was sampled uniformly.
        """
        across2, distance = self._reach(x, y, height)
        pdf = distance * distance
        pdf *= distance
        pdf /= height
        pdf /= area
        np.clip(pdf, _SMALLEST, None, out=pdf)
        return LightSample(self._direction(x, y, height, distance), distance, self._shine(across2, height, dark), pdf)

    @staticmethod
    def _reach(x: np.ndarray, y: np.ndarray, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """x^2 + y^2, and the distance of the place x and y from the foot."""
        across2 = x * x
        squared = y * y
        across2 += squared
        np.multiply(height, height, out=squared)
        squared += across2
        return across2, np.sqrt(squared, out=squared)

    def _direction(self, x: np.ndarray, y: np.ndarray, height: np.ndarray, distance: np.ndarray) -> np.ndarray:
        """Return unit vectors (3, n) to places x and y from the foot of a point at `height`.

        They are zero where the distance is 0.
        """
        inverse = 1.0 / np.clip(distance, _SMALLEST, np.inf)
        x, y, down = x * inverse, y * inverse, np.multiply(height, inverse, out=inverse)
        wi, scratch = np.empty((3, x.shape[0])), np.empty_like(x)
        for out, across, up, normal in zip(wi, *(axis[:, 0] for axis in self._axes), strict=True):
            np.multiply(x, across, out=out)
            out += np.multiply(y, up, out=scratch)
            out -= np.multiply(down, normal, out=scratch)
        return wi

    def _shine(self, across2: np.ndarray, height: np.ndarray, dark: np.ndarray) -> np.ndarray:
        """Return the radiance (3, n) at the angle whose tangent is sqrt(across2) / height.

        It is 0 for the points at `dark`.
        """
        factor = None if self._spread is None else self._spread(np.sqrt(across2) / height)
        radiance = np.empty((3, height.shape[0]))
        for out, channel in zip(radiance, self._radiance[:, 0], strict=True):
            if factor is None:
                out.fill(channel)
            else:
                np.multiply(factor, channel, out=out)
            if dark.size:
                out[dark] = 0.0
        return radiance

    @staticmethod
    def _density(height: np.ndarray, distance: np.ndarray, area: np.ndarray | float) -> np.ndarray:
        """distance^3 / (height area), per steradian, 0 where nothing was hit."""
        hit = np.isfinite(distance)
        distance = np.where(hit, distance, 0.0)
        return distance * distance * distance / np.where(hit, height * area, 1.0)

    def _place(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Uniform (s, t) over the shape's part of the square."""
        return u1 - 0.5, u2 - 0.5

    def _holds(self, s: np.ndarray, t: np.ndarray) -> np.ndarray:
        """Whether (s, t) belongs to the shape."""
        inside = np.abs(s) <= 0.5
        inside &= np.abs(t) <= 0.5
        return inside
