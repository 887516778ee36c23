# SPDX-License-Identifier: GPL-3.0-or-later
"""The least weighted squares of a candidate.

Linear parameters are found by projection, the others from several starts.
"""

from __future__ import annotations

import itertools
from collections import OrderedDict
from dataclasses import dataclass

import numpy as np

from .candidates import Candidate, design
from .observations import Observations

_ALPHAS = np.geomspace(0.004, 0.9, 12)
_RATIOS = (0.25, 1.0, 4.0)
_INVERSES = (0.02, 0.2, 0.4, 0.6)
_STARTS = 3
_REMEMBERED = 6
_ROUNDS = 25
_RIDGE = 1e-13  # of columns of length 1: two that are alike share what they explain
_INSIDE = 1e-4  # at a bound itself the sine does not move


@dataclass(frozen=True)
class Solution:
    """A candidate at its best.

    It has the searched `vector`, `linear` (c, k) parameters, chi^2, and the values it predicts, (c, n). `errors` (c,
    k) are standard errors of the linear ones, with the others as found.
    """

    candidate: Candidate
    vector: np.ndarray
    linear: np.ndarray
    chi2: float
    predicted: np.ndarray
    errors: np.ndarray

    @property
    def named(self) -> dict[str, float]:
        """The parameters of its shape by name."""
        return self.candidate.named(self.vector)


class Lobes:
    """The white lobes of a candidate's last few shapes.

    A change of the Fresnel term alone needs no new one.
    """

    def __init__(self, candidate: Candidate, seen: Observations) -> None:
        self._candidate, self._seen = candidate, seen
        self._known: OrderedDict[bytes, np.ndarray] = OrderedDict()

    def at(self, vector: np.ndarray) -> np.ndarray:
        """The lobe of a searched vector, (m,)."""
        key = vector[: len(self._candidate.names)].tobytes()
        if key not in self._known:
            self._known[key] = self._candidate.lobe(self._seen, vector)
        self._known.move_to_end(key)
        if len(self._known) > _REMEMBERED:
            self._known.popitem(last=False)
        return self._known[key]


def solve_linear(
    candidate: Candidate, seen: Observations, vector: np.ndarray, lobes: Lobes | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The best linear parameters (c, k) for a searched vector.

    Also returns what they predict (c, n), and their standard errors (c, k).
    """
    columns, fixed = design(candidate, seen, vector, (lobes or Lobes(candidate, seen)).at(vector))
    scaled = columns / seen.deviations[:, None]
    scale = np.maximum(np.sqrt(np.square(scaled).sum(axis=2)), 1e-300)
    scaled /= scale[..., None]
    inverse = np.linalg.inv(scaled @ scaled.swapaxes(1, 2) + _RIDGE * np.eye(columns.shape[1]))
    best = (inverse @ (scaled @ ((seen.values - fixed) / seen.deviations)[..., None]))[..., 0] / scale
    errors = np.sqrt(np.diagonal(inverse, axis1=1, axis2=2)) / scale
    return best, np.einsum("ck,ckn->cn", best, columns) + fixed, errors


def residuals(candidate: Candidate, seen: Observations, vector: np.ndarray, lobes: Lobes | None = None) -> np.ndarray:
    """Residuals over their standard errors, (c n,), at the best linear parameters."""
    _, predicted, _ = solve_linear(candidate, seen, vector, lobes)
    return ((predicted - seen.values) / seen.deviations).ravel()


def solve_from(
    candidate: Candidate, seen: Observations, starts: list[np.ndarray], fixed: dict[int, float] | None = None
) -> Solution:
    """The best of the local minima that `starts` lead to.

    Entries of the vector that are `fixed` stay. Bounds are kept by a sine (as in MINUIT), so that the search itself has
    none.
    """
    from scipy.optimize import least_squares

    low, high = candidate.bounds(seen.colors)
    held = fixed or {}
    free = np.array([k for k in range(len(low)) if k not in held], int)
    lobes = Lobes(candidate, seen)

    def whole(inner: np.ndarray, outer: np.ndarray) -> np.ndarray:
        vector = outer.copy()
        vector[free] = low[free] + (high - low)[free] * (0.5 + 0.5 * np.sin(inner))
        return vector

    best: tuple[float, np.ndarray] | None = None
    for start in starts:
        vector = start.copy()
        vector[list(held)] = list(held.values())
        if len(free):
            share = np.clip((vector - low) / (high - low), _INSIDE, 1.0 - _INSIDE)[free]
            found = least_squares(
                lambda inner, outer=vector: residuals(candidate, seen, whole(inner, outer), lobes),
                np.arcsin(2.0 * share - 1.0),
                method="lm",
                xtol=1e-7,
                ftol=1e-8,
                max_nfev=_ROUNDS * (len(free) + 1),
            )
            vector = whole(found.x, vector)
        chi2 = float(np.square(residuals(candidate, seen, vector, lobes)).sum())
        if best is None or chi2 < best[0]:
            best = chi2, vector
    assert best is not None
    linear, predicted, errors = solve_linear(candidate, seen, best[1], lobes)
    return Solution(candidate, best[1], linear, best[0], predicted, errors)


def search(candidate: Candidate, seen: Observations) -> Solution:
    """The best minimum of a candidate without indices of metals.

    The search descends from the most promising points of a grid. Narrow lobes over a broad one, or the reverse, are a
    false minimum: hence several starts.
    """
    axes: list[np.ndarray] = [np.log(_ALPHAS)]
    if candidate.anisotropic:
        axes.append(np.log(np.array(_RATIOS)))
    if candidate.distribution == "student-t":
        axes.append(np.array(_INVERSES))
    points = [np.array(point) for point in itertools.product(*axes)]
    scores = [float(np.square(residuals(candidate, seen, point)).sum()) for point in points]
    order = np.argsort(scores)[: 4 * _STARTS]
    starts: list[np.ndarray] = []
    for k in order:
        if all(abs(points[k][0] - other[0]) > 0.6 for other in starts) and len(starts) < _STARTS:
            starts.append(points[k])
    return solve_from(candidate, seen, starts)
