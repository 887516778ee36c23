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
    (c - g) / (c + g) = (1 - eta^2) / (c + g)^2, which does not cancel where eta is near 1. Above one half F is one less what
    passes, 2 c g (1 / (c + g)^2 + eta^2 / (eta^2 c + g)^2): beyond the critical angle, where g = 0, nothing does.
    """
    eta = np.asarray(eta, np.float64)
    return _interface(cos_i, eta * eta, (eta - 1.0) * (eta + 1.0))


def _interface(cos_i: np.ndarray, eta2: np.ndarray, contrast: np.ndarray) -> np.ndarray:
    """The same by eta^2 and `contrast` = eta^2 - 1, which keeps its digits where the index is all but 1."""
    c = np.maximum(cos_i, _GRAZING)
    c2 = c * c
    sine2 = (1.0 - c) * (1.0 + c)
    # Of the two differences that are g^2 the one between the smaller numbers.
    g = np.where(eta2 < 0.5, eta2 - sine2, contrast + c2)
    np.maximum(g, 0.0, out=g)
    g = np.sqrt(g, out=g)
    s = c + g
    s *= s
    np.divide(1.0, s, out=s)
    p = eta2 * c
    p += g
    p *= p
    np.divide(1.0, p, out=p)
    passed = eta2 * p
    passed += s
    g *= c
    passed *= g
    passed *= -2.0
    passed += 1.0
    s *= contrast
    # c^2 (eta^2 + 1) - 1, which cancels at normal incidence where eta is small.
    c2 = c2 * eta2
    c2 -= sine2
    c2 *= contrast
    p *= c2
    s *= s
    p *= p
    s += p
    s *= 0.5
    return np.where(s > 0.5, passed, s)


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
    below = np.maximum(1.0 - root, 2.0**-53)
    return _interface(cos_i, np.square((1.0 + root) / below), 4.0 * root / np.square(below))
