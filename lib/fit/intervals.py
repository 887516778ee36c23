# SPDX-License-Identifier: GPL-3.0-or-later
"""Intervals by profile likelihood.

The other parameters, at their best, make up for the change of one.
"""

from __future__ import annotations

import numpy as np

from .observations import Observations
from .solve import Solution, residuals, solve_from

CONFIDENCE = 0.95
_DOUBLINGS = 12


def profile_interval(solution: Solution, seen: Observations, index: int) -> tuple[float, float]:
    """The 95 % interval of entry `index` of the searched vector.

    chi^2 rises by 3.84 at its ends, by more where errors are estimated (`Observations.rise`), or a bound is met.
    """
    from scipy.optimize import root_scalar
    from scipy.stats import chi2

    level = solution.chi2 + float(chi2.ppf(CONFIDENCE, 1)) * seen.rise
    low, high = (float(bound[index]) for bound in solution.candidate.bounds(seen.colors))
    best, step = float(solution.vector[index]), _step(solution, seen, index)

    def excess(value: float) -> float:
        return solve_from(solution.candidate, seen, [solution.vector.copy()], {index: value}).chi2 - level

    ends = []
    for sign, bound in ((-1.0, low), (1.0, high)):
        inside, reach = best, step
        for _ in range(_DOUBLINGS):
            outside = min(max(best + sign * reach, low), high)
            if excess(outside) > 0.0:
                ends.append(
                    float(root_scalar(excess, bracket=(inside, outside), method="brentq", xtol=1e-3 * step).root)
                )
                break
            if outside == bound:
                ends.append(bound)
                break
            inside, reach = outside, 2.0 * reach
        else:
            ends.append(bound)
    return ends[0], ends[1]


def _step(solution: Solution, seen: Observations, index: int) -> float:
    """Two standard errors of an entry by the curvature of chi^2, the others held.

    The interval's half width is at least that.
    """
    shift = 1e-4
    moved = solution.vector.copy()
    high = solution.candidate.bounds(seen.colors)[1][index]
    moved[index] += shift if moved[index] + shift <= high else -shift
    here = residuals(solution.candidate, seen, solution.vector)
    slope = float(np.linalg.norm(residuals(solution.candidate, seen, moved) - here)) / shift
    return 2.0 / max(slope, 1e-6)
