# SPDX-License-Identifier: GPL-3.0-or-later
"""What masking formulas say of a Beckmann surface.

These are the same three numbers that `traced` finds on height fields.
"""

from __future__ import annotations

import numpy as np

from ..microfacets.beckmann import Beckmann
from ..microfacets.masking import height_correlated, separable, torrance_sparrow
from ..vectors import dot

FORMULAS = ("separable", "correlated", "torrance_sparrow")
"""Names as in `--masking`; the last is that of V-cavities."""
_POINTS = 600
_NORMAL = np.array([[0.0], [0.0], [1.0]])


def visible_share(direction: np.ndarray, alpha: float) -> float:
    """Return Smith's G1 = 1 / (1 + Lambda) (Heitz 2014, eq. 43).

    It is the share of the facets that `direction` (3,) sees, of those that face it.
    """
    return float(1.0 / (1.0 + Beckmann().smith_lambda(direction[:, None], alpha, alpha)[0]))


def shared_by_mirror(direction: np.ndarray, alpha: float) -> dict[str, float]:
    """Return G of level facets for a direction and its mirror direction, by each of FORMULAS.

    `direction` is (3,).
    """
    wo = direction[:, None]
    wi = wo * np.array([[-1.0], [-1.0], [1.0]])
    both = _masking(wi, wo, _NORMAL, alpha)
    return {name: float(value[0]) for name, value in both.items()}


def reflected_once(direction: np.ndarray, alpha: float) -> dict[str, float]:
    """Return the share of light that white mirrors reflect once and that then leaves.

    The light goes along -`direction` (3,). There is one share for each of FORMULAS.

    The integral of D(m) G(i, o, m) (o.m)+ / (n.o) over normals m whose mirrored direction i lies above the horizon,
    by the midpoint rule over visible normals, to 1e-3.
    """
    u = (np.arange(_POINTS) + 0.5) / _POINTS
    u1, u2 = (one.ravel() for one in np.meshgrid(u, u))
    wo = np.repeat(direction[:, None], u1.size, axis=1)
    m = Beckmann().sample_visible(wo, alpha, alpha, u1, u2)
    wi = 2.0 * dot(wo, m) * m - wo
    above = wi[2] > 0.0
    seen = visible_share(direction, alpha)
    return {name: float(np.where(above, g / seen, 0.0).mean()) for name, g in _masking(wi, wo, m, alpha).items()}


def _masking(wi: np.ndarray, wo: np.ndarray, m: np.ndarray, alpha: float) -> dict[str, np.ndarray]:
    lambda_i, lambda_o = (Beckmann().smith_lambda(w, alpha, alpha) for w in (wi, wo))
    values = separable(lambda_i, lambda_o), height_correlated(lambda_i, lambda_o), torrance_sparrow(wi, wo, m)
    return dict(zip(FORMULAS, values, strict=True))
