# SPDX-License-Identifier: GPL-3.0-or-later
"""The truth of lights and surfaces outside of lobes, in mpmath's arithmetic.

See exact.py.
"""

from __future__ import annotations

from mpmath import mp, mpf

from .exact import Values, dielectric, power_heuristic


def multiple_scattering(color: mpf, directional: mpf, average: mpf) -> Values:
    """Turquin 2019, eq. 15 and 16, with the colour of many bounces."""
    return (1 + color * average / (1 - color * (1 - average)) * (1 - directional) / directional,)


def coat_tint(ior: mpf, tint: mpf, weight: mpf, cosine: mpf) -> Values:
    """Beer's law along the refracted view, mixed by the weight."""
    inside = mp.sqrt(1 - (1 - cosine**2) / ior**2)
    return (1 - weight + weight * tint ** (1 / inside),)


def refract(x: mpf, y: mpf, z: mpf, eta: mpf) -> Values:
    """Snell's direction of the tangential part of a view from above.

    It is along the surface where there is no refracted direction.
    """
    return -x / eta, -y / eta, -mp.sqrt(max(1 - (x * x + y * y) / eta**2, mpf(0)))


def reflected(*w: mpf) -> Values:
    """Cos / pi of wi times the reflectance at the half vector of wi and wo."""
    wi, wo, eta = w[:3], w[3:6], w[6]
    half = [a + b for a, b in zip(wi, wo, strict=True)]
    return (wi[2] / mp.pi * dielectric(min(mp.sqrt(mp.fdot(half, half)) / 2, mpf(1)), eta)[0],)


def rotated(x: mpf, y: mpf, z: mpf, cosine: mpf, sine: mpf) -> Values:
    """Components in the frame whose x axis is (cos, sin, 0)."""
    return x * cosine + y * sine, y * cosine - x * sine, z


def f82_average(f0: mpf, tint: mpf) -> Values:
    """Integral of 2 c F(c), the clipping left out."""
    seventh = mpf(float(1.0 / 7.0))
    b = (f0 + (1 - f0) * (1 - seventh) ** 5) * (1 - tint) / (seventh * (1 - seventh) ** 6)
    return (min(max(f0 + (1 - f0) / 21 - b / 126, mpf(0)), mpf(1)),)


def cutoff_power_heuristic(p: mpf, q: mpf) -> Values:
    """Veach 1997, section 9.2.3: 0 or 1 where one density is below a fifth of the other."""
    fifth = mpf(0.2)
    return (mpf(0) if p < fifth * q else mpf(1) if q < fifth * p else power_heuristic(p, q)[0],)


def uniform_disk(u1: mpf, u2: mpf) -> Values:
    """Angle 2 pi u1, radius sqrt(u2)."""
    return mp.sqrt(u2) * mp.cospi(2 * u1), mp.sqrt(u2) * mp.sinpi(2 * u1)


def uniform_sphere(u1: mpf, u2: mpf) -> Values:
    """Angle 2 pi u1, cosine 1 - 2 u2."""
    radius = 2 * mp.sqrt(u2 * (1 - u2))
    return radius * mp.cospi(2 * u1), radius * mp.sinpi(2 * u1), mpf(1) - 2 * u2


def point_light(x: mpf, y: mpf, z: mpf) -> Values:
    """Direction to a place, and the inverse square of its distance."""
    squared = x * x + y * y + z * z
    distance = mp.sqrt(squared)
    return x / distance, y / distance, z / distance, 1 / squared


def area_density(height: mpf, distance: mpf) -> Values:
    """Density per steradian of a uniform place on an area of 1.

    It is distance^2 over the cosine height / distance.
    """
    return (distance**3 / height,)


def triangle_density(distance: mpf, facing: mpf) -> Values:
    """The same by the cosine, on an area of 1/2."""
    return (2 * distance**2 / abs(facing),)


def falloff(x: mpf, y: mpf, z: mpf, cos_edge: mpf, blend: mpf) -> Values:
    """smoothstep((c - cos b) / ((1 - cos b) blend)) for a spot light.

    c is the cosine of the direction towards a spot that shines along -z, b its edge.
    """
    c = min(max((z - cos_edge) / ((1 - cos_edge) * blend), mpf(0)), mpf(1))
    return (c * c * (3 - 2 * c),)
