# SPDX-License-Identifier: GPL-3.0-or-later
"""Integrals over microfacet normals.

They give the numbers that decide between two forms of an equation.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np

_ALONG, _ROUND = 128, 64


@cache
def _nodes() -> tuple[np.ndarray, np.ndarray]:
    return np.polynomial.legendre.leggauss(_ALONG)


def integrate_normals(function: Callable[[np.ndarray], np.ndarray], sigma: float) -> float:
    """The integral of `function` over the hemisphere of normals m.

    It serves functions as wide as sigma. `function` takes unit normals (3, n) and returns (n,) values per steradian.
    Gauss-Legendre in x, with tan(theta) = sigma x / (1 - x), times the trapezoidal rule in phi.
    """
    node, weight = _nodes()
    x = 0.5 * (1.0 + node)
    tangent = sigma * x / (1.0 - x)
    cosine = 1.0 / np.sqrt(1.0 + tangent**2)
    # d omega = sin(theta) d theta d phi, and d theta = cos^2(theta) d tan(theta)
    measure = 0.5 * weight * (tangent * cosine) * cosine**2 * sigma / (1.0 - x) ** 2
    phi = 2.0 * np.pi * np.arange(_ROUND) / _ROUND
    m = np.stack(
        [
            np.outer(tangent * cosine, np.cos(phi)).ravel(),
            np.outer(tangent * cosine, np.sin(phi)).ravel(),
            np.repeat(cosine, _ROUND),
        ]
    )
    values = function(m).reshape(_ALONG, _ROUND).mean(axis=1)
    return float(2.0 * np.pi * (values * measure).sum())
