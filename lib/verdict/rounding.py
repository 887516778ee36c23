# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences that rounding causes, between none and all of a departure's effect.

Rounding decides how much of such a departure acts.
Faces in one plane hide each other's light in as many rays as single precision happens to put on the wrong side. No set
of departures reproduces that, and none has to: such a scene has no value of its own there. Rounding is named as the
reason in a region whose difference lies, in all channels, between zero and what the departures do in full, within the
tolerance and the noise.
This is a finding about the scene, not a claim with a level. Area lights in one plane are like that: Cycles' densities
decide how much of their light is lost.

Effects of fewer than two pairs have no known noise. They are left out, so that they hide none that is known.
"""

from __future__ import annotations

import numpy as np

from .attribution import ACTING, Attribution, Names
from .shares import Sides

# Standard errors of a region's difference that are left to noise.
_ERRORS = 3.0
# Pairs of an effect from which its noise is known.
_PAIRS = 2


def rounded_regions(search: Attribution, sides: Sides, left: np.ndarray) -> tuple[Names, np.ndarray]:
    """The departures by which rounding explains regions, and these regions (N,).

    The regions are of those marked in `left` (N,).
    """
    rounding = {d.name for d in search.departures if d.by_rounding}
    sets = [names for names, pairs in search.pairs.items() if names <= rounding and len(pairs) >= _PAIRS]
    none = np.zeros(left.size, bool)
    if not sets:
        return frozenset(), none
    effects = {names: search.moments(names) for names in sets}
    # Each may act in part or in full where the others do. What they do together is rendered only where it may be the cause.
    alone = np.array([effect.mean for names, effect in effects.items() if len(names) == 1])
    low = np.min([np.minimum(alone, 0.0).sum(axis=0), *(effect.mean for effect in effects.values())], axis=0)
    high = np.max([np.maximum(alone, 0.0).sum(axis=0), *(effect.mean for effect in effects.values())], axis=0)
    variance = [m.variance / m.count for m in (sides.candidate, sides.reference, *effects.values())]
    allowed = search.test.tolerance * sides.scale
    slack = allowed + _ERRORS * np.sqrt(np.sum(variance, axis=0))
    acts = np.maximum(-low, high) > ACTING * allowed
    found = left & acts.any(axis=1) & ((sides.gap >= low - slack) & (sides.gap <= high + slack)).all(axis=1)
    # A region is no better known than those that lie inside it.
    found &= ~search.contains(left & ~found)
    used = [
        names
        for names, effect in effects.items()
        if (np.abs(effect.mean) > ACTING * allowed)[found].any() and len(names) == 1
    ]
    return (frozenset().union(*used), found) if found.any() else (frozenset(), none)
