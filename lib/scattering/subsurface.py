# SPDX-License-Identifier: GPL-3.0-or-later
"""The medium below a surface: extinction and single-scattering albedo.

They follow from the colour and radius that a user gives.

Cycles' material model (kernel/closure/bssrdf.h, kernel/integrator/subsurface_random_walk.h): the colour is about the
albedo of a thick body under diffuse light, and each mapping inverts that relation.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.polynomial import polyval

MAPPINGS = ("VAN_DE_HULST", "FITTED", "SKIN")
BY_DISK = "BURLEY"
"""The mapping of closures whose light takes no walk: it leaves about the point where it entered (profiles.py)."""
LEAST_RADIUS = 1e-8
"""Channels of a smaller radius, in metres, reflect where the light arrives (Cycles' BSSRDF_MIN_RADIUS)."""
_LARGEST_ALBEDO, _MOST_ANISOTROPY = 0.999999, 0.99
# Below it the medium keeps this albedo, and its light is scaled instead, so that black is reached without a step.
_LEAST_ALBEDO = 0.2
# Polynomials in g of Wrenninge, Villemin and Hery 2017, from the constant term upwards; B and E have an offset and a factor beside.
_A = (
    1.8260523782,
    -1.28451056436,
    -1.79904629312,
    9.19393289202,
    -22.8215585862,
    32.0234874259,
    -23.6264803333,
    7.21067002658,
)
_B = (0.0, 31.1491581433, -201.847017512, 841.576016723, -2018.09288505, 2731.71560286, -1935.41424244, 559.009054474)
_C = (
    1.09686102424,
    -0.394704063468,
    1.05258115941,
    -8.83963712726,
    28.8643230661,
    -46.8802913581,
    38.5402837518,
    -12.7181042538,
)
_D = (
    0.496310210422,
    0.360146581622,
    -2.15139309747,
    17.8896899217,
    -55.2984010333,
    82.065982243,
    -58.5106008578,
    15.8478295021,
)
_E = (0.0, 76.7316253952, -594.356773233, 2448.8834203, -5576.68528998, 7116.60171912, -4763.54467887, 1303.5318055)
_F = (
    2.40602999408,
    -2.51814844609,
    9.18494908356,
    -79.2191708682,
    259.082868209,
    -403.613804597,
    302.85712436,
    -87.4370473567,
)


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium at each of n points, by channel.

    extinction (3, n), 1/m; albedo (3, n) of a single scattering, in [0.2, 0.999999]; anisotropy (n,), Henyey and Greenstein's g.
    `scale` (3, n) multiplies all light that comes out again: 1 but for dark colours.
    """

    extinction: np.ndarray
    albedo: np.ndarray
    anisotropy: np.ndarray
    scale: np.ndarray

    def at(self, index: np.ndarray) -> Medium:
        """The media of the points `index`."""
        return Medium(*(np.take(array, index, axis=-1) for array in vars(self).values()))


def albedo_van_de_hulst(color: np.ndarray, g: np.ndarray) -> np.ndarray:
    """Return the single-scattering albedo of a half space with diffuse albedo `color`.

    The half space reflects `color` of diffuse light; d'Eon 2023, eq. 53.7.

    `color` in [0, 1]. By van de Hulst's similarity parameter s^2 = (1 - albedo) / (1 - g albedo).
    """
    s = 4.20863 * color - np.sqrt(9.59217 + 41.6808 * color + 17.7126 * color * color) + 4.09712
    return (1.0 - s * s) / (1.0 - g * (s * s))


def albedo_fitted(color: np.ndarray, g: np.ndarray) -> np.ndarray:
    """The same by the fit of Wrenninge, Villemin and Hery 2017, for g in [0, 0.9]."""
    blend = np.power(color, 0.25)
    low = polyval(g, _A) * np.power(
        np.arctan((4.98511194385 + 0.127355959438 * np.exp(polyval(g, _B))) * color), polyval(g, _C)
    )
    high = polyval(g, _D) * np.power(
        np.arctan((4.23190299701 + 0.00310603949088 * np.exp(polyval(g, _E))) * color), polyval(g, _F)
    )
    return (1.0 - blend) * low + blend * high


def dipole_reflectance(albedo: np.ndarray, internal: np.ndarray) -> np.ndarray:
    """Return what a half space reflects of light at normal incidence, by the dipole.

    Jensen et al. 2001, eq. 15.

    `albedo` is the reduced one, alpha' in [0, 1]; `internal` is A = (1 + F) / (1 - F) of the boundary's mean internal
    reflectance F.
    """
    s = np.sqrt(3.0 * (1.0 - albedo))
    return 0.5 * albedo * (1.0 + np.exp(-4.0 / 3.0 * internal * s)) * np.exp(-s)


def dipole_albedo(color: np.ndarray, ior: np.ndarray) -> np.ndarray:
    """Return the reduced albedo whose `dipole_reflectance` is `color`; at most 0.999999.

    It is found by bisection.

    The boundary's mean internal reflectance is Jensen et al. 2001's fit to the index `ior`.
    """
    inverse = 1.0 / ior
    mean = inverse * (0.71 - 1.44 * inverse) + 0.668 + 0.0636 * ior
    internal = (1.0 + mean) / (1.0 - mean)
    low, high = np.zeros(color.shape), np.full(color.shape, _LARGEST_ALBEDO)
    for _ in range(40):
        middle = 0.5 * (low + high)
        below = dipole_reflectance(middle, internal) < color
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return 0.5 * (low + high)


def make_medium(mapping: str, color: np.ndarray, radius: np.ndarray, g: np.ndarray, ior: np.ndarray) -> Medium:
    """Return the medium of a `mapping` out of MAPPINGS for `color` and `radius`.

    `color` and `radius` (m) are (3, n) each; `g` and `ior` are (n,).

    'VAN_DE_HULST': the radius is the mean free path 1 / extinction. 'FITTED': it is 4 pi times the reduced mean free
    path 1 / ((1 - g) extinction), the form before Blender 5.2. 'SKIN': the dipole's diffusion length. The last two
    read a negative g as the first does. Where the radius is 0 a channel never enters, and its extinction is finite.
    `g` is taken to lie in [-0.99, 0.99].
    """
    color, g = np.clip(color, 0.0, 1.0), np.clip(g, -_MOST_ANISOTROPY, _MOST_ANISOTROPY)
    if mapping == "FITTED":
        radius = radius / (4.0 * np.pi)
    elif mapping == "SKIN":
        radius = radius * np.sqrt(3.0 * (1.0 - dipole_albedo(color, ior)))
    extinction = 1.0 / np.maximum(radius, 1e-16)
    albedo = albedo_van_de_hulst(color, g)
    if mapping != "VAN_DE_HULST":
        forward = np.maximum(g, 0.0)
        albedo = np.where(g < 0.0, albedo, albedo_fitted(color, forward))
        extinction = extinction / (1.0 - forward)
    albedo = np.clip(albedo, 0.0, _LARGEST_ALBEDO)
    scale = np.minimum(albedo / _LEAST_ALBEDO, 1.0)
    return Medium(extinction, np.maximum(albedo, _LEAST_ALBEDO), np.broadcast_to(g, color.shape[1:]), scale)
