# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be said of the causes of a difference: the words, the limits, and what is kept of the evidence.

A set of departures *explains* a region that differs if two things are shown: with the set switched on, the reference agrees with
the candidate to within the tolerance, and the set's share of the difference is between BAND[0] and BAND[1]. The second keeps
out a set that overshoots: 1.5 % in place of a difference of 1.1 % is within a tolerance of 1 %, but is no explanation.
The set is the cause only if its share is compatible with 1, too: the simultaneous interval of the share meets 1 -+ EXACT in
every region inside that differs. Otherwise it is a partial cause. "Explains" means "is sufficient to explain": another set may be so too, and those of
the same size that the data do not tell apart are rivals.

What is controlled: the chance of any false claim, of agreement, of a difference, of an explanation, of a partial cause or of a
small share, in any region, at any look and for any set, is at most 1 - confidence. A likely cause is no claim. The proof: each kind of claim has a part
of the level, fixed before anything is seen (attribution.py), and spends it by Bonferroni's inequality or Holm's procedure.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from ..departures.catalogue import Departure

# Shares that count as an explanation, if they are shown to be in here. The ends are well apart from what sums of two or three like departures
# give (1/2, 3/2), and a share that is known to a quarter asks for about the noise that the tolerance itself asks for.
BAND = (0.75, 1.25)
# A share that is this near to 1 is not held against a cause: the reference's form of a departure is a model of Cycles' code, too.
EXACT = 0.05
# The largest share that counts as small; see `small_limit`.
SMALL = 0.2


def small_limit(count: int) -> float:
    """The share below which each of `count` departures is small: min(0.2, BAND[0] / count).

    Effects of departures nearly add up, so even all of them together then fall short of what a cause must have.
    """
    return min(SMALL, BAND[0] / max(count, 1))


def is_off(low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Where the interval from `low` to `high` of a share shows that it is not 1, up to EXACT."""
    return (high < 1.0 - EXACT) | (low > 1.0 + EXACT)


class State(Enum):
    """What attribution found for the regions that differ."""

    CAUSE = "cause"
    """A set of departures explains every region that is not EQUIVALENT, or all that differ while others are open."""
    PARTIAL = "partial cause"
    """Departures explain some regions, or a part of the difference; the rest is left over."""
    LIKELY = "likely cause"
    """A set is compatible with all that is seen and acts, but it is not proved to explain it."""
    NO_REASON = "no known reason"
    """The share of every departure that applies is shown to be small."""
    RULED_OUT = "ruled out"
    """No set of the departures that apply is compatible with the difference."""
    OPEN = "open"
    """The shares are too noisy to name a cause or to rule one out."""
    NO_TIME = "not measured"
    """Departures apply, but no effect was rendered."""
    NO_DEPARTURE = "no departure applies"
    """No departure that is known applies to the scene."""


class Role(Enum):
    """What is said of one departure."""

    CAUSE = "cause"
    PARTIAL = "partial cause"
    LIKELY = "likely cause"
    SMALL = "small"
    OPEN = "open"


@dataclass(frozen=True)
class Shares:
    """The share `value` (N,) of a set of departures in N regions, and its intervals.

    `low`, `high` (N,) are simultaneous with those of every other set, region, channel and look; `alone` (2, N) are the ends for one share alone,
    at the verdict's confidence.
    """

    value: np.ndarray
    low: np.ndarray
    high: np.ndarray
    alone: np.ndarray

    @property
    def bound(self) -> np.ndarray:
        """The largest size (N,) of the share that is not ruled out, for all shares together."""
        return np.maximum(np.abs(self.low), np.abs(self.high))

    @property
    def off(self) -> np.ndarray:
        """Where (N,) the share is shown not to be 1, up to EXACT."""
        return is_off(self.low, self.high)

    @property
    def helps(self) -> np.ndarray:
        """Where (N,) the share is shown to be above 0."""
        return self.low > 0.0


@dataclass(frozen=True)
class Explanation:
    """What attribution found of N regions and M departures.

    `state` is the finding and `named` are the departures that it names: the cause, the partial causes or the likely cause. `chosen` are those
    that explain a region: the fewest that explain every region that was not EQUIVALENT, if `complete` says that there are such.
    `causes` (N) are the names that explain each region, the fewest again, empty where nothing does. `roles` (M) says what is
    said of each departure, `alternatives` are other sets of as many departures as `named` that the data do not tell from it.
    `effect` (M, N, 3) is what each departure alone adds to the reference, relative to it, and `shares` (M) what part that is of the
    difference in the channel furthest off, None where the departure was not rendered (effect: NaN). `of_named` are the shares of all `named`
    together. `rest` (N, 3) is the relative difference that remains with `named`, NaN where no effect is known. `proof` is the factor by which replicates on
    both sides must grow to prove a likely cause, infinite where that is not in sight. At least `pairs` pairs of replicates of `samples` per
    pixel stand behind each effect, in `seconds` altogether.
    """

    state: State
    departures: tuple[Departure, ...]
    named: tuple[str, ...]
    chosen: tuple[str, ...]
    complete: bool
    causes: tuple[tuple[str, ...], ...]
    roles: tuple[Role, ...]
    alternatives: tuple[tuple[str, ...], ...]
    effect: np.ndarray
    shares: tuple[Shares | None, ...]
    of_named: Shares | None
    rest: np.ndarray
    limit: float
    proof: float
    samples: int
    pairs: int
    seconds: float


def nothing_found(regions: int, departures: tuple[Departure, ...] = ()) -> Explanation:
    """The explanation of so many regions where no effect was rendered: none of the `departures` that apply, if any, was tried."""
    count = len(departures)
    return Explanation(
        state=State.NO_TIME if departures else State.NO_DEPARTURE,
        departures=departures,
        named=(),
        chosen=(),
        complete=False,
        causes=((),) * regions,
        roles=(Role.OPEN,) * count,
        alternatives=(),
        effect=np.full((count, regions, 3), np.nan),
        shares=(None,) * count,
        of_named=None,
        rest=np.full((regions, 3), np.nan),
        limit=small_limit(count),
        proof=np.inf,
        samples=0,
        pairs=0,
        seconds=0.0,
    )
