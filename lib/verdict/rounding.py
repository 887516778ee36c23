# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences that rounding causes, between none and all of a departure's effect.

Rounding decides how much of such a departure acts.
Faces in one plane hide each other's light in as many rays as single precision happens to put on the wrong side. No set
of departures reproduces that, and none has to: such a scene has no value of its own there. Rounding is named as the
reason in a region whose difference lies, in all channels, between zero and what the departures do in full, within the
tolerance and the noise. Other departures may act beside them, in full and in all regions: then zero is the reference with these.
This is a finding about the scene, not a claim with a level. Area lights in one plane are like that: Cycles' densities
decide how much of their light is lost.

Effects of fewer than two pairs have no known noise. They are left out, so that they hide none that is known.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from ..film.moments import Moments
from .attribution import ACTING, Attribution, Names
from .shares import Sides

# Standard errors of a region's difference that are left to noise.
_ERRORS = 3.0
# Pairs of an effect from which its noise is known.
_PAIRS = 2
# At most so many departures act in full beside those that rounding decides.
_BESIDE = 3


def rounded_regions(search: Attribution, sides: Sides, left: np.ndarray) -> tuple[Names, np.ndarray]:
    """The departures by which rounding explains regions, and these regions (N,).

    The regions are of those marked in `left` (N,). Among the departures are those that act in full beside: the fewest with which most
    regions are explained, and of these most without the help of the tolerance.
    """
    names, found, best = frozenset(), np.zeros(left.size, bool), (0, 0)
    for beside in _sets_beside(search, sides):
        room = _find_room(search, sides, beside)
        if room is None:
            break
        inside = room.holds(sides, room.allowed + room.noise)
        # What takes a region that agrees out of the tolerance does not act in full.
        if beside and not (inside | search.wanted).all():
            continue
        here = left & inside & room.acts
        # A region is no better known than those that lie inside it.
        here &= ~search.contains(left & ~here)
        count = int(here.sum()), int((here & room.holds(sides, room.noise)).sum())
        # Where rounding decides nothing, it is no reason.
        if count > best and (used := room.used(here)):
            names, found, best = beside | used, here, count
    return names, found


@dataclass(frozen=True)
class _Room:
    """Where (N, 3) the difference of regions may lie, from `low` to `high`, and beyond these by `noise`.

    allowed (N, 3): what the tolerance is there. acts (N,): whether any departure matters in a region. alone: what each departure that
    rounding decides does.
    """

    low: np.ndarray
    high: np.ndarray
    noise: np.ndarray
    allowed: np.ndarray
    acts: np.ndarray
    alone: dict[str, np.ndarray]

    def holds(self, sides: Sides, slack: np.ndarray) -> np.ndarray:
        """Whether (N,) the difference lies there, up to `slack`, in all channels."""
        return ((sides.gap >= self.low - slack) & (sides.gap <= self.high + slack)).all(axis=1)

    def used(self, where: np.ndarray) -> Names:
        """The departures that rounding decides and that matter in the regions `where` (N,)."""
        return frozenset(
            name for name, effect in self.alone.items() if (np.abs(effect) > ACTING * self.allowed)[where].any()
        )


def _sets_beside(search: Attribution, sides: Sides) -> Iterator[Names]:
    """Sets of departures that rounding does not decide and that may matter, the empty one first."""
    known = {next(iter(names)) for names, pairs in search.pairs.items() if len(names) == 1 and len(pairs) >= _PAIRS}
    certain = {d.name for d in search.departures if not d.by_rounding} & known
    names = [name for name in search.acting(sides) if name in certain]
    for size in range(min(_BESIDE, len(names)) + 1):
        yield from map(frozenset, combinations(names, size))


def _find_room(search: Attribution, sides: Sides, beside: Names) -> _Room | None:
    """What rounding makes possible where the departures `beside` act in full; None where no effect of it is known."""
    rounding = {d.name: d.form_of or d.name for d in search.departures if d.by_rounding}
    known = [names for names, pairs in search.pairs.items() if len(pairs) >= _PAIRS and names & rounding.keys()]
    effects = {names: search.moments(names) for names in known if names <= rounding.keys()}
    alone = {next(iter(names)): moments.mean for names, moments in effects.items() if len(names) == 1}
    if not alone:
        return None
    nothing = np.zeros_like(sides.scale)
    base = search.moments(beside) if beside else Moments(_PAIRS, nothing, nothing)
    # Each may act in part or in full where the others do, but for forms of one. What they do together is rendered only where it may be
    # the cause.
    forms = defaultdict(list)
    for name, effect in alone.items():
        forms[rounding[name]].append(effect)
    low = sum(np.min([nothing, *of_one], axis=0) for of_one in forms.values())
    high = sum(np.max([nothing, *of_one], axis=0) for of_one in forms.values())
    whole = [base.mean + moments.mean for moments in effects.values()]
    together = [search.moments(names) for names in known if beside and names - rounding.keys() == beside]
    whole += [moments.mean for moments in together]
    low, high = np.min([base.mean + low, *whole], axis=0), np.max([base.mean + high, *whole], axis=0)
    noise = [sides.candidate, sides.reference, *effects.values(), *together, *([base] if beside else [])]
    allowed = search.test.tolerance * sides.scale
    return _Room(
        low=low,
        high=high,
        noise=_ERRORS * np.sqrt(np.sum([m.variance / m.count for m in noise], axis=0)),
        allowed=allowed,
        acts=(np.maximum(-low, high) > ACTING * allowed).any(axis=1),
        alone=alone,
    )
