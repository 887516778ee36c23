# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of two images lies nearer to the truth.

It is judged from replicates of their differences to it that were taken together. With a and b the true differences of
two versions to the reference in one region and channel, |b| < |a| holds exactly where b^2 - a^2 = (b - a) (b + a) < 0:
where the step from one version to the other leads against the side on which their middle lies. Both factors are means
of series with one number for each round, so Student's t judges the sign of each, whatever the two have in common.
"""

from __future__ import annotations

import numpy as np
from scipy.special import stdtr


def p_nearer(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """p-values (2, k, 3) of "the first lies nearer" and "the second lies nearer".

    The arguments are series (replicates, k, 3) of differences. Either claim needs the signs of both factors, each of
    which has to be shown (Berger, "Multiparameter hypothesis testing and acceptance sampling", 1982), and may hold
    with two pairs of signs: Bonferroni. 1 with fewer than two replicates.
    """
    if len(first) < 2:
        return np.ones((2, *first.shape[1:]))
    step, middle = (_p_of_sign(series) for series in (second - first, second + first))
    alike = np.minimum(np.maximum(step[0], middle[0]), np.maximum(step[1], middle[1]))
    apart = np.minimum(np.maximum(step[0], middle[1]), np.maximum(step[1], middle[0]))
    return np.minimum(2.0 * np.stack([alike, apart]), 1.0)


def _p_of_sign(series: np.ndarray) -> np.ndarray:
    """p-values (2, k, 3) of "the mean is above 0" and "the mean is below 0".

    The mean is that of a series (replicates, k, 3).
    """
    count, mean = len(series), series.mean(axis=0)
    error = series.std(axis=0, ddof=1) / np.sqrt(count)
    noisy = error > 0
    t = np.divide(mean, error, out=np.zeros(mean.shape), where=noisy)
    above = np.where(noisy, stdtr(count - 1, -t), np.where(mean > 0, 0.0, 1.0))
    below = np.where(noisy, stdtr(count - 1, t), np.where(mean < 0, 0.0, 1.0))
    return np.nan_to_num(np.stack([above, below]), nan=1.0)
