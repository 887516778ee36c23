# SPDX-License-Identifier: GPL-3.0-or-later
# pyright: reportAttributeAccessIssue=false, reportArgumentType=false, reportReturnType=false
# mpmath's own types lack functions that it adds when it is imported, and take every real result for a complex one.
"""The truth: closed forms from their definitions, in mpmath's arithmetic.

It has as many digits as are set when they are called. Arguments are numbers of mpmath; every function returns a tuple
of components. Nothing here is arranged against cancellation: the digits make up for it.
"""

from __future__ import annotations

from collections.abc import Callable

from mpmath import mp, mpc, mpf

Values = tuple[mpf, ...]


def _stretched(x: mpf, y: mpf, ax: mpf, ay: mpf) -> mpf:
    return (x * ax) ** 2 + (y * ay) ** 2


def ggx_density(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
    """Walter et al. 2007, eq. 33, both axes."""
    return (1 / (mp.pi * ax * ay * (_stretched(x, y, 1 / ax, 1 / ay) + z * z) ** 2),)


def beckmann_density(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
    """Walter et al. 2007, eq. 25, both axes."""
    return (mp.exp(-_stretched(x, y, 1 / ax, 1 / ay) / z**2) / (mp.pi * ax * ay * z**4),)


def ggx_lambda(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
    """Heitz 2014, eq. 72."""
    return ((mp.sqrt(1 + _stretched(x, y, ax, ay) / z**2) - 1) / 2,)


def student_density(g: float) -> Callable[..., Values]:
    """Ribardiere et al. 2017, both axes, of one shape."""

    def density(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
        s = _stretched(x, y, 1 / ax, 1 / ay) / z**2
        return ((1 + s / (mpf(g) - 1)) ** -mpf(g) / (mp.pi * ax * ay * z**4),)

    return density


def gamma_density(p: float, shift: float) -> Callable[..., Values]:
    """Bagher, Soler and Holzschuch 2012, both axes.

    exp(-q) q^-p of q = shift + s, normalised by an incomplete gamma function.
    """

    def density(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
        q = mpf(shift) + _stretched(x, y, 1 / ax, 1 / ay) / z**2
        return (mp.exp(-q) * q ** -mpf(p) / (mp.pi * mp.gammainc(1 - mpf(p), shift) * ax * ay * z**4),)

    return density


def exponential_density(b: float) -> Callable[..., Values]:
    """exp(-s^b) / (pi Gamma(1 + 1 / b)), both axes."""

    def density(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
        s = _stretched(x, y, 1 / ax, 1 / ay) / z**2
        return (mp.exp(-(s ** mpf(b))) / (mp.pi * mp.gamma(1 + 1 / mpf(b)) * ax * ay * z**4),)

    return density


def beckmann_lambda(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
    """Heitz 2014, eq. 66; 0 where the surface shows no slope."""
    stretched = _stretched(x, y, ax, ay)
    if not stretched:
        return (mpf(0),)
    a = z / mp.sqrt(stretched)
    # The difference keeps 1 / (2 a^2) of its terms, which themselves are less than any double beyond a = 28.
    return ((mp.exp(-a * a) / (a * mp.sqrt(mp.pi)) - mp.erfc(a)) / 2 if a < 1000 else mpf(0),)


def beckmann_lambda_rational(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
    """Walter et al. 2007, eq. 27, with Cycles' bound."""
    s = _stretched(x, y, ax, ay) / z**2
    if s <= mpf("0.39"):
        return (mpf(0),)
    a = 1 / mp.sqrt(s)
    return ((1 - mpf("1.259") * a + mpf("0.396") * a * a) / (mpf("3.535") * a + mpf("2.181") * a * a),)


def ggx_bound(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf) -> Values:
    """Eto and Tokuyoshi 2023, eq. 5 and 6."""
    a2, s2 = min(ax, ay) ** 2, (1 + mp.sqrt(x * x + y * y)) ** 2
    return ((1 - a2) * s2 / (s2 + a2 * z * z),)


def _glossy(density: Callable[..., Values], smith: Callable[..., Values], w: Values) -> Values:
    wi, wo, ax, ay = w[:3], w[3:6], w[6], w[7]
    m = [a + b for a, b in zip(wi, wo, strict=True)]
    length = mp.sqrt(mp.fdot(m, m))
    d = density(*(c / length for c in m), ax, ay)[0]
    return (d / (4 * wo[2] * (1 + smith(*wi, ax, ay)[0] + smith(*wo, ax, ay)[0])),)


def ggx_glossy(*w: mpf) -> Values:
    """D G / (4 |o.n|) of wi, wo and both alphas, height-correlated.

    It is a glossy lobe times its cosine.
    """
    return _glossy(ggx_density, ggx_lambda, w)


def beckmann_glossy(*w: mpf) -> Values:
    """The same for Beckmann."""
    return _glossy(beckmann_density, beckmann_lambda, w)


def torrance_sparrow(*w: mpf) -> Values:
    """The documents' G of wi, wo and m, three components each."""
    wi, wo, m = w[:3], w[3:6], w[6:]
    cos_im, cos_om = mp.fdot(wi, m), mp.fdot(wo, m)
    if min(cos_im, cos_om) <= 0:
        return (mpf(0),)
    return (max(mpf(0), min(mpf(1), 2 * m[2] * wo[2] / cos_om, 2 * m[2] * wi[2] / cos_im)),)


def separable(lambda_i: mpf, lambda_o: mpf) -> Values:
    """G1 G1."""
    return (1 / ((1 + lambda_i) * (1 + lambda_o)),)


def height_correlated(lambda_i: mpf, lambda_o: mpf) -> Values:
    """Heitz 2014, eq. 99."""
    return (1 / (1 + lambda_i + lambda_o),)


def _amplitudes(c: mpf, index: mpf | mpc) -> mpf:
    """Mean of |r_s|^2 and |r_p|^2.

    The refracted cosine comes from Snell's law and is complex where it must be.
    """
    refracted = mp.sqrt(mpc(1 - (1 - c * c) / index**2))
    s = (c - index * refracted) / (c + index * refracted)
    p = (index * c - refracted) / (index * c + refracted)
    return (abs(s) ** 2 + abs(p) ** 2) / 2


def dielectric(c: mpf, eta: mpf) -> Values:
    """Fresnel's equations."""
    return (_amplitudes(c, eta),)


def conductor(c: mpf, eta: mpf, k: mpf) -> Values:
    """Fresnel's equations with a complex index."""
    return (_amplitudes(c, mpc(eta, k)),)


def schlick(c: mpf, f0: mpf) -> Values:
    """Schlick 1994, eq. 15."""
    return (f0 + (1 - f0) * (1 - c) ** 5,)


def cook_torrance(c: mpf, f0: mpf) -> Values:
    """The dielectric whose index gives f0."""
    return (_amplitudes(c, (1 + mp.sqrt(f0)) / (1 - mp.sqrt(f0))) if f0 < 1 else mpf(1),)


def f82(c: mpf, f0: mpf, tint: mpf) -> Values:
    """Kutz, Hasan and Edmondson 2021, eq. 2."""
    seventh = mpf(float(1.0 / 7.0))
    b = schlick(seventh, f0)[0] * (1 - tint) / (seventh * (1 - seventh) ** 6)
    return (min(max(f0 + (1 - f0) * (1 - c) ** 5 - b * c * (1 - c) ** 6, mpf(0)), mpf(1)),)


def pdf_visible(*a: mpf) -> Values:
    """G1 (o.m) D / (o.n) of m, wo, D and Lambda(o)."""
    m, wo, d, lambda_o = a[:3], a[3:6], a[6], a[7]
    return (max(mpf(0), mp.fdot(m, wo)) * d / ((1 + lambda_o) * wo[2]),)


def reflection_jacobian(*w: mpf) -> Values:
    """1 / (4 |o.m|)."""
    return (1 / (4 * abs(mp.fdot(w[:3], w[3:]))),)


def power_heuristic(p: mpf, q: mpf) -> Values:
    """Veach 1997, eq. 9.14."""
    return (p * p / (p * p + q * q),)


def rectangle(x0: mpf, x1: mpf, y0: mpf, y1: mpf, height: mpf) -> Values:
    """Solid angle of a rectangle from the origin, corner by corner."""

    def corner(x: mpf, y: mpf) -> mpf:
        return mp.atan(x * y / (height * mp.sqrt(x * x + y * y + height * height)))

    return (corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0),)


def sphere_density(x: mpf, y: mpf, z: mpf, radius: mpf) -> Values:
    """1 / (2 pi (1 - cos)) for a sphere about (x, y, z); 1 / (4 pi) from inside."""
    squared = x * x + y * y + z * z
    cosine = mp.sqrt(1 - radius**2 / squared) if squared > radius**2 else mpf(-1)
    return (1 / (2 * mp.pi * (1 - cosine)),)


def sun_density(half_angle: mpf) -> Values:
    """1 / (2 pi (1 - cos)) of a cone."""
    return (1 / (2 * mp.pi * (1 - mp.cos(half_angle))),)


def spread(spread_angle: mpf) -> Values:
    """The factor tan h / (tan h - h), with h half the spread.

    It says how much brighter the light is along its axis.
    """
    h = spread_angle / 2
    return (mp.tan(h) / (mp.tan(h) - h),)
