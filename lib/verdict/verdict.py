# SPDX-License-Identifier: GPL-3.0-or-later
"""The verdict on an image: one outcome per region, one for all, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..film.moments import Moments
from ..film.regions import RegionMoments
from .causes import Explanation
from .claims import difference, interval
from .forecast import Forecast, forecast
from .outcome import Outcome
from .sequential import Look, SequentialTest


@dataclass(frozen=True)
class Verdict:
    """What is claimed of N regions, and of the image.

    `outcomes` (N,) of Outcome, `decided_at` (N,) the replicates it took (0: undecided); `difference`, `low`, `high` (N, 3) the relative
    difference (candidate - reference) / max(|reference|, `floor`) and its confidence interval, simultaneous for all
    regions and channels; `reference`, `candidate` (N, 3) means. `excluded` (N,) is the weight, in pixels, that non-finite
    samples took out of each region. `reasons` says in words what keeps the image from being EQUIVALENT.
    """

    outcome: Outcome
    reasons: tuple[str, ...]
    tolerance: float
    confidence: float
    floor: float
    outcomes: np.ndarray
    decided_at: np.ndarray
    reference: np.ndarray
    candidate: np.ndarray
    difference: np.ndarray
    low: np.ndarray
    high: np.ndarray
    excluded: np.ndarray
    looks: tuple[Look, ...]
    forecast: Forecast | None

    def count(self, outcome: Outcome) -> int:
        """The number of regions with that outcome."""
        return int((self.outcomes == outcome).sum())


def conclude(
    test: SequentialTest,
    reference: RegionMoments,
    candidate: RegionMoments,
    nonfinite: dict[str, int],
    explanation: Explanation | None = None,
) -> Verdict:
    """The verdict after the last look; `nonfinite` counts, by the side's name, the pixels with non-finite samples.

    Regions that the `explanation` covers become EXPLAINED, and so does the image if all that was not EQUIVALENT is covered. If only what
    differs is covered, the image is UNDECIDED.

    Else it is DIFFERENT if a region is, EQUIVALENT if all are and every pixel of both sides is finite, or UNDECIDED: a pixel that
    has no value agrees with nothing, and no sampling will give it one.
    """
    of_reference, of_candidate = reference.moments, candidate.moments
    reasons = _reasons(test, reference, candidate, nonfinite)
    different = bool((test.outcomes == Outcome.DIFFERENT).any())
    outcome = Outcome.DIFFERENT if different else Outcome.UNDECIDED if reasons else Outcome.EQUIVALENT
    outcomes = test.outcomes.copy()
    if explanation is not None:
        covered = np.array([bool(causes) for causes in explanation.causes])
        if explanation.complete and different and not any(nonfinite.values()):
            outcome = Outcome.EXPLAINED
        else:  # what is undecided may agree with the reference as it stands
            covered &= outcomes == Outcome.DIFFERENT
            if covered.any() and (covered | (outcomes != Outcome.DIFFERENT)).all():
                outcome = Outcome.UNDECIDED
                reasons.append(
                    "known departures explain every region that differs; whether they explain all the rest is open"
                )
        outcomes[covered] = Outcome.EXPLAINED
    tail = test.level * _shares(test, of_reference, of_candidate) / (6 * test.outcomes.size)
    low, high = interval(of_candidate, of_reference, test.floor, tail)
    return Verdict(
        outcome,
        tuple(reasons),
        test.tolerance,
        test.confidence,
        test.floor,
        outcomes,
        test.decided_at.copy(),
        of_reference.mean,
        of_candidate.mean,
        difference(of_candidate, of_reference, test.floor),
        low,
        high,
        reference.regions.sizes - reference.sizes,
        tuple(test.looks),
        None if outcome is Outcome.EXPLAINED else forecast(test, of_reference, of_candidate),
    )


def _reasons(
    test: SequentialTest, reference: RegionMoments, candidate: RegionMoments, nonfinite: dict[str, int]
) -> list[str]:
    """What keeps the image from being EQUIVALENT, in words."""
    reasons = []
    different = int((test.outcomes == Outcome.DIFFERENT).sum())
    undecided = int((test.undecided & (reference.sizes > 0)).sum())  # of what has pixels left
    if different:
        differ = "differs" if different == 1 else "differ"
        reasons.append(f"{different} of {test.outcomes.size} regions {differ} by more than the tolerance")
    if any(nonfinite.values()):
        where = " and ".join(f"{count} pixels of {name}" for name, count in nonfinite.items() if count)
        reasons.append(
            f"non-finite samples in {where}: these pixels are excluded, and an image that has any cannot be EQUIVALENT"
        )
    if min(reference.moments.most, candidate.moments.most) < 2:
        reasons.append("fewer than two replicates on a side: without a second one there is no variance to judge by")
    elif undecided:
        are = "is" if undecided == 1 else "are"
        reasons.append(f"{undecided} of {test.outcomes.size} regions {are} still too noisy to decide")
    return reasons


def _shares(test: SequentialTest, reference: Moments, candidate: Moments) -> np.ndarray:
    """The share of the error level (N, 1) that was spent when each region was last looked at: what is not sampled on is not either."""
    n = np.broadcast_to(np.minimum(reference.n, candidate.n), test.outcomes.shape)
    shares = np.full(n.shape, test.looks[-1].share)
    for look in reversed(test.looks):
        shares[n <= min(look.replicates)] = look.share
    return shares[:, None]
