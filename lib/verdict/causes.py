# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be said of the causes of a difference: words, limits and evidence.

A set of departures *explains* a region that differs if three things hold. It is shown that with the set switched on the
reference agrees with the candidate to within the tolerance. It is shown that the set's share of the difference is
between BAND[0] and BAND[1]; this keeps out a set that overshoots: 1.5 % in place of a difference of 1.1 % is within a
tolerance of 1 %, but explains nothing. And it is not shown that the share is other than 1, by more than EXACT, in this
region or in one that lies inside it.

A set that explains every region is the cause. One that explains some is a partial cause, and so is a departure that is
shown to take some of the difference away (its share is above 0, and not small as estimated) and in no region without an
explanation to add to it. "Explains" means "is sufficient to explain": other sets may be so too. Those of the same size that the
data do not tell apart are rivals.

What is controlled: the chance of any false claim, of agreement, of a difference, of an explanation, of a share above 0
or of a small one, in any region, at any look and for any set, is at most 1 - confidence. Each kind of claim has a part
of this level, fixed before anything is seen (attribution.py), and spends it by Bonferroni's inequality or Holm's
procedure. A cause whose share is exactly 1 is denied by the third condition with a chance that is part of the same
level. A likely cause, a rival and the finding that no set fits are no claims: they say what the data look like.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from ..departures.catalogue import Departure

# Shares that count as an explanation, if they are shown to be in here: well apart from what is left or added where one of two like
# departures is missing or too many (1/2, 3/2). A narrower band costs more: replicates grow like 1 / (1 - 1 / BAND[1])^2, and at twice the
# tolerance this one asks for about 5 times those that agreement asks for; beyond 4.3 times the tolerance agreement asks for more.
BAND = (0.7, 1.3)
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
    ROUNDED = "explained by rounding"
    """All that differs is explained, some of it by departures of which rounding decides how much acts (rounding.py)."""
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
    UNTRIED = "acts on no pass that differs"


@dataclass(frozen=True)
class Shares:
    """The share `value` (N,) of a set of departures in N regions, and its intervals.

    `low`, `high` (N,) are simultaneous with those of every other set, region, channel and look; `alone` (2, N) are the ends for
    one share alone, at the verdict's confidence.
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
        """Where (N,) the share is shown to be above 0, and not shown to be above 2.

        Some of the difference goes away with the set.
        """
        return (self.low > 0.0) & (self.low <= 2.0)

    @property
    def harms(self) -> np.ndarray:
        """Where (N,) the share is shown to be below 0 or above 2.

        The difference grows with the set.
        """
        return (self.high < 0.0) | (self.low > 2.0)


@dataclass(frozen=True)
class Explanation:
    """What attribution found of N regions and M departures.

    state: the finding. named: the departures that it names (cause, partial causes or likely cause). chosen: those that explain a
    region: the fewest that explain every region that was not EQUIVALENT, if `complete` says that there are such. causes (N): the
    fewest names that explain each region, empty where nothing does. rounded (N,): the regions of which the difference lies between none
    and all of the effect of their `causes`, whose size rounding decides. roles (M): what is said of each departure. alternatives: other
    sets of as many departures as `named` that the data do not tell from it.
    effect (M, N, 3): what each departure alone adds to the reference, relative to it; NaN where it was not rendered. shares (M): what
    part that is of the difference in the channel furthest off; None where it was not rendered. of_named: the same of all `named`
    together. rest (N, 3): the relative difference that remains with `named`; NaN where no effect is known.
    limit: the share that counts as small. proof: the factor by which replicates must grow to prove a likely cause; infinite
    where that is not in sight. pairs: the fewest pairs of replicates, of `samples` per pixel, behind an effect. seconds: spent on all effects.
    """

    state: State
    departures: tuple[Departure, ...]
    named: tuple[str, ...]
    chosen: tuple[str, ...]
    complete: bool
    causes: tuple[tuple[str, ...], ...]
    rounded: np.ndarray
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
    """The explanation of the given `regions` where no effect was rendered.

    None of the `departures` that apply, if any, was tried.
    """
    count = len(departures)
    return Explanation(
        state=State.NO_TIME if departures else State.NO_DEPARTURE,
        departures=departures,
        named=(),
        chosen=(),
        complete=False,
        causes=((),) * regions,
        rounded=np.zeros(regions, bool),
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
