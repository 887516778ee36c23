# SPDX-License-Identifier: GPL-3.0-or-later
"""The confidence interval of a ratio of two means that are both noisy."""

from __future__ import annotations

import numpy as np


def fieller(
    numerator: np.ndarray,
    denominator: np.ndarray,
    variances: tuple[np.ndarray, np.ndarray],
    covariance: np.ndarray | float,
    q: np.ndarray | float,
) -> tuple[np.ndarray, np.ndarray]:
    """Both ends of the interval of numerator / denominator.

    `variances` (numerator, denominator) and `covariance` are those of the two estimates, `q` > 0 is the quantile of one tail. All rho with
    |A - rho B| <= q s(A - rho B); infinite ends where B is not distinct from 0 or where a variance is not known (NaN).

    Fieller, "Some problems in interval estimation", Journal of the Royal Statistical Society B 16 (1954), eq. 7.
    """
    aa, bb, ab = (q * q * v for v in (*variances, covariance))
    lead, middle = denominator * denominator - bb, numerator * denominator - ab
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(middle * middle - lead * (numerator * numerator - aa), 0.0))
        low = np.where(lead > 0, (middle - root) / lead, -np.inf)
        high = np.where(lead > 0, (middle + root) / lead, np.inf)
    return np.where(np.isnan(low), -np.inf, low), np.where(np.isnan(high), np.inf, high)
