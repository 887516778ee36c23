# SPDX-License-Identifier: GPL-3.0-or-later
"""The solid angle of a rectangle, and places on it that are uniform in solid angle.

Urena, Fajardo and King 2013, "An area-preserving parametrization for spherical rectangles", rewritten: their sum of four angles
minus 2 pi has no digits left for a rectangle that is small, far, or seen edge on. Here the rectangle x0 <= x <= x1, y0 <= y <= y1, in a
plane at `height` from the origin, is cut out of the strip y0 <= y <= y1 that runs on to x = infinity. With r0 and r1 the
distances of (x, y0) and (x, y1), the strip beyond x >= 0 is a spherical triangle, and by van Oosterom and Strackee 1983, eq. 8,

    tan(angle / 2) = height (y1 - y0) / d(x),   d(x) = (x + r0) (x + r1) + y0 y1 + height^2.

Mirrored so that x1 >= |x0| and y1 >= |y0|, and cut at x = 0, every difference that matters is a sum of positive terms.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..vectors import gather


class _Edge(NamedTuple):
    """An edge at x >= 0 across the strip: its x, the distances of its ends, and d(x)."""

    x: np.ndarray
    r0: np.ndarray
    r1: np.ndarray
    d: np.ndarray


class _Strip:
    """Strips y0 <= y <= y1 with y1 >= |y0|, at `height`."""

    def __init__(self, y0: np.ndarray, y1: np.ndarray, height: np.ndarray) -> None:
        self.y0, self.y1, self.height = y0, y1, height
        self.height2 = height * height
        self.q0, self.q1 = y0 * y0 + self.height2, y1 * y1 + self.height2
        self.product = y0 * y1
        self.size = np.abs(self.product)
        self.twice_positive = self.product + self.size
        self.determinant = (y1 - y0) * height

    def edge(self, x: np.ndarray) -> _Edge:
        """The edge at `x`."""
        x2 = x * x
        squares = x2 + self.q0
        r0, r1 = np.sqrt(squares), np.sqrt(x2 + self.q1)
        # r0 r1 + y0 y1 cancels where y0 < 0; the difference of the squares does not.
        squares += self.q1
        squares -= self.height2
        x2 += self.height2
        squares *= x2
        d = r0 * r1
        d += self.size
        np.divide(squares, d, out=d)  # r0 r1 - |y0 y1|
        d += self.twice_positive
        d += x2
        np.add(r0, r1, out=x2)
        x2 *= x
        d += x2
        return _Edge(x, r0, r1, d)

    def half_angle(self, near: _Edge, far: _Edge) -> np.ndarray:
        """Half the solid angle between two edges, as the argument of a product of complex numbers."""
        far0 = far.x + far.r0
        near1 = near.x + near.r1
        width = far.x - near.x
        middle = far.x + near.x
        # d(far) - d(near) by the differences of x + r0 and of x + r1, both positive.
        sine = middle / (far.r1 + near.r1)
        sine += 1.0
        sine *= far0
        middle /= far.r0 + near.r0
        middle += 1.0
        middle *= near1
        sine += middle
        sine *= width
        sine *= self.determinant
        cosine = near.d * far.d
        cosine += self.determinant * self.determinant
        return np.arctan2(sine, cosine)


class SphericalRectangle:
    """Rectangles seen from the origin.

    Their bounds and `height` > 0 are all (n,); `solid_angle` (n,) is in steradians.
    """

    def __init__(self, x0: np.ndarray, x1: np.ndarray, y0: np.ndarray, y1: np.ndarray, height: np.ndarray) -> None:
        self._bounds = x0, x1, y0, y1
        self._strip = _Strip(np.maximum(y0, -y1), np.maximum(y1, -y0), height)
        near = np.maximum(x0, -x1)
        self._far = self._strip.edge(np.maximum(x1, -x0))
        inner = self._strip.edge(np.clip(near, 0.0, np.inf))
        half = self._strip.half_angle(inner, self._far)
        # The part at x < 0 is measured on its own.
        self._across = np.flatnonzero(near < 0.0)
        if self._across.size:
            lengths = (self._strip.y0, self._strip.y1, height)
            strip = _Strip(*(gather(length, self._across) for length in lengths))
            self._behind = strip.edge(-gather(near, self._across))
            foot = _Edge(*(gather(part, self._across) for part in inner))
            self._half_behind = strip.half_angle(foot, self._behind)
            half[self._across] += self._half_behind
        self._half = half
        self.solid_angle = 2.0 * half

    def place(self, u1: np.ndarray, u2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Sample a place (x, y), uniform in solid angle: x by u1, y by u2.

        The uniforms are in [0, 1). Urena et al. 2013, section 4.
        """
        x0, x1, y0, y1 = self._bounds
        x = self._x(u1)
        x *= np.copysign(1.0, x0 + x1)
        np.minimum(np.maximum(x, x0, out=x), x1, out=x)
        y = self._y(x, u2)
        y *= np.copysign(1.0, y0 + y1)
        return x, np.minimum(np.maximum(y, y0, out=y), y1, out=y)

    def _x(self, u1: np.ndarray) -> np.ndarray:
        """Where, mirrored, the part u1 of the solid angle lies below x.

        With psi half the solid angle of the strip beyond |x| and t = tan psi, Urena's x = height c / sqrt(1 - c^2) becomes, by products of
        sines for the differences of cosines in 1 - c^2,

            x / height = (n (1 - t^2) - 2 m t) / (2 sqrt(t (n - m t) (height + y1 t) (height - y0 t))),

        n = height (y1 - y0), m = height^2 + y0 y1.
        """
        strip = self._strip
        n, d = strip.determinant, self._far.d
        beyond = (1.0 - u1) * self._half
        behind = np.empty(0, np.intp)
        if self._across.size:
            below = gather(u1, self._across) * gather(self._half, self._across)
            chosen = np.flatnonzero(below < self._half_behind)
            behind = self._across[chosen]
            beyond[behind] = below[chosen]
            d = d.copy()
            d[behind] = self._behind.d[chosen]
        part = np.tan(beyond)
        t = d * part
        t += n
        d = d - n * part
        t /= np.maximum(d, np.finfo(float).eps * n)
        m = strip.height2 + strip.product
        m *= t
        bottom = n - m
        bottom *= t
        bottom *= strip.height + strip.y1 * t
        bottom *= strip.height - strip.y0 * t
        x = 1.0 - t * t
        x *= n
        m *= 2.0
        x -= m
        np.maximum(x, 0.0, out=x)
        x *= strip.height
        np.sqrt(bottom, out=bottom)
        bottom *= 2.0
        x /= bottom
        x[behind] *= -1.0
        return x

    def _y(self, x: np.ndarray, u2: np.ndarray) -> np.ndarray:
        """Return y such that h = y / r is uniform between the edges of the mirrored rectangle.

        y = h sqrt((x^2 + height^2) / (1 - h^2)).
        """
        strip = self._strip
        x2 = x * x
        x2 += strip.height2
        r0, r1 = np.sqrt(x2 + strip.y0 * strip.y0), np.sqrt(x2 + strip.y1 * strip.y1)
        rest = 1.0 - u2
        h0 = strip.y0 / r0
        y = strip.y1 / r1
        y *= u2
        y += h0 * rest
        # Of 1 - h and 1 + h the smaller keeps its digits, as such a sum of those at the edges: at y0 they are 1 - |h0|, to which
        # 2 |h0| is added on one side, at y1 > 0 `high` and 2 - high.
        low = np.abs(strip.y0)
        low += r0
        low *= r0
        np.divide(x2, low, out=low)
        high = strip.y1 + r1
        high *= r1
        np.divide(x2, high, out=high)
        over = np.abs(h0)
        other = h0 + over
        other += low
        over -= h0
        low += over
        low *= rest
        low += high * u2
        np.subtract(2.0, high, out=high)
        high *= u2
        other *= rest
        other += high
        np.minimum(low, other, out=low)
        low *= 2.0 - low
        x2 /= np.clip(low, np.finfo(float).tiny, np.inf, out=low)
        y *= np.sqrt(x2, out=x2)
        return y
