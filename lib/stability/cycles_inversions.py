# SPDX-License-Identifier: GPL-3.0-or-later
# pyright: reportAttributeAccessIssue=false, reportArgumentType=false, reportReturnType=false
# mpmath's own types lack functions that it adds when it is imported, and take every real result for a complex one.
"""Cycles' visible normals in float32 as it computes them, and the truth of the same maps.

The source is kernel/closure/bsdf_microfacet.h. GGX is sampled after Heitz 2018 over a concentric disk; Beckmann after
Heitz and d'Eon 2014, by three steps of Newton's method at most over approximations of erf (Abramowitz and Stegun,
7.1.28) and its inverse (Giles 2010).
"""

from __future__ import annotations

import numpy as np
from mpmath import mp, mpf

from .exact import Values
from .exact_inversions import gaussian, visible_tangent
from .single import HALF, ONE, PI, TWO

ZERO = np.float32(0.0)
_NORMAL_INCIDENCE = np.float32(0.99999)
_CENTRE = (2.81022636e-08, 3.43273939e-07, -3.5233877e-06, -4.39150654e-06, 0.00021858087)
_CENTRE += (-0.00125372503, -0.00417768164, 0.246640727, 1.50140941)
_TAIL = (-0.000200214257, 0.000100950558, 0.00134934322, -0.00367342844, 0.00573950773)
_TAIL += (-0.0076224613, 0.00943887047, 1.00167406, 2.83297682)
_ERF = (0.0000430638, 0.0002765672, 0.0001520143, 0.0092705272, 0.0422820123, 0.0705230784, 1.0)


def _polynomial(coefficients: tuple[float, ...], x: np.ndarray) -> np.ndarray:
    value = np.full(x.shape, np.float32(coefficients[0]))
    for coefficient in coefficients[1:]:
        value = value * x + np.float32(coefficient)
    return value


def _erf(x: np.ndarray) -> np.ndarray:
    r = _polynomial(_ERF, np.abs(x))
    for _ in range(4):
        r = r * r
    return np.copysign(np.where(np.abs(x) >= np.float32(12.3), ONE, ONE - ONE / r), x)


def _erfinv(x: np.ndarray) -> np.ndarray:
    a = np.minimum(np.abs(x), np.float32(0.99999994))
    w = -np.log((ONE - a) * (ONE + a))
    centre, tail = _polynomial(_CENTRE, w - np.float32(2.5)), _polynomial(_TAIL, np.sqrt(w) - np.float32(3.0))
    return np.where(w < 5, centre, tail) * x


def _normalized(v: np.ndarray) -> np.ndarray:
    return v / np.sqrt((v * v).sum(axis=0))


def ggx_visible(a: np.ndarray) -> np.ndarray:
    """Heitz 2018: a disk warped to the projected hemisphere.

    The frame is about the stretched view.
    """
    x, y, z, ax, ay, u1, u2 = a
    view = _normalized(np.stack([x * ax, y * ay, z]))
    length2 = view[0] * view[0] + view[1] * view[1]
    usual = length2 > np.float32(1e-7)
    inverse = ONE / np.sqrt(np.where(usual, length2, ONE))
    first = np.where(usual, np.stack([-view[1] * inverse, view[0] * inverse, 0 * inverse]), [[ONE], [ZERO], [ZERO]])
    second = np.where(usual, np.cross(view, first, axis=0), [[ZERO], [ONE], [ZERO]])
    p, q = TWO * u1 - ONE, TWO * u2 - ONE
    wide = p * p > q * q
    quarter = PI / np.float32(4.0)
    radius = np.where(wide, p, q)
    phi = np.where(wide, quarter * (q / p), TWO * quarter - quarter * (p / q))
    t1, t2 = radius * np.cos(phi), radius * np.sin(phi)
    share = HALF * (ONE + view[2])
    t2 = np.sqrt(np.maximum(ONE - t1 * t1, ZERO)) * (ONE - share) + t2 * share
    t3 = np.sqrt(np.maximum(ONE - (t1 * t1 + t2 * t2), ZERO))
    h = t1 * first + t2 * second + t3 * view
    return _normalized(np.stack([ax * h[0], ay * h[1], np.maximum(h[2], ZERO)]))


def ggx_visible_truth(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
    """The same map."""
    x, y = x * ax, y * ay
    length = mp.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    across = mp.sqrt(x * x + y * y)
    first, second = ((mpf(1), mpf(0), mpf(0)), (mpf(0), mpf(1), mpf(0)))
    if across**2 > mpf("1e-7"):
        first = (-y / across, x / across, mpf(0))
        second = (-z * first[1], z * first[0], x * first[1] - y * first[0])
    p, q = 2 * u1 - 1, 2 * u2 - 1
    if p * p > q * q:
        t1, t2 = p * mp.cospi(q / p / 4), p * mp.sinpi(q / p / 4)
    else:
        turn = mpf("0.5") - (p / q / 4 if q else 0)
        t1, t2 = q * mp.cospi(turn), q * mp.sinpi(turn)
    t2 = (1 - z) / 2 * mp.sqrt(1 - t1 * t1) + (1 + z) / 2 * t2
    t3 = mp.sqrt(max(1 - t1 * t1 - t2 * t2, mpf(0)))
    h = [t1 * a + t2 * b + t3 * c for a, b, c in zip(first, second, (x, y, z), strict=True)]
    h = (ax * h[0], ay * h[1], max(h[2], mpf(0)))
    length = mp.sqrt(mp.fdot(h, h))
    return h[0] / length, h[1] / length, h[2] / length


def beckmann_visible(a: np.ndarray) -> np.ndarray:
    """Heitz and d'Eon 2014, the slope along the view by bracketed Newton steps in erf(slope)."""
    x, y, z, ax, ay, u1, u2 = a
    view = _normalized(np.stack([x * ax, y * ay, z]))
    sine = np.sqrt(np.maximum(ONE - view[2] * view[2], ZERO))
    tangent = sine / view[2]
    slope_x = _slope(tangent, u1)
    slope_y = _erfinv(TWO * u2 - ONE)
    cos_phi, sin_phi = view[0] / sine, view[1] / sine
    slopes = np.stack([cos_phi * slope_x - sin_phi * slope_y, sin_phi * slope_x + cos_phi * slope_y])
    radius, phi = np.sqrt(-np.log(u1)), TWO * PI * u2
    overhead = np.stack([radius * np.cos(phi), radius * np.sin(phi)])
    slopes = np.where(view[2] >= _NORMAL_INCIDENCE, overhead, slopes)
    return _normalized(np.stack([-slopes[0] * ax, -slopes[1] * ay, np.ones_like(ax)]))


def _slope(tangent: np.ndarray, u: np.ndarray) -> np.ndarray:
    cot = ONE / tangent
    erf_a = _erf(cot)
    k = tangent * np.float32(0.56418958354)
    whole = ONE + erf_a + k * np.exp(-cot * cot)
    guess = u * (ONE + erf_a + k * (ONE - erf_a * erf_a))
    target = u * whole
    b = np.where(k > 0, (HALF - np.sqrt(k * (k - guess + ONE) + HALF * HALF)) / k, guess - ONE)
    inverse = _erfinv(b)
    value = ONE + b + k * np.exp(-inverse * inverse) - target
    low, low_value, high = np.full_like(b, -ONE), -target, erf_a
    for _ in range(3):
        going = np.abs(value) > np.float32(1e-6)
        same = np.sign(low_value) == np.sign(value)
        low, low_value = np.where(going & same, b, low), np.where(going & same, value, low_value)
        high = np.where(going & ~same, b, high)
        newton = b - value / (ONE - inverse * tangent)
        following = np.where((newton >= low) & (newton <= high), newton, HALF * (low + high))
        b = np.where(going, following, b)
        inverse = np.where(going, _erfinv(b), inverse)
        value = np.where(going, ONE + b + k * np.exp(-inverse * inverse) - target, value)
    return inverse


def beckmann_visible_truth(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
    """The same map, its slope by the exact distribution."""
    x, y = x * ax, y * ay
    across = mp.sqrt(x * x + y * y)
    if z / mp.sqrt(across**2 + z * z) >= mpf(float(_NORMAL_INCIDENCE)):
        radius = mp.sqrt(-mp.log(u1))
        t = (-radius * mp.cospi(2 * u2), -radius * mp.sinpi(2 * u2))
    else:
        x, y = x / across, y / across
        along, other = visible_tangent(z / across, 1 - u1), gaussian(u2)
        t = (x * along + y * other, y * along - x * other)
    length = mp.sqrt(1 + (t[0] * ax) ** 2 + (t[1] * ay) ** 2)
    return t[0] * ax / length, t[1] * ay / length, 1 / length
