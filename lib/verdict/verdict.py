# SPDX-License-Identifier: GPL-3.0-or-later
"""The verdict on an image: one outcome per region, one for all, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..film.moments import Moments
from ..film.regions import RegionMoments
from ..plural import plural
from .causes import Explanation
from .claims import difference, interval
from .forecast import Forecast, forecast
from .outcome import Outcome
from .rare import blind_spot, describe_tails, pareto_shape, standardize
from .sequential import ALL_AGREE, ONE_DIFFERS, Look, SequentialTest, Withdrawn

RARE = "open because of rare light: too few samples to exclude that bright and seldom ones would make a difference"
UNSUPPORTED = (
    "open because of an unsupported material: its light may make the difference, and the reference does not have it"
)


@dataclass(frozen=True)
class Verdict:
    """What is claimed of N regions, and of the image.

    `outcomes` (N,) of Outcome, `decided_at` (N,) the replicates it took (0: undecided); `difference`, `low`, `high` (N, 3) the relative
    difference (candidate - reference) / max(|reference|, `floor`) and its confidence interval, simultaneous for all
    regions and channels; `reference`, `candidate` (N, 3) means. `excluded` (N,) is the weight, in pixels, that non-finite
    samples took out of each region. `reasons` says in words what keeps the image from being EQUIVALENT.

    `bounds` (N,) is the difference up to which each region agrees, the claims on all regions together; `bound` the largest of them, up to
    which the whole image agrees in every region; NaN where no pixel is left. `rare` (N,) is what of each is room for light that
    no sample has met, `blind` (N,) the worth of samples, in means of the region, beyond which a difference as large as the tolerance
    could have been missed. `unsupported` (N,) is room for light of unsupported materials, which the reference lacks; `blocked` (N,)
    marks the regions that it keeps open, however many samples there are. `tails` (N,) is the part of a region's light that its
    largest replicate carries, on the side where it is larger, `shapes` (N,) the shape of the tail there. `dark` (N,) marks regions
    below the floor in all channels. `withdrawn` are the claims that later data did not bear.
    """

    outcome: Outcome
    reasons: tuple[str, ...]
    tolerance: float
    confidence: float
    floor: np.ndarray
    outcomes: np.ndarray
    decided_at: np.ndarray
    reference: np.ndarray
    candidate: np.ndarray
    difference: np.ndarray
    low: np.ndarray
    high: np.ndarray
    excluded: np.ndarray
    bound: float
    bounds: np.ndarray
    rare: np.ndarray
    unsupported: np.ndarray
    blocked: np.ndarray
    blind: np.ndarray
    tails: np.ndarray
    shapes: np.ndarray
    dark: np.ndarray
    families: np.ndarray
    withdrawn: tuple[Withdrawn, ...]
    looks: tuple[Look, ...]
    forecast: Forecast | None

    @property
    def is_rare(self) -> np.ndarray:
        """The open regions (N,) that only room for unseen light keeps open.

        Without this room they would be within the tolerance.
        """
        wide = (self.bounds > self.tolerance) & (self.bounds - self.rare <= self.tolerance)
        return wide & (self.outcomes == Outcome.UNDECIDED) & ~self.blocked

    def count(self, outcome: Outcome) -> int:
        """The number of regions with that outcome."""
        return int((self.outcomes == outcome).sum())


def conclude(
    test: SequentialTest,
    reference: RegionMoments,
    candidate: RegionMoments,
    nonfinite: dict[str, int],
    samples: tuple[int, int],
    explanation: Explanation | None = None,
) -> Verdict:
    """The verdict after the last look.

    `nonfinite` counts, by the side's name, the pixels with non-finite samples.
    `samples` per pixel are in each replicate of the reference and the candidate.

    Regions that the `explanation` covers become EXPLAINED, and so does the image if all that was not EQUIVALENT is
    covered. If only what differs is covered, the image is UNDECIDED.

    Else it is DIFFERENT if a region is, EQUIVALENT if all are and every pixel of both sides is finite, or UNDECIDED: a
    pixel that has no value agrees with nothing, and no sampling will give it one.
    """
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
    return _figures(test, reference, candidate, samples, outcome, tuple(reasons), outcomes)


def _figures(
    test: SequentialTest,
    reference: RegionMoments,
    candidate: RegionMoments,
    samples: tuple[int, int],
    outcome: Outcome,
    reasons: tuple[str, ...],
    outcomes: np.ndarray,
) -> Verdict:
    """All figures beside what is claimed."""
    of_reference, of_candidate = reference.moments, candidate.moments
    tail = ONE_DIFFERS * test.level * _shares(test, of_reference, of_candidate) / (6 * test.outcomes.size)
    low, high = interval(of_candidate, of_reference, test.floor, tail)
    tails, shapes = _tails((reference, candidate), samples)
    return Verdict(
        outcome=outcome,
        reasons=reasons,
        tolerance=test.tolerance,
        confidence=test.confidence,
        floor=test.floor,
        outcomes=outcomes,
        decided_at=test.decided_at.copy(),
        reference=of_reference.mean,
        candidate=of_candidate.mean,
        difference=difference(of_candidate, of_reference, test.floor),
        low=low,
        high=high,
        excluded=reference.regions.sizes - reference.sizes,
        bound=test.overall_bound(),
        bounds=test.bounds.copy(),
        rare=test.rare.copy(),
        unsupported=test.unsupported.copy(),
        blocked=test.blocked & (reference.sizes > 0),
        blind=blind_spot(_fewest(reference, candidate, samples), test.tolerance, ALL_AGREE * test.level),
        tails=tails,
        shapes=shapes,
        dark=(np.abs(of_reference.mean) < test.floor).all(axis=1),
        families=test.families,
        withdrawn=tuple(test.withdrawn),
        looks=tuple(test.looks),
        forecast=None if outcome is Outcome.EXPLAINED else forecast(test, of_reference, of_candidate),
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
        reasons.append(f"{different} of {plural(test.outcomes.size, 'region')} {differ} by more than the tolerance")
    if any(nonfinite.values()):
        where = " and ".join(f"{plural(count, 'pixel')} of {name}" for name, count in nonfinite.items() if count)
        reasons.append(
            f"non-finite samples in {where}: these pixels are excluded, and an image that has any cannot be EQUIVALENT"
        )
    if min(reference.moments.most, candidate.moments.most) < 2:
        reasons.append("fewer than two replicates on a side: without a second one there is no variance to judge by")
        return reasons
    blocked = test.blocked & (reference.sizes > 0)
    rare = int((test.undecided & ~blocked & (test.bounds - test.rare <= test.tolerance) & ~test.within).sum())
    unsupported = int(blocked.sum())
    noisy = undecided - rare - unsupported
    for count, why in ((noisy, "still too noisy to decide"), (rare, RARE), (unsupported, UNSUPPORTED)):
        if count > 0:
            reasons.append(f"{count} of {plural(test.outcomes.size, 'region')} {'is' if count == 1 else 'are'} {why}")
    return reasons


def _fewest(reference: RegionMoments, candidate: RegionMoments, samples: tuple[int, int]) -> np.ndarray:
    """The samples (N,) that the side with fewer has in each region."""
    return np.minimum(*(s.drawn(n) * s.moments.n for s, n in zip((reference, candidate), samples, strict=True)))


def _tails(sides: tuple[RegionMoments, RegionMoments], samples: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """How much the largest replicate carries in each region, and the shape of the tail.

    (N,) each, those of the worse side.
    """
    shares, shapes = [], []
    for side, n in zip(sides, samples, strict=True):
        shares.append(describe_tails(side.series, side.drawn(n), side.weights).largest_share)
        shapes.append([pareto_shape(values) for values in standardize(side.series, side.weights[:, None]).T])
    return np.maximum(*shares), np.fmax(*shapes)


def _shares(test: SequentialTest, reference: Moments, candidate: Moments) -> np.ndarray:
    """The share of the error level (N, 1) that was spent when each region was last seen.

    A region that is not sampled further is not tested further.
    """
    n = np.broadcast_to(np.minimum(reference.n, candidate.n), test.outcomes.shape)
    shares = np.full(n.shape, test.looks[-1].share)
    for look in reversed(test.looks):
        shares[n <= min(look.replicates)] = look.share
    return shares[:, None]
