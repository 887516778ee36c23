# SPDX-License-Identifier: GPL-3.0-or-later
"""The solid angle of a rectangle, and places on it that are uniform in solid angle.

Urena, Fajardo and King 2013, "An area-preserving parametrization for spherical rectangles", rewritten with tangents of half
angles: their sum of four angles minus 2 pi has no digits left for a rectangle that is small, far, or seen edge on.
The rectangle is x0 <= x <= x1, y0 <= y <= y1 in a plane at `height` > 0 from the origin; all are (n,).
"""

from __future__ import annotations

import numpy as np


def half_angle_tangent(
    x0: np.ndarray, x1: np.ndarray, y0: np.ndarray, y1: np.ndarray, height: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Sine and cosine, up to a common positive factor, of half the solid angle.

    Each of the two triangles has tan(angle / 2) = det / (abc + (a.b) c + (b.c) a + (c.a) b) (van Oosterom and Strackee 1983, eq. 8), where the
    determinant is height times the area of the rectangle, exactly; the half angles add as complex numbers multiply.
    The sine has the sign of (x1 - x0) (y1 - y0).
    """
    height2 = height * height
    x00, y00 = x0 * x0 + height2, y0 * y0
    x11, y11 = x1 * x1 + height2, y1 * y1
    x01, y01 = x0 * x1 + height2, y0 * y1
    a, b = np.sqrt(x00 + y00), np.sqrt(x11 + y11)  # the corners on the diagonal that both triangles share
    c, d = np.sqrt(x11 + y00), np.sqrt(x00 + y11)
    ab = a * b
    ab += x01
    ab += y01
    first = ab * c
    first += (x01 + y00) * b
    first += (x11 + y01) * a
    second = ab * d
    second += (x00 + y01) * b
    second += (x01 + y11) * a
    determinant = x1 - x0
    determinant *= y1 - y0
    determinant *= height
    sine = first + second
    sine *= determinant
    first *= second
    determinant *= determinant
    first -= determinant
    return sine, first


def solid_angle(x0: np.ndarray, x1: np.ndarray, y0: np.ndarray, y1: np.ndarray, height: np.ndarray) -> np.ndarray:
    """Solid angle in steradians, (n,)."""
    angle = np.arctan2(*half_angle_tangent(x0, x1, y0, y1, height))
    angle *= 2.0
    return angle


def uniform_place(
    x0: np.ndarray,
    x1: np.ndarray,
    y0: np.ndarray,
    y1: np.ndarray,
    height: np.ndarray,
    solid: np.ndarray,
    u1: np.ndarray,
    u2: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Place (x, y) on the rectangle of solid angle `solid`, uniform in solid angle; Urena et al. 2013, section 4.

    x is where the part from x0 has the solid angle u1 solid. With b = y / sqrt(y^2 + height^2) and c = x / sqrt(x^2 + height^2) the
    part from 0 to x has the angle p = asin(c b1) - asin(c b0), hence c = sin p / sqrt(b0^2 + b1^2 - 2 b0 b1 cos p).
    """
    height2 = height * height
    sine, cosine = half_angle_tangent(np.zeros_like(x0), x0, y0, y1, height)
    part = np.tan((0.5 * u1) * solid)
    t = sine + part * cosine  # tan(p / 2), by the tangent of a sum
    t /= cosine - part * sine
    b0 = y0 / np.sqrt(y0 * y0 + height2)
    b1 = y1 / np.sqrt(y1 * y1 + height2)
    t2 = t * t
    # c^2 = 4 t^2 / ((1 + t^2) ((b1 - b0)^2 + t^2 (b1 + b0)^2)) = top / bottom
    bottom = b1 - b0
    b1 += b0
    bottom *= bottom
    b1 *= b1
    b1 *= t2
    bottom += b1
    t2 += 1.0
    bottom *= t2
    t += t
    bottom -= t * t
    np.maximum(bottom, np.finfo(float).tiny, out=bottom)
    x = t / np.sqrt(bottom)
    x *= height
    np.minimum(np.maximum(x, x0, out=x), x1, out=x)
    distance2 = x * x
    distance2 += height2
    low = y0 / np.sqrt(distance2 + y0 * y0)
    sine_y = y1 / np.sqrt(distance2 + y1 * y1)
    sine_y -= low
    sine_y *= u2
    sine_y += low
    cos2 = 1.0 - sine_y * sine_y
    np.maximum(cos2, np.finfo(float).tiny, out=cos2)
    distance2 /= cos2
    y = sine_y * np.sqrt(distance2)
    return x, np.minimum(np.maximum(y, y0, out=y), y1, out=y)
