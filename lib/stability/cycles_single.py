# SPDX-License-Identifier: GPL-3.0-or-later
"""The same equations in float32 arranged as Cycles arranges them.

They take rows of arguments, (k, n), and each names the file that was read. Isotropic lobes take Cycles' isotropic form,
which knows the microfacet normal by its cosine alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .single import HALF, ONE, PI, TWO

ZERO = np.float32(0.0)


def _density(a: np.ndarray, isotropic: np.ndarray, stretched: np.ndarray) -> np.ndarray:
    return np.where(a[3] == a[4], isotropic, stretched)


def ggx_density(a: np.ndarray) -> np.ndarray:
    """kernel/closure/bsdf_microfacet.h: the density of GGX.

    It is computed from 1 - cos^2 where both alphas are one, else from the stretched normal.
    """
    x, y, z, ax, ay = a
    cos2, alpha2 = np.minimum(z * z, ONE), ax * ay
    isotropic = alpha2 / (PI * np.square((ONE - cos2) + alpha2 * cos2))
    hx, hy = x / ax, y / ay
    return _density(a, isotropic, (ONE / PI) / (alpha2 * np.square(hx * hx + hy * hy + z * z)))


def beckmann_density(a: np.ndarray) -> np.ndarray:
    """kernel/closure/bsdf_microfacet.h, likewise."""
    x, y, z, ax, ay = a
    cos2, alpha2 = np.minimum(z * z, ONE), ax * ay
    isotropic = ONE / (np.exp((ONE - cos2) / (cos2 * alpha2)) * PI * alpha2 * (cos2 * cos2))
    hx, hy = x / ax, y / ay
    stretched = np.exp(-(hx * hx + hy * hy) / (z * z)) / (PI * alpha2 * np.square(z * z))
    return _density(a, isotropic, stretched)


def _squared_slope(a: np.ndarray) -> np.ndarray:
    x, y, z, ax, ay = a
    isotropic = ax * ay * np.maximum(ONE / (z * z) - ONE, ZERO)
    return np.where(ax == ay, isotropic, (np.square(ax * x) + np.square(ay * y)) / (z * z))


def ggx_lambda(a: np.ndarray) -> np.ndarray:
    """kernel/closure/bsdf_microfacet.h: half of sqrt(1 + s) - 1."""
    return HALF * (np.sqrt(ONE + _squared_slope(a)) - ONE)


def beckmann_lambda(a: np.ndarray) -> np.ndarray:
    """kernel/closure/bsdf_microfacet.h: the rational fit, 0 below s = 0.39."""
    s = _squared_slope(a)
    v = ONE / np.sqrt(s)
    fit = ((np.float32(0.396) * v - np.float32(1.259)) * v + ONE) / ((np.float32(2.181) * v + np.float32(3.535)) * v)
    return np.where(s < np.float32(0.39), ZERO, fit)


def _glossy(a: np.ndarray, density: Callable, smith: Callable) -> np.ndarray:
    wi, wo, alphas = a[:3], a[3:6], a[6:]
    m = wi + wo
    m = m * (ONE / np.sqrt((m * m).sum(axis=0)))
    common = density(np.concatenate([m, alphas])) / wo[2] * (HALF * HALF)
    return common / (ONE + smith(np.concatenate([wi, alphas])) + smith(np.concatenate([wo, alphas])))


def ggx_glossy(a: np.ndarray) -> np.ndarray:
    """kernel/closure/bsdf_microfacet.h, bsdf_microfacet_eval."""
    return _glossy(a, ggx_density, ggx_lambda)


def beckmann_glossy(a: np.ndarray) -> np.ndarray:
    """The same, with the rational Lambda."""
    return _glossy(a, beckmann_density, beckmann_lambda)


def f82(a: np.ndarray) -> np.ndarray:
    """kernel/closure/bsdf_util.h: mix(mix(F0, 1, m^5) - B c m^6)."""
    c, f0, tint = a
    edge = np.float32(6.0 / 7.0)
    at_edge = f0 + (ONE - f0) * edge**5
    b = at_edge * (np.float32(7.0) / edge**6) * (ONE - tint)
    m = ONE - c
    m5 = (m * m) * (m * m) * m
    return np.clip(f0 + (ONE - f0) * m5 - b * c * (m5 * m), ZERO, ONE)


def dielectric(a: np.ndarray) -> np.ndarray:
    """kernel/closure/bsdf_util.h: the dielectric's Fresnel reflectance.

    It takes the amplitudes of both polarisations, with Snell's cosine from eta^2 - (1 - cos^2).
    """
    c, eta = a
    root = eta * eta - (ONE - c * c)
    t = np.sqrt(np.maximum(root, ZERO)) / eta
    s = (c - eta * t) / (c + eta * t)
    p = (eta * c - t) / (eta * c + t)
    return np.where(root <= 0, ONE, (s * s + p * p) * HALF)


def conductor(a: np.ndarray) -> np.ndarray:
    """kernel/closure/bsdf_util.h: both roots as halves of a sum and of a difference."""
    c, n, k = a
    t1 = n * n - k * k - (ONE - c * c)
    twice = TWO * n * k
    t2 = np.sqrt(t1 * t1 + twice * twice)
    u2, v2 = np.maximum(HALF * (t2 + t1), ZERO), np.maximum(HALF * (t2 - t1), ZERO)
    u, v = np.sqrt(u2), np.sqrt(v2)
    s = (np.square(c - u) + v2) / (np.square(c + u) + v2)
    t3, t4 = (n * n - k * k) * c, twice * c
    p = (np.square(t3 - u) + np.square(t4 - v)) / (np.square(t3 + u) + np.square(t4 + v))
    return (s + p) * HALF


def rectangle(a: np.ndarray) -> np.ndarray:
    """kernel/light/area.h: the solid angle of a rectangle.

    It takes four arc sines, whose sum needs no 2 pi, or the area where the rectangle is small or seen edge on.
    """
    x0, x1, y0, y1, height = a
    n = [v / np.sqrt(v * v + height * height) for v in (-y0, x1, y1, -x0)]
    solid = -sum(np.arcsin(np.clip(-n[k] * n[(k + 1) % 4], -ONE, ONE)) for k in range(4))
    x, y = HALF * (x0 + x1), HALF * (y0 + y1)
    length = np.sqrt(x * x + y * y + height * height)
    flat = height * (x1 - x0) * (y1 - y0) / (length * length * length)
    edge_on = np.min([v * v for v in n], axis=0) > np.float32(0.99999)
    return np.where((solid < np.float32(1e-5)) | edge_on, flat, solid)


def _one_minus_cos(sine2: np.ndarray) -> np.ndarray:
    return np.where(sine2 > np.float32(0.0004), ONE - np.sqrt(np.maximum(ONE - sine2, ZERO)), HALF * sine2)


def sphere_density(a: np.ndarray) -> np.ndarray:
    """kernel/light/point.h: 1 - cos by half of sin^2 where that is below 0.0004."""
    squared, radius2 = a[0] * a[0] + a[1] * a[1] + a[2] * a[2], a[3] * a[3]
    outside = (HALF / PI) / _one_minus_cos(radius2 / squared)
    return np.where(squared > radius2, outside, HALF * HALF / PI)


def sun_density(a: np.ndarray) -> np.ndarray:
    """kernel/sample/mapping.h: 1 - cos by half of the angle's square below 0.02."""
    angle = a[0]
    return (HALF / PI) / np.where(angle > np.float32(0.02), ONE - np.cos(angle), HALF * angle * angle)


def spread(a: np.ndarray) -> np.ndarray:
    """scene/light.cpp: by 3 / h^3 below h = 0.05."""
    h = HALF * a[0]
    tangent = np.tan(h)
    return tangent * np.where(h > np.float32(0.05), ONE / (tangent - h), np.float32(3.0) / (h * h * h))
