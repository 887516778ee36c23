# SPDX-License-Identifier: GPL-3.0-or-later
"""The share of a microfacet that both directions see.

Torrance-Sparrow's cavities, and two forms of Smith's.
Smith's forms take Lambda of each direction from the distribution, so that it is computed once for masking and density.
"""

from __future__ import annotations

import numpy as np

from ..vectors import dot
from .directions import FLOOR

HIDDEN = 1e100
"""Smith's Lambda of a direction below the horizon: 1 / (1 + Lambda) is nothing, and no product with it overflows."""


def torrance_sparrow(wi: np.ndarray, wo: np.ndarray, m: np.ndarray) -> np.ndarray:
    """G = min{1, 2 (n.m)(n.o) / (o.m), 2 (n.m)(n.i) / (i.m)}, (n,).

    From the documents; Cook and Torrance 1982.
    `wi`, `wo`, `m` (3, n) unit. Zero where wi or wo lies below the horizon or sees the facet from behind.
    """
    cos_im, cos_om = dot(wi, m), dot(wo, m)
    nearer = np.minimum(wi[2] / np.maximum(cos_im, FLOOR), wo[2] / np.maximum(cos_om, FLOOR))
    g = np.clip(2.0 * (nearer * m[2]), 0.0, 1.0)
    return np.where(np.minimum(cos_im, cos_om) > 0.0, g, 0.0)


def separable(lambda_i: np.ndarray, lambda_o: np.ndarray) -> np.ndarray:
    """G = G1(i) G1(o) = 1 / ((1 + Lambda(i)) (1 + Lambda(o))), (n,).

    From the documents; Ashikhmin, Premoze and Shirley 2000.
    """
    return 1.0 / ((1.0 + lambda_i) * (1.0 + lambda_o))


def height_correlated(lambda_i: np.ndarray, lambda_o: np.ndarray) -> np.ndarray:
    """G = 1 / (1 + Lambda(i) + Lambda(o)), (n,).

    Masking and shadowing agree on the facet's height (Heitz 2014, eq. 99).
    """
    return 1.0 / (1.0 + (lambda_i + lambda_o))
