# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities of a sampled microfacet normal, and their change of variable.

The change of variable makes them densities of wi.
"""

from __future__ import annotations

import numpy as np

from ..vectors import dot
from .directions import FLOOR


def pdf_d_cos(m: np.ndarray, d: np.ndarray) -> np.ndarray:
    """pdf(m) = D(m) (m.n), per steradian of m, (n,) (documents, importance sampling).

    `m` (3, n) unit; `d` = D(m), (n,). Zero below the horizon.
    """
    return np.maximum(m[2], 0.0) * d


def pdf_visible(m: np.ndarray, wo: np.ndarray, d: np.ndarray, lambda_o: np.ndarray) -> np.ndarray:
    """pdf(m) = G1(o) max(0, o.m) D(m) / (o.n), per steradian of m, (n,) (Heitz 2014, eq. 2).

    `m`, `wo` (3, n) unit; `d` = D(m); `lambda_o` = Lambda(o) of the same distribution, (n,). Zero where wo lies below the
    horizon. For a density of wi the factor o.m cancels against `reflection_jacobian`.
    """
    return np.maximum(dot(wo, m), 0.0) * d / ((1.0 + lambda_o) * np.maximum(wo[2], FLOOR))


def reflection_jacobian(wo: np.ndarray, m: np.ndarray) -> np.ndarray:
    """Solid angle of m per solid angle of wi, 1 / (4 |o.m|), (n,).

    Walter et al. 2007, eq. 14.
    `wo`, `m` (3, n) unit. The documents sample m but estimate over wi: this is the factor that they leave out.
    """
    return 0.25 / np.maximum(np.abs(dot(wo, m)), FLOOR)
