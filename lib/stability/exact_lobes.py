# SPDX-License-Identifier: GPL-3.0-or-later
"""The truth of lobes and of the reflectances that they carry, in mpmath's arithmetic.

See exact.py.
"""

from __future__ import annotations

from mpmath import mp, mpf

from .exact import Values, dielectric


def tinted_dielectric(c: mpf, eta: mpf, f0: mpf) -> Values:
    """F0 + (1 - F0) times the rise of the dielectric's curve, clipped to [0, 1].

    Blender's Principled BSDF has this form.
    """
    normal = ((eta - 1) / (eta + 1)) ** 2
    rise = (dielectric(c, eta)[0] - normal) / (1 - normal)
    return (f0 + (1 - f0) * min(max(rise, mpf(0)), mpf(1)),)


def ashikhmin_shirley(*w: mpf) -> Values:
    """Ashikhmin and Shirley 2000, eq. 4, times |i.n|, of wi, wo and both alphas.

    h.o is half of |wi + wo|.
    """
    wi, wo = w[:3], w[3:6]
    nx, ny = (2 / alpha**2 - 2 for alpha in w[6:])
    half = [a + b for a, b in zip(wi, wo, strict=True)]
    length = mp.sqrt(mp.fdot(half, half))
    x, y, z = (component / length for component in half)
    sine2 = x * x + y * y
    e = (nx * x * x + ny * y * y) / sine2 if sine2 else mpf(0)
    value = mp.sqrt((nx + 1) * (ny + 1)) / (8 * mp.pi) * z**e / (length / 2 * max(wi[2], wo[2]))
    return (value * wi[2],)


def ashikhmin_shirley_half_vector(ax: mpf, ay: mpf, u1: mpf, u2: mpf) -> Values:
    """Ashikhmin and Shirley 2000, eq. 6 to 9, for both alphas."""
    nx, ny = 2 / ax**2 - 2, 2 / ay**2 - 2
    c, s = mp.cospi(2 * u1) * mp.sqrt(ny + 1), mp.sinpi(2 * u1) * mp.sqrt(nx + 1)
    length = mp.sqrt(c * c + s * s)
    c, s = c / length, s / length
    cosine = (1 - u2) ** (1 / (nx * c * c + ny * s * s + 1))
    sine = mp.sqrt(1 - cosine**2)
    return c * sine, s * sine, cosine


def inverted_gaussian(x: mpf, y: mpf, z: mpf, sigma: mpf) -> Values:
    """Ashikhmin, Premoze and Shirley 2000, section 5, over the integral of D cos.

    The constant term is left out.
    """
    sine2 = x * x + y * y
    return (mp.exp(-z * z / (sine2 * sigma**2)) / (mp.pi * (sigma * sine2) ** 2) if sine2 else mpf(0),)


def oren_nayar(*w: mpf) -> Values:
    """Portsmouth et al. 2024, eq. 8 to 15, times |i.n|, of wi, wo, roughness and colour."""
    wi, wo, roughness, color = w[:3], w[3:6], w[6], w[7]
    a = 1 / (mp.pi + roughness * (mp.pi / 2 - mpf(2) / 3))
    b = roughness * a

    def albedo(c: mpf) -> mpf:
        s = mp.sqrt(max(1 - c * c, mpf(0)))
        g = s * (mp.acos(min(c, mpf(1))) - mpf(2) / 3 - s * c) + mpf(2) / 3 * s / c * (1 - s**3)
        return mp.pi * a + b * g

    average = mp.pi * a + b * (2 * mp.pi - mpf("5.6")) / 3
    t = wi[0] * wo[0] + wi[1] * wo[1]
    single = a + b * (t / max(wi[2], wo[2]) if t > 0 else t)
    lost = (1 - albedo(wi[2])) * (1 - albedo(wo[2])) / (1 - average) if roughness else mpf(0)
    multiple = color**2 * average * lost / (mp.pi * (1 - color * (1 - average)))
    return (wi[2] * (color * single + multiple),)
