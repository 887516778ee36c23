# SPDX-License-Identifier: GPL-3.0-or-later
"""Radial profiles over a surface: how much a place counts at a distance, and distances drawn by them."""

from __future__ import annotations

import numpy as np
from scipy.special import betaincinv


def cubic_profile(radius: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Return 10 (R - r)^3 / (pi R^5) within the radius R, 0 beyond, in 1/m^2, (n,).

    Over a plane it integrates to 1. `radius` > 0 and `distance` in metres (King et al. 2013).
    """
    return 10.0 * np.maximum(radius - distance, 0.0) ** 3 / (np.pi * radius**5)


def sample_cubic(radius: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return distances in a plane that follow `cubic_profile`, in metres, (n,).

    The density of x = r / R is 20 x (1 - x)^3, the beta distribution of 2 and 4. `u` in (0, 1).
    """
    return radius * betaincinv(2.0, 4.0, u)


DISK_REACH = 16.0
"""Burley's profile is cut off at so many times its spread (Cycles' BURLEY_TRUNCATE)."""
_SHARE = 1.0 - 0.25 * np.exp(-DISK_REACH) - 0.75 * np.exp(-DISK_REACH / 3.0)


def burley_density(spread: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Return the density of the distance r in a plane at which light leaves, in 1/m, (n,) or (3, n).

    It is proportional to exp(-r / d) + exp(-r / (3 d)) up to 16 d for the `spread` d in metres, 0 beyond, and integrates to
    1 over r (Burley 2015). Where the spread is 0 it is 0.
    """
    known = spread > 0.0
    d = np.where(known, spread, 1.0)
    slow = np.exp(-distance / (3.0 * d))
    return np.where(known & (distance < DISK_REACH * d), (slow**3 + slow) / (4.0 * d * _SHARE), 0.0)


def sample_burley(spread: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return distances that follow `burley_density`, in metres, (n,); `u` in (0, 1).

    With y = exp(-r / (3 d)) the distribution is 1 - (y^3 + 3 y) / 4, a cubic that has one real root.
    """
    return -3.0 * spread * np.log(2.0 * np.sinh(np.arcsinh(2.0 * (1.0 - _SHARE * u)) / 3.0))
