# SPDX-License-Identifier: GPL-3.0-or-later
"""The claims on the change from one version to another.

They say whether there is a change, where, why, and which version is nearer to the reference.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from ..audit.findings import drawn
from ..audit.paired import CHANNELS, interval, p_values
from ..departures.catalogue import Departure
from ..film.parts import Part
from ..relative import relative_difference
from ..settings.comparison import CompareOptions
from ..verdict.claims import FLOOR_SHARE
from ..verdict.outcome import Outcome
from ..verdict.sequential import holm
from .claims import p_nearer
from .rounds import IMAGE, Rounds

# How the error level, 1 - confidence, is shared among three kinds of claims.
CHANGE_SHARE, NEARER_SHARE, CAUSE_SHARE = 0.6, 0.2, 0.2

# From the best to the worst, as for the exit code of a batch.
SEVERITY = (Outcome.EQUIVALENT, Outcome.EXPLAINED, Outcome.UNDECIDED, Outcome.DIFFERENT)


class Nearer(Enum):
    """Which of two versions lies nearer to the reference in a region.

    It is one of them, each in another channel, or not known.
    """

    FIRST = "first"
    SECOND = "second"
    BOTH = "each in another channel"
    OPEN = "not known"


@dataclass(frozen=True)
class PassChange:
    """The result for one light pass.

    It has the `outcomes` (n,) of the image and the regions with a name, and the relative change (n, 3) with its ends.
    """

    outcomes: np.ndarray
    difference: np.ndarray
    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True)
class Change:
    """The result for one pair of versions, by their numbers.

    `outcomes` (k,) of Outcome for each region, the whole image first: DIFFERENT is changed by more than the tolerance, EXPLAINED changed as
    `departures` say, EQUIVALENT unchanged within the tolerance. `difference`, `low`, `high` (k, 3) are the change relative to the first
    version and its interval, simultaneous for all pairs, regions and channels. `nearer` (k,) of Nearer. `map` (height, width) is the
    relative change where it is sure, else 0, NaN where a sample was not finite. `departures` are those that are not the same in both.
    """

    first: int
    second: int
    outcomes: np.ndarray
    difference: np.ndarray
    low: np.ndarray
    high: np.ndarray
    nearer: np.ndarray
    map: np.ndarray
    departures: tuple[Departure, ...]
    passes: dict[Part, PassChange]

    @property
    def outcome(self) -> Outcome:
        """The outcome of the whole change.

        DIFFERENT if a region or a pass is, else UNDECIDED if one is, EXPLAINED if all that changed is, EQUIVALENT if
        nothing changed.
        """
        found = np.concatenate([self.outcomes, *(one.outcomes for one in self.passes.values())])
        return next(one for one in reversed(SEVERITY) if (found == one).any())

    @property
    def has_changed(self) -> bool:
        """Whether some region or pass changed, for a known reason or not."""
        found = np.concatenate([self.outcomes, *(one.outcomes for one in self.passes.values())])
        return bool(((found == Outcome.DIFFERENT) | (found == Outcome.EXPLAINED)).any())

    @property
    def is_same(self) -> bool:
        """Whether both images are equal bit for bit, in every round."""
        return bool((self.low == 0).all() and (self.high == 0).all())

    @property
    def worst(self) -> tuple[int, int]:
        """Region and channel with the largest change that is sure.

        Where none is sure, those with the largest estimate.
        """
        sure = np.nan_to_num(np.maximum(np.maximum(self.low, -self.high), 0.0))
        size = sure if sure.any() else np.nan_to_num(np.abs(self.difference))
        place, channel = np.unravel_index(np.argmax(size), size.shape)
        return int(place), int(channel)


def judge(rounds: Rounds, departures: Sequence[tuple[Departure, ...]], options: CompareOptions) -> tuple[Change, ...]:
    """Judge all pairs together, so that one level holds for all claims.

    `departures` are those that changed, for each pair.
    """
    level = 1 - options.confidence
    reference = np.mean([series.of(IMAGE).mean(axis=0)[0] for series in rounds.references], axis=0)
    floor = FLOOR_SHARE * float(np.abs(reference).mean())
    names = (IMAGE, *rounds.passes)
    pairs = [_Pair(rounds, first, second) for first, second in rounds.pairs]

    of_change = [p_values(*pair.sides(name), options.tolerance, floor) for pair in pairs for name in names]
    changed = _rejected(of_change, CHANGE_SHARE * level)
    tail = CHANGE_SHARE * level / (2 * CHANNELS * sum(p.shape[1] for p in of_change))
    nearer = _rejected([p_nearer(*pair.errors()) for pair in pairs], NEARER_SHARE * level)
    of_cause = [pair.p_explained(options.tolerance, floor) for pair in pairs]
    explained = _rejected(of_cause, CAUSE_SHARE * level)

    found = []
    for k, (pair, why) in enumerate(zip(pairs, departures, strict=True)):
        planes = {}
        for plane, name in enumerate(names):
            outcomes = _outcomes(changed[k * len(names) + plane])
            sides = pair.sides(name)
            user, plain = sides
            relative = relative_difference((user - plain).mean(axis=0), plain.mean(axis=0), floor)
            planes[name] = PassChange(outcomes, relative, *interval(user, plain, floor, tail))
        whole = planes.pop(IMAGE)
        if why:
            known = (whole.outcomes == Outcome.DIFFERENT) & explained[k]
            whole.outcomes[known] = Outcome.EXPLAINED
            _explain_passes(whole, planes)
        grey = rounds.images[pair.first].mean(axis=2, keepdims=True)
        map_ = np.where(rounds.bad, np.nan, drawn(rounds.squares[k], grey, floor))
        of = whole.outcomes, whole.difference, whole.low, whole.high
        found.append(Change(pair.first, pair.second, *of, _nearer(nearer[k]), map_, why, planes))
    return tuple(found)


class _Pair:
    """The series of two versions."""

    def __init__(self, rounds: Rounds, first: int, second: int) -> None:
        self._rounds, self.first, self.second = rounds, first, second

    def sides(self, name: Part | str) -> tuple[np.ndarray, np.ndarray]:
        """The second version and the first one, in one kind of light.

        Changes are relative to the first one.
        """
        return self._rounds.cycles[self.second].of(name), self._rounds.cycles[self.first].of(name)

    def errors(self) -> tuple[np.ndarray, np.ndarray]:
        """The differences of both versions to their references."""
        one, two = (
            self._rounds.cycles[k].of(IMAGE) - self._rounds.references[k].of(IMAGE) for k in (self.first, self.second)
        )
        return one, two

    def p_explained(self, tolerance: float, floor: float) -> np.ndarray:
        """p-values (k,) of "the unexplained change is within the tolerance".

        Unexplained is what the models of both versions do not account for. 1 without models.
        """
        models = [self._rounds.models[k] for k in (self.first, self.second)]
        second, first = self.sides(IMAGE)
        if models[0] is None or models[1] is None:
            return np.ones(first.shape[1])
        told = models[1].of(IMAGE) - models[0].of(IMAGE)
        return p_values(second - told, first, tolerance, floor)[0]


def _rejected(p: list[np.ndarray], level: float) -> list[np.ndarray]:
    """Which claims are made at one level for all arrays of p-values together (Holm).

    They have the shapes of the arrays.
    """
    flat = holm(np.nan_to_num(np.concatenate([one.ravel() for one in p]), nan=1.0), level)
    parts = np.split(flat, np.cumsum([one.size for one in p])[:-1])
    return [part.reshape(one.shape) for part, one in zip(parts, p, strict=True)]


def _outcomes(rejected: np.ndarray) -> np.ndarray:
    """The outcomes (k,) of claims (2, k) "inside" and "outside"."""
    outcomes = np.full(rejected.shape[1], Outcome.UNDECIDED)
    outcomes[rejected[0]] = Outcome.EQUIVALENT
    outcomes[rejected[1]] = Outcome.DIFFERENT
    return outcomes


def _explain_passes(whole: PassChange, planes: dict[Part | str, PassChange]) -> None:
    """Mark the passes of a region as explained where its whole light is.

    Passes show where a change is.
    """
    for one in planes.values():
        region = whole.outcomes[: len(one.outcomes)]
        one.outcomes[(one.outcomes == Outcome.DIFFERENT) & (region == Outcome.EXPLAINED)] = Outcome.EXPLAINED


def _nearer(rejected: np.ndarray) -> np.ndarray:
    """Of each region (k,) what claims (2, k, 3) on its channels say together."""
    first, second = rejected.any(axis=2)
    found = np.full(first.shape, Nearer.OPEN)
    found[first & ~second], found[second & ~first], found[first & second] = Nearer.FIRST, Nearer.SECOND, Nearer.BOTH
    return found
