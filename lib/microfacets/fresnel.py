# SPDX-License-Identifier: GPL-3.0-or-later
"""Unpolarised reflectance of an interface: the exact forms, and the two approximations that the documents name.

cos_i in [0, 1] is the cosine between the light and the (micro)normal. All arguments broadcast against each other.
"""

from __future__ import annotations

import numpy as np

_GRAZING = 1e-60
"""Stands for a cosine of zero: its fourth power still has a reciprocal."""


def dielectric(cos_i: np.ndarray, eta: float | np.ndarray) -> np.ndarray:
    """Exact Fresnel reflectance of a dielectric, in [0, 1]; `eta` > 0 is the index beyond over the index on the light's side.

    Born and Wolf, sec. 1.5.2, eq. 21, with the differences multiplied out: with g = sqrt(eta^2 - 1 + c^2),
    (c - g) / (c + g) = (1 - eta^2) / (c + g)^2, which does not cancel where eta is near 1. Beyond the critical angle both
    ratios exceed 1 with g = 0, so that the bound 1 is the total reflection.
    """
    eta = np.asarray(eta, np.float64)
    contrast = (eta - 1.0) * (eta + 1.0)
    eta2 = eta * eta
    c = np.maximum(cos_i, _GRAZING)
    c2 = c * c
    g = np.maximum(contrast + c2, 0.0)
    g = np.sqrt(g, out=g)
    s = contrast / np.square(c + g)
    p = eta2 * c
    p += g
    p *= p
    c2 = c2 * (eta2 + 1.0)
    c2 -= 1.0
    c2 *= contrast
    np.divide(c2, p, out=p)
    s *= s
    p *= p
    f = np.minimum(s, 1.0)
    f += np.minimum(p, 1.0)
    f *= 0.5
    return f


def conductor(cos_i: np.ndarray, eta: float | np.ndarray, k: float | np.ndarray) -> np.ndarray:
    """Exact Fresnel reflectance of a metal of index eta + i k (over that of the light's side), eta > 0, k >= 0, in [0, 1].

    Born and Wolf, sec. 14.2, with a + i b = sqrt((eta + i k)^2 - sin^2):
    R_s = ((a - c)^2 + b^2) / ((a + c)^2 + b^2), R_p = R_s ((a c - s^2)^2 + b^2 c^2) / ((a c + s^2)^2 + b^2 c^2).
    """
    c = np.maximum(cos_i, _GRAZING)
    sine2 = (1.0 - c) * (1.0 + c)
    eta, k = np.asarray(eta, np.float64), np.asarray(k, np.float64)
    real = (eta - k) * (eta + k) - sine2
    imaginary = eta * k  # half of it
    larger = np.abs(real)
    larger += np.sqrt(real * real + np.square(2.0 * imaginary))
    larger *= 0.5
    larger = np.sqrt(larger, out=larger)
    # The other root by its product with this one: their difference would cancel for a good mirror.
    smaller = imaginary / np.maximum(larger, _GRAZING)
    forward = real >= 0.0
    a = np.where(forward, larger, smaller)
    b2 = np.square(np.where(forward, smaller, larger))
    s = np.square(a - c)
    s += b2
    s /= np.square(a + c) + b2
    a *= c
    b2 *= c * c
    p = np.square(a - sine2)
    p += b2
    p /= np.square(a + sine2) + b2
    p += 1.0
    p *= s
    p *= 0.5
    return p


def schlick(cos_i: np.ndarray, f0: float | np.ndarray) -> np.ndarray:
    """F0 + (1 - F0) (1 - cos)^5, an approximation (Schlick 1994, eq. 15); `f0` in [0, 1] is the reflectance at normal incidence."""
    x = 1.0 - cos_i
    x2 = x * x
    x2 *= x2
    x *= x2
    f = x * (1.0 - np.asarray(f0, np.float64))
    f += f0
    return f


def cook_torrance(cos_i: np.ndarray, f0: float | np.ndarray) -> np.ndarray:
    """The exact dielectric whose index gives `f0` at normal incidence, (1 + sqrt(F0)) / (1 - sqrt(F0)), `f0` in [0, 1].

    Cook and Torrance 1982 use it for metals too, colour by colour: an approximation that leaves k out.
    """
    root = np.sqrt(np.asarray(f0, np.float64))
    return dielectric(cos_i, (1.0 + root) / np.maximum(1.0 - root, 2.0**-53))
