# SPDX-License-Identifier: GPL-3.0-or-later
"""Which model the data show.

It finds all candidates at their best, those that the data cannot tell apart, and whether any of them fits.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from ..errors import EtalonError
from ..microfacets.fresnel import conductor
from ..progress import NO_PROGRESS, Progress
from .candidates import DISTRIBUTIONS, MASKINGS, MULTI_GGX, Candidate
from .intervals import CONFIDENCE, profile_interval
from .observations import Observations
from .solve import Solution, search, solve_from

LEVEL = 0.001
"""A right model is called none of these in so many cases."""
_METALS = ((0.3, 0.5), (1.5, 2.0))
_LIT = 1e-12
_FEWEST = 50
_NEAR = 1.5
_HOPELESS = 5.0


@dataclass(frozen=True)
class Identification:
    """The answer about `seen`: `best`, its equivalents, and all candidates.

    Equivalents are the candidates that the data cannot tell from the best; of all, the best fit is first. `fits` says
    whether the best one explains the data; `p_value` is the share of data sets of the right model that fit worse.
    `intervals` are 95 % intervals of the best one's shape by name, `inverse_g` that of 1/g among all Student-t
    distributions.
    """

    seen: Observations
    best: Solution
    equivalent: tuple[Solution, ...]
    solutions: tuple[Solution, ...]
    p_value: float
    intervals: dict[str, tuple[float, float]]
    inverse_g: tuple[float, float, float]

    @property
    def fits(self) -> bool:
        """Whether the best candidate explains the data."""
        return self.p_value >= LEVEL

    def reflectances(self) -> np.ndarray:
        """Reflectance at normal incidence, or the colour where there is no Fresnel term, (c,)."""
        candidate = self.best.candidate
        if candidate.fresnel != "exact":
            return self.best.linear[:, 1]
        indices = self.indices()
        return conductor(np.ones(len(indices)), indices[:, 0], indices[:, 1])

    def indices(self) -> np.ndarray:
        """Refractive index and absorption of each colour, (c, 2); only for exact Fresnel terms."""
        return np.exp(self.best.vector[len(self.best.candidate.names) :]).reshape(self.seen.colors, 2)


def identify(seen: Observations, progress: Progress = NO_PROGRESS) -> Identification:
    """Fit every candidate to `seen` and compare them.

    Raises EtalonError where nothing is lit, there are too few values, or the task is cancelled.
    """
    _require_light(seen)
    progress.begin("searching")
    starts = {name: _search(name, seen) for name in DISTRIBUTIONS}
    first = min(starts.values(), key=lambda one: one.chi2)
    progress.begin("comparing models")
    seen = seen.at_level(first.predicted)
    solutions = _all(seen, starts, progress)
    seen = seen.at_level(solutions[0].predicted)  # once more, with the noise of what the best one predicts
    solutions = _again(seen, solutions, progress)
    first = _best(solutions, seen)
    progress.begin("measuring intervals")
    names = first.candidate.names
    vectors = {name: profile_interval(first, seen, k) for k, name in enumerate(names)}
    intervals = {n: v if n == "1/g" else (float(np.exp(v[0])), float(np.exp(v[1]))) for n, v in vectors.items()}
    student = min((s for s in solutions if s.candidate.distribution == "student-t"), key=lambda one: one.chi2)
    inverse = profile_interval(student, seen, student.candidate.names.index("1/g"))
    return Identification(
        seen,
        first,
        tuple(one for one in solutions if _cannot_tell(one, first, seen)),
        tuple(solutions),
        _p_value(first, seen),
        intervals,
        (student.named["1/g"], *inverse),
    )


def _require_light(seen: Observations) -> None:
    if float(np.max(seen.values, initial=0.0)) <= _LIT:
        raise EtalonError(f"{seen.source}: nothing lit to fit; show the material under a light")
    if seen.values.size < _FEWEST:
        raise EtalonError(f"{seen.source}: {seen.values.size} values are too few to fit; make the image larger")


def _search(distribution: str, seen: Observations) -> Solution:
    """The best start of a distribution.

    Metals are too slow to search by, and begin where the others end.
    """
    masked = [Candidate(distribution, "correlated", term, seen.anisotropic) for term in _terms(seen)]
    return min((search(one, seen) for one in masked), key=lambda one: one.chi2)


def _all(seen: Observations, starts: dict[str, Solution], progress: Progress) -> list[Solution]:
    """All candidates at their best, the best fit first.

    Indices of metals, which are slow to search, are left out where a shape is far off already.
    """
    plain: list[Solution] = []
    for name, masking, term in itertools.product(DISTRIBUTIONS, MASKINGS, _terms(seen)):
        progress.check()
        plain.append(solve_from(Candidate(name, masking, term, seen.anisotropic), seen, [starts[name].vector]))
    multiple = Candidate(MULTI_GGX, "correlated", "none", seen.anisotropic)
    plain.append(solve_from(multiple, seen, [starts["ggx"].vector]))
    exact: dict[str, list[Solution]] = {name: [] for name in DISTRIBUTIONS}
    if seen.tells_fresnel:
        least = min(one.chi2 for one in plain)
        for name, masking in itertools.product(DISTRIBUTIONS, MASKINGS):
            same = [one for one in plain if (one.candidate.distribution, one.candidate.masking) == (name, masking)]
            if min(one.chi2 for one in same) > _HOPELESS * least:
                continue
            progress.check()
            done, shape = exact[name], starts[name].vector
            begin = [done[0].vector] if done else [np.r_[shape, guess] for guess in _metals(starts[name], seen)]
            done.append(solve_from(Candidate(name, masking, "exact", seen.anisotropic), seen, begin))
    return sorted([*plain, *itertools.chain.from_iterable(exact.values())], key=lambda one: one.chi2)


def _terms(seen: Observations) -> tuple[str, ...]:
    """The Fresnel terms without indices that the data can tell apart at all."""
    return ("none", "schlick") if seen.tells_fresnel else ("none",)


def _again(seen: Observations, earlier: list[Solution], progress: Progress) -> list[Solution]:
    """Fit the same candidates under another noise, and sort them, the best fit first.

    What fits far worse than the best is not searched again.
    """
    found = []
    for one in earlier:
        progress.check()
        is_near = one.chi2 < _NEAR * earlier[0].chi2
        held = {} if is_near else dict(enumerate(map(float, one.vector)))
        found.append(solve_from(one.candidate, seen, [one.vector], held))
    return sorted(found, key=lambda one: one.chi2)


def _metals(start: Solution, seen: Observations) -> list[np.ndarray]:
    """Logarithms of indices to begin with.

    They are those of an insulator and two metals that reflect about as much.
    """
    f0 = np.clip(start.linear[:, 1], 0.01, 0.98)
    insulator = np.stack([(1.0 + np.sqrt(f0)) / (1.0 - np.sqrt(f0)), np.full(seen.colors, 0.05)], axis=1)
    metals = []
    for ior, _ in _METALS:
        k = np.sqrt(np.maximum((f0 * (ior + 1.0) ** 2 - (ior - 1.0) ** 2) / (1.0 - f0), 0.01))
        metals.append(np.stack([np.full(seen.colors, ior), k], axis=1))
    return [np.log(one).ravel() for one in (insulator, *metals)]


def _cannot_tell(one: Solution, best: Solution, seen: Observations) -> bool:
    """Whether chi^2 rises from `best` to `one` by no more than noise explains.

    The number of parameters in which the two differ is taken into account.
    """
    from scipy.stats import chi2

    more = abs(one.candidate.parameters(seen.colors) - best.candidate.parameters(seen.colors))
    return one.chi2 - best.chi2 <= float(chi2.ppf(CONFIDENCE, max(more, 1))) * seen.rise


def _best(solutions: list[Solution], seen: Observations) -> Solution:
    """The simplest candidate that the data cannot tell from the best fit.

    It is the one with the fewest parameters.
    """
    alike = [one for one in solutions if _cannot_tell(one, solutions[0], seen)]
    return min(alike, key=lambda one: (one.candidate.parameters(seen.colors), one.chi2))


def _p_value(best: Solution, seen: Observations) -> float:
    """The share of data sets that would fit worse if `best` were right.

    chi^2 has its own distribution where variances are known. Where they are estimated from few replicates its terms are squares
    of Student's t, whose sum over many values is taken as normal.
    """
    from scipy.stats import chi2, norm

    free = seen.values.size - best.candidate.parameters(seen.colors)
    if np.isinf(seen.degrees):
        return float(chi2.sf(best.chi2, free))
    v, mean = seen.degrees, seen.inflation
    spread = 2.0 * v * v * (v - 1.0) / ((v - 2.0) ** 2 * (v - 4.0))
    return float(norm.sf((best.chi2 - free * mean) / np.sqrt(free * spread)))
