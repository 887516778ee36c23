# SPDX-License-Identifier: GPL-3.0-or-later
# pyright: reportAttributeAccessIssue=false, reportArgumentType=false, reportReturnType=false
# mpmath's own types lack functions that it adds when it is imported, and take every real result for a complex one.
"""The truth of the inversions: from uniforms to directions, in mpmath's arithmetic.

See exact.py.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from mpmath import mp, mpf
from scipy.special import erfcinv

from .exact import Values, ggx_bound, rectangle


def _circle(u: mpf) -> tuple[mpf, mpf]:
    return mp.cospi(2 * u), mp.sinpi(2 * u)


def _normal(x: mpf, y: mpf) -> Values:
    z = 1 / mp.sqrt(1 + x * x + y * y)
    return x * z, y * z, z


def ggx_d_cos(ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
    """Angles theta = atan(alpha sqrt(u2 / (1 - u2))), phi = 2 pi u1, stretched."""
    c, s = _circle(u1)
    tangent = mp.sqrt(u2 / (1 - u2))
    return _normal(ax * tangent * c, ay * tangent * s)


def beckmann_d_cos(ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
    """Angles theta = atan(sqrt(-alpha^2 log(1 - u2))), phi = 2 pi u1, stretched."""
    c, s = _circle(u1)
    tangent = mp.sqrt(-mp.log(1 - u2))
    return _normal(ax * tangent * c, ay * tangent * s)


def student_d_cos(g: float) -> Callable[..., Values]:
    """The angles of a normal drawn from Student's D cos, stretched.

    theta = atan(alpha sqrt((g - 1) ((1 - u2)^(-1 / (g - 1)) - 1))), phi = 2 pi u1.
    """

    def d_cos(ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
        c, s = _circle(u1)
        k = mpf(g) - 1
        tangent = mp.sqrt(k * ((1 - u2) ** (-1 / k) - 1))
        return _normal(ax * tangent * c, ay * tangent * s)

    return d_cos


def ggx_bounded(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
    """Eto and Tokuyoshi 2023: the cap ends at -k z."""
    return _cap(x, y, z, ax, ay, u1, u2, ggx_bound(x, y, z, ax, ay)[0])


def ggx_visible(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
    """Dupuy and Benyoub 2023."""
    return _cap(x, y, z, ax, ay, u1, u2, mpf(1))


def _cap(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf, u1: mpf, u2: mpf, k: mpf) -> Values:
    x, y = x * ax, y * ay
    length = mp.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    cap = 1 - u2 * (1 + k * z)
    sine = mp.sqrt(max(1 - cap * cap, mpf(0)))
    c, s = _circle(u1)
    h = ((x + sine * c) * ax, (y + sine * s) * ay, z + cap)
    length = mp.sqrt(mp.fdot(h, h))
    return h[0] / length, h[1] / length, h[2] / length


@lru_cache(maxsize=64)
def visible_tangent(cot: mpf, u: mpf) -> mpf:
    """The x above which lies 1 - u of Beckmann's visible slopes at roughness 1.

    They are seen under `cot` = cos / sin. The root is found by Newton's method on their distribution, started from the
    right, where that is convex.
    """
    with mp.workdps(60):
        root = mp.sqrt(mp.pi)

        def above(x: mpf) -> mpf:
            return cot * root * mp.erfc(x) + mp.exp(-x * x)

        target = (1 - u) * above(-cot)
        x = _start(cot, u)
        for _ in range(200):
            step = (above(x) - target) / (2 * (cot + x) * mp.exp(-x * x))
            x = max(x + step, (x - cot) / 2)  # never past -cot, where the density ends
            if abs(step) <= abs(x) * mpf(10) ** -28:
                return x
    raise ArithmeticError(f"Newton's method has not settled at cot {cot}, u {u}")


def _start(cot: mpf, u: mpf) -> mpf:
    """Some x near the root, from the two ends of the views: grazing and normal incidence."""
    grazing = mp.sqrt(-mp.log(1 - u)) - cot
    if u < mpf("0.5"):
        # Mass below near -cot: (x + cot)^2 / 2 of the density's own slope there.
        whole = cot * mp.sqrt(mp.pi) * mp.erfc(-cot) + mp.exp(-cot * cot)
        rise = mp.sqrt(u * whole / mp.exp(-(min(cot, mpf(6)) ** 2)))
        tail = -mp.sqrt(max(-mp.log(2 * u), mpf(0)))
        return max(-cot + min(rise, mpf(1)), tail)
    return max(grazing, mp.sqrt(max(-mp.log(2 * (1 - u)), mpf(0))))


def beckmann_visible(x: mpf, y: mpf, z: mpf, ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
    """Heitz and d'Eon 2014; at normal incidence the azimuth is 0."""
    x, y = x * ax, y * ay
    sine = mp.sqrt(x * x + y * y)
    x, y = (x / sine, y / sine) if sine else (mpf(1), mpf(0))
    along = visible_tangent(z / max(sine, mpf(10) ** -150), u1)
    across = gaussian(u2)
    return _normal(ax * (x * along - y * across), ay * (y * along + x * across))


@lru_cache(maxsize=64)
def gaussian(u: mpf) -> mpf:
    """The inverse of (1 + erf) / 2, by Newton's method on its tail."""
    if u == mpf("0.5"):
        return mpf(0)
    tail = 2 * min(u, 1 - u)
    x = mpf(float(erfcinv(float(tail))))
    for _ in range(20):
        step = (mp.erfc(x) - tail) * mp.exp(x * x) * mp.sqrt(mp.pi) / 2
        x += step
        if abs(step) <= abs(x) * mpf(10) ** (-mp.dps // 2 - 5):
            return x if u > mpf("0.5") else -x
    raise ArithmeticError(f"Newton's method has not settled at {u}")


def cosine_hemisphere(u1: mpf, u2: mpf) -> Values:
    """Angles phi = 2 pi u1, theta = acos(sqrt(1 - u2))."""
    c, s = _circle(u1)
    return mp.sqrt(u2) * c, mp.sqrt(u2) * s, mp.sqrt(1 - u2)


def uniform_hemisphere(u1: mpf, u2: mpf) -> Values:
    """Angles phi = 2 pi u1, cos(theta) = 1 - u2."""
    c, s = _circle(u1)
    sine = mp.sqrt(1 - (1 - u2) ** 2)
    return sine * c, sine * s, 1 - u2


def uniform_cone(x: mpf, y: mpf, z: mpf, one_minus_cos: mpf, u1: mpf, u2: mpf) -> Values:
    """A direction about the axis (x, y, z), uniform in the cone.

    The frame is that of Duff et al. 2017, turned by pi below the horizon.
    """
    cosine = 1 - u2 * one_minus_cos
    sine = mp.sqrt(1 - cosine**2)
    c, s = (sine * v for v in _circle(u1))
    sign = 1 if z >= 0 else -1
    across = x * c + y * s
    along = cosine - across / (sign + z)
    return x * along + sign * c, y * along + sign * s, z * cosine - across


def rectangle_place(x0: mpf, x1: mpf, y0: mpf, y1: mpf, height: mpf, u1: mpf, u2: mpf) -> Values:
    """A place on a rectangle after Urena et al. 2013, section 4.

    Where the middle lies at a negative x or y, it is that of the mirrored rectangle, mirrored back.
    """
    flip_x, flip_y = x0 + x1 < 0, y0 + y1 < 0
    if flip_x:
        x0, x1 = -x1, -x0
    if flip_y:
        y0, y1 = -y1, -y0
    x = _cut(x0, x1, y0, y1, height, u1)
    d2 = x * x + height * height
    h0, h1 = y0 / mp.sqrt(d2 + y0 * y0), y1 / mp.sqrt(d2 + y1 * y1)
    h = h0 + u2 * (h1 - h0)
    y = h * mp.sqrt(d2 / (1 - h * h))
    return -x if flip_x else x, -y if flip_y else y


def _cut(x0: mpf, x1: mpf, y0: mpf, y1: mpf, height: mpf, u: mpf) -> mpf:
    """The x that leaves the part u of the rectangle's solid angle below it.

    Found by Newton's method.
    """

    def below(x: mpf) -> mpf:
        return rectangle(x0, x, y0, y1, height)[0]

    with mp.extradps(20):
        target = u * below(x1)
        x = x0 + u * (x1 - x0)
        low, high = x0, x1
        for _ in range(300):
            excess = below(x) - target
            low, high = (low, x) if excess > 0 else (x, high)
            d2 = x * x + height * height
            slope = height / d2 * (y1 / mp.sqrt(d2 + y1 * y1) - y0 / mp.sqrt(d2 + y0 * y0))
            following = x - excess / slope
            if not low <= following <= high:
                following = (low + high) / 2
            if abs(following - x) <= abs(x) * mpf(10) ** (60 - mp.dps):
                return following
            x = following
    raise ArithmeticError("Newton's method has not settled")
