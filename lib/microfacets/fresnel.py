# SPDX-License-Identifier: GPL-3.0-or-later
"""Unpolarised reflectance of an interface: exact forms, and two approximations.

The approximations are those that the documents name.
cos_i in [0, 1] is the cosine between the light and the (micro)normal. All arguments broadcast against each other.
"""

from __future__ import annotations

import numpy as np

_GRAZING = 1e-60
"""Stands for a cosine of zero: its fourth power still has a reciprocal."""


def dielectric(cos_i: np.ndarray, eta: float | np.ndarray) -> np.ndarray:
    """Exact Fresnel reflectance of a dielectric, in [0, 1].

    `eta` > 0 is the index beyond over the index on the light's side. Born and Wolf, sec. 1.5.2, eq. 21.
    """
    eta = np.asarray(eta, np.float64)
    return _interface(cos_i, eta * eta, (eta - 1.0) * (eta + 1.0))


def _interface(cos_i: np.ndarray, eta2: np.ndarray, contrast: np.ndarray) -> np.ndarray:
    """The dielectric's reflectance from `eta2` = eta^2 and `contrast` = eta^2 - 1.

    F = (r_s^2 + r_p^2) / 2 with g = sqrt(eta^2 - sin^2), r_s = (c - g) / (c + g) and r_p = (eta^2 c - g) / (eta^2 c + g). Both
    differences are multiplied out, so that they keep their digits where eta is near 1: r_s = -contrast / (c + g)^2 and
    r_p = contrast (eta^2 c^2 - sin^2) / (eta^2 c + g)^2. Above one half F is one less what passes,
    2 c g (1 / (c + g)^2 + eta^2 / (eta^2 c + g)^2): beyond the critical angle, where g = 0, nothing does.
    """
    c = np.maximum(cos_i, _GRAZING)
    sine2 = (1.0 - c) * (1.0 + c)
    g = np.sqrt(np.maximum(_refracted_squared(c, sine2, eta2, contrast), 0.0))
    s = 1.0 / np.square(c + g)
    p = 1.0 / np.square(eta2 * c + g)
    reflected = 0.5 * (np.square(contrast * s) + np.square((eta2 * c * c - sine2) * contrast * p))
    return np.where(reflected > 0.5, 1.0 - 2.0 * c * g * (s + eta2 * p), reflected)


def _refracted_squared(c: np.ndarray, sine2: np.ndarray, eta2: np.ndarray, contrast: np.ndarray) -> np.ndarray:
    """g^2 = eta^2 - sin^2 = contrast + c^2, negative beyond the critical angle.

    Of the two differences the one between the smaller numbers is taken.
    """
    return np.where(eta2 < 0.5, eta2 - sine2, contrast + c * c)


def rise_to_grazing(cos_i: np.ndarray, eta: float | np.ndarray) -> np.ndarray:
    """How far a dielectric's reflectance has risen from normal incidence to 1, at most 1.

    (F - F0) / (1 - F0), for `eta` > 0; a little below 0 where eta > 2 + sqrt(3), whose reflectance falls before it
    rises. The difference F - F0 keeps no digits near the normal, where it is of the order of sin^4. With g as for
    `dielectric`, d = g - eta c = contrast sin^2 / (eta c + g) and b = 4 eta^2 + 2 eta (eta^2 + 1) - (eta^2 + 1)^2, the
    sum of both polarisations has d^2 as a factor: d^2 (2 eta (g^2 + eta^2 c^2) + b c g) / (2 eta ((c + g)
    (eta^2 c + g))^2). Above one half it is one less the share of 1 - F0 = 4 eta / (1 + eta)^2 that passes.
    """
    eta = np.asarray(eta, np.float64)
    eta2, contrast = eta * eta, (eta - 1.0) * (eta + 1.0)
    c = np.maximum(cos_i, _GRAZING)
    sine2 = (1.0 - c) * (1.0 + c)
    g = np.sqrt(np.maximum(_refracted_squared(c, sine2, eta2, contrast), 0.0))
    s, p = 1.0 / np.square(c + g), 1.0 / np.square(eta2 * c + g)
    d = contrast * sine2 / (eta * c + g)
    b = 4.0 * eta2 + (2.0 * eta - eta2 - 1.0) * (eta2 + 1.0)
    rise = d * d * (2.0 * eta * (g * g + eta2 * c * c) + b * c * g) * s * p / (2.0 * eta)
    passed = c * g * (s + eta2 * p) * np.square(1.0 + eta) / (2.0 * eta)
    return np.where(rise > 0.5, 1.0 - passed, rise)


def conductor(cos_i: np.ndarray, eta: float | np.ndarray, k: float | np.ndarray) -> np.ndarray:
    """Exact Fresnel reflectance of a metal of index eta + i k, in [0, 1].

    The index is relative to that of the light's side; eta > 0, k >= 0.
    Born and Wolf, sec. 14.2, with a + i b = sqrt((eta + i k)^2 - sin^2):
    R_s = ((a - c)^2 + b^2) / ((a + c)^2 + b^2), R_p = R_s ((a c - s^2)^2 + b^2 c^2) / ((a c + s^2)^2 + b^2 c^2).
    """
    c = np.maximum(cos_i, _GRAZING)
    sine2 = (1.0 - c) * (1.0 + c)
    eta, k = np.asarray(eta, np.float64), np.asarray(k, np.float64)
    # The real part of (a + i b)^2: next to the critical angle of a metal that hardly absorbs it is a small difference.
    real = _refracted_squared(c, sine2 + k * k, eta * eta, (eta - 1.0) * (eta + 1.0) - k * k)
    larger = np.sqrt(0.5 * (np.abs(real) + np.sqrt(real * real + np.square(2.0 * (eta * k)))))
    # The other root by its product with this one, a b = eta k: their difference would cancel for a good mirror.
    smaller = eta * k / np.maximum(larger, _GRAZING)
    forward = real >= 0.0
    a, b2 = np.where(forward, larger, smaller), np.square(np.where(forward, smaller, larger))
    s = (np.square(a - c) + b2) / (np.square(a + c) + b2)
    ac, b2c2 = a * c, b2 * (c * c)
    p = s * (np.square(ac - sine2) + b2c2) / (np.square(ac + sine2) + b2c2)
    return 0.5 * (s + p)


def schlick(cos_i: np.ndarray, f0: float | np.ndarray) -> np.ndarray:
    """F0 + (1 - F0) (1 - cos)^5, an approximation (Schlick 1994, eq. 15).

    `f0` in [0, 1] is the reflectance at normal incidence.
    """
    x = 1.0 - cos_i
    x2 = x * x
    f0 = np.asarray(f0, np.float64)
    return f0 + (1.0 - f0) * (x2 * x2 * x)


def cook_torrance(cos_i: np.ndarray, f0: float | np.ndarray) -> np.ndarray:
    """The exact dielectric whose index gives `f0` in [0, 1] at normal incidence.

    The index is (1 + sqrt(F0)) / (1 - sqrt(F0)).
    Cook and Torrance 1982 use it for metals too, colour by colour: an approximation that leaves k out.
    """
    root = np.sqrt(np.asarray(f0, np.float64))
    below = np.maximum(1.0 - root, 2.0**-53)
    return _interface(cos_i, np.square((1.0 + root) / below), 4.0 * root / np.square(below))
