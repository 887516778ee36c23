# SPDX-License-Identifier: GPL-3.0-or-later
"""The same equations in float32 as the documents print them.

A reader of the documents would write them down so. They take rows of arguments, (k, n). The documents give the
isotropic forms in theta; with both axes apart tan^2 theta / alpha^2 becomes
tan^2 theta (cos^2 phi / alpha_x^2 + sin^2 phi / alpha_y^2) (Heitz 2014, eq. 81). The angle is known by its cosine, as a
renderer knows it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.special import erf

ONE, TWO, FOUR, HALF = (np.float32(v) for v in (1.0, 2.0, 4.0, 0.5))
PI = np.float32(np.pi)


def _tan2(z: np.ndarray) -> np.ndarray:
    return (ONE - z * z) / (z * z)


def _azimuth(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """cos^2 and sin^2 of phi."""
    sine2 = ONE - z * z
    return np.where(sine2 > 0, x * x / sine2, ONE), np.where(sine2 > 0, y * y / sine2, np.float32(0.0))


def ggx_density(a: np.ndarray) -> np.ndarray:
    """alpha^2 / (pi cos^4 (alpha^2 + tan^2)^2)."""
    x, y, z, ax, ay = a
    cos2, sin2 = _azimuth(x, y, z)
    stretched = _tan2(z) * (cos2 / (ax * ax) + sin2 / (ay * ay))
    return ONE / (PI * ax * ay * z**4 * (ONE + stretched) ** 2)


def beckmann_density(a: np.ndarray) -> np.ndarray:
    """exp(-tan^2 / alpha^2) / (pi alpha^2 cos^4)."""
    x, y, z, ax, ay = a
    cos2, sin2 = _azimuth(x, y, z)
    return np.exp(-_tan2(z) * (cos2 / (ax * ax) + sin2 / (ay * ay))) / (PI * ax * ay * z**4)


def _squared_slope(a: np.ndarray) -> np.ndarray:
    x, y, z, ax, ay = a
    cos2, sin2 = _azimuth(x, y, z)
    return _tan2(z) * (cos2 * ax * ax + sin2 * ay * ay)


def ggx_lambda(a: np.ndarray) -> np.ndarray:
    """(-1 + sqrt(1 + alpha^2 tan^2)) / 2."""
    return (np.sqrt(ONE + _squared_slope(a)) - ONE) / TWO


def beckmann_lambda(a: np.ndarray) -> np.ndarray:
    """(erf(a) - 1) / 2 + exp(-a^2) / (2 a sqrt(pi))."""
    cot = ONE / np.sqrt(_squared_slope(a))
    return (erf(cot) - ONE) / TWO + np.exp(-cot * cot) / (TWO * cot * np.sqrt(PI))


def _glossy(a: np.ndarray, density: Callable, smith: Callable) -> np.ndarray:
    wi, wo, alphas = a[:3], a[3:6], a[6:]
    m = (wi + wo) / np.sqrt(((wi + wo) ** 2).sum(axis=0))
    g = ONE / (ONE + smith(np.concatenate([wi, alphas])) + smith(np.concatenate([wo, alphas])))
    return density(np.concatenate([m, alphas])) * g / (FOUR * np.abs(wo[2]) * np.abs(wi[2])) * np.abs(wi[2])


def ggx_glossy(a: np.ndarray) -> np.ndarray:
    """D G / (4 |o.n| |i.n|), times |i.n| for the estimator."""
    return _glossy(a, ggx_density, ggx_lambda)


def beckmann_glossy(a: np.ndarray) -> np.ndarray:
    """The same."""
    return _glossy(a, beckmann_density, beckmann_lambda)


def torrance_sparrow(a: np.ndarray) -> np.ndarray:
    """min{1, 2 (n.m)(n.o) / (o.m), 2 (n.m)(n.i) / (i.m)}."""
    wi, wo, m = a[:3], a[3:6], a[6:]
    return np.minimum(
        ONE, np.minimum(TWO * m[2] * wo[2] / (wo * m).sum(axis=0), TWO * m[2] * wi[2] / (wi * m).sum(axis=0))
    )


def separable(a: np.ndarray) -> np.ndarray:
    """G1 G1."""
    return ONE / (ONE + a[0]) * (ONE / (ONE + a[1]))


def height_correlated(a: np.ndarray) -> np.ndarray:
    """1 / (1 + Lambda + Lambda)."""
    return ONE / (ONE + a[0] + a[1])


def dielectric(a: np.ndarray) -> np.ndarray:
    """Both polarisations with Snell's cosine; 1 where it has no root."""
    c, eta = a
    sine2 = (ONE - c * c) / (eta * eta)
    t = np.sqrt(np.maximum(ONE - sine2, np.float32(0.0)))
    s = (c - eta * t) / (c + eta * t)
    p = (eta * c - t) / (eta * c + t)
    return np.where(sine2 >= ONE, ONE, HALF * (s * s + p * p))


def conductor(a: np.ndarray) -> np.ndarray:
    """The exact form with a^2 + b^2 as usually printed (Cook and Torrance 1982, appendix)."""
    c, n, k = a
    sine2 = ONE - c * c
    difference = n * n - k * k - sine2
    length = np.sqrt(difference * difference + FOUR * n * n * k * k)
    u = np.sqrt(HALF * (length + difference))
    s = (length + c * c - TWO * u * c) / (length + c * c + TWO * u * c)
    p = (
        s
        * (c * c * length + sine2 * sine2 - TWO * u * c * sine2)
        / (c * c * length + sine2 * sine2 + TWO * u * c * sine2)
    )
    return HALF * (s + p)


def schlick(a: np.ndarray) -> np.ndarray:
    """F0 + (1 - F0) (1 - cos)^5."""
    return a[1] + (ONE - a[1]) * (ONE - a[0]) ** 5


def cook_torrance(a: np.ndarray) -> np.ndarray:
    """(g - c)^2 / (g + c)^2 (1 + (c (g + c) - 1)^2 / (c (g - c) + 1)^2) / 2."""
    c, f0 = a
    n = (ONE + np.sqrt(f0)) / (ONE - np.sqrt(f0))
    g = np.sqrt(n * n + c * c - ONE)
    return HALF * ((g - c) / (g + c)) ** 2 * (ONE + ((c * (g + c) - ONE) / (c * (g - c) + ONE)) ** 2)


def pdf_visible(a: np.ndarray) -> np.ndarray:
    """G1 (o.m) D / (o.n)."""
    m, wo, d, lambda_o = a[:3], a[3:6], a[6], a[7]
    return ONE / (ONE + lambda_o) * np.maximum((m * wo).sum(axis=0), np.float32(0.0)) * d / wo[2]


def reflection_jacobian(a: np.ndarray) -> np.ndarray:
    """1 / (4 |o.m|)."""
    return ONE / (FOUR * np.abs((a[:3] * a[3:]).sum(axis=0)))


def power_heuristic(a: np.ndarray) -> np.ndarray:
    """p^2 / (p^2 + q^2)."""
    return a[0] * a[0] / (a[0] * a[0] + a[1] * a[1])


def rectangle(a: np.ndarray) -> np.ndarray:
    """Urena et al. 2013: the sum of four angles less 2 pi."""
    x0, x1, y0, y1, height = a
    z = -height
    n = [v / np.sqrt(z * z + v * v) for v in (-y0, x1, y1, -x0)]
    g = [np.arccos(-n[k] * n[(k + 1) % 4]) for k in range(4)]
    return g[0] + g[1] + g[2] + g[3] - TWO * PI


def sphere_density(a: np.ndarray) -> np.ndarray:
    """1 / (2 pi (1 - cos))."""
    squared = a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
    cosine = np.sqrt(ONE - a[3] * a[3] / squared)
    return np.where(squared > a[3] * a[3], ONE / (TWO * PI * (ONE - cosine)), ONE / (FOUR * PI))


def sun_density(a: np.ndarray) -> np.ndarray:
    """1 / (2 pi (1 - cos))."""
    return ONE / (TWO * PI * (ONE - np.cos(a[0])))


def spread(a: np.ndarray) -> np.ndarray:
    """The factor tan h / (tan h - h)."""
    h = a[0] / TWO
    return np.tan(h) / (np.tan(h) - h)


def _spherical(theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def ggx_d_cos(a: np.ndarray) -> np.ndarray:
    """Angles phi = 2 pi xi1, theta = atan(sigma sqrt(xi2 / (1 - xi2))), isotropic in alpha_x."""
    ax, _, u1, u2 = a
    return _spherical(np.arctan(ax * np.sqrt(u2 / (ONE - u2))), TWO * PI * u1)


def beckmann_d_cos(a: np.ndarray) -> np.ndarray:
    """Angles phi = 2 pi xi1, theta = atan(sqrt(-sigma^2 log(1 - xi2))), isotropic in alpha_x."""
    ax, _, u1, u2 = a
    return _spherical(np.arctan(np.sqrt(-(ax * ax) * np.log(ONE - u2))), TWO * PI * u1)


def cosine_hemisphere(a: np.ndarray) -> np.ndarray:
    """Angles phi = 2 pi xi1, theta = acos(sqrt(1 - xi2))."""
    return _spherical(np.arccos(np.sqrt(ONE - a[1])), TWO * PI * a[0])


def uniform_hemisphere(a: np.ndarray) -> np.ndarray:
    """Angles phi = 2 pi xi1, theta = acos(1 - xi2)."""
    return _spherical(np.arccos(ONE - a[1]), TWO * PI * a[0])
