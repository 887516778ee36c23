# SPDX-License-Identifier: GPL-3.0-or-later
"""From the search to what is said of causes.

A cause, a partial cause, a likely cause, no known reason, or none of these yet.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from ..film.regions import RegionMoments
from .attribution import Attribution, Names
from .causes import BAND, Explanation, Role, Shares, State, nothing_found, small_limit
from .proof import growth_of_proof
from .rounding import rounded_regions
from .shares import Sides

# A likely cause has at most so many departures.
_LIKELY_SIZE = 3


def explain(
    search: Attribution, reference: RegionMoments, candidate: RegionMoments, samples: int, seconds: float
) -> Explanation | None:
    """The explanation of the differences; None where no region differs.

    `samples` per pixel stand behind each pair, `seconds` behind all of them.
    """
    different = search.different
    if not different.any():
        return None
    if not search.pairs:
        return nothing_found(different.size, search.departures)
    sides = search.sides(reference, candidate)
    with np.errstate(divide="ignore", invalid="ignore"):
        difference = sides.gap / sides.scale
    best, causes = _causes(search, sides)
    by_rounding, rounded = rounded_regions(search, sides, different & ~np.array([bool(names) for names in causes]))
    causes = [by_rounding if here else names for names, here in zip(causes, rounded, strict=True)]
    chosen = best if search.complete else frozenset().union(*causes)
    alone = {name: frozenset([name]) for name in search.names}
    shares = {name: search.shares(one, sides) for name, one in alone.items() if one in search.pairs}
    left = different & ~np.array([bool(names) for names in causes])
    target = left if left.any() else different
    if rounded.any() and not left.any():
        state, named, others = State.ROUNDED, chosen, []
    else:
        state, named, others = _find(search, sides, chosen, shares, left)
    limit = small_limit(len(search.names))
    roles = _roles(search, state, shares, target, (named, chosen, by_rounding))
    of_named = search.moments(named) if named else None
    effect = np.full((len(search.names), *difference.shape), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        for k, name in enumerate(search.names):
            if name in shares:
                effect[k] = search.moments(alone[name]).mean / sides.scale
        rest = difference if of_named is None else (sides.gap - of_named.mean) / sides.scale
    return Explanation(
        state=state,
        departures=search.departures,
        named=_ordered(search, named),
        chosen=_ordered(search, chosen),
        complete=search.complete
        or (
            bool(rounded.any())
            and all(bool(names) for names, open_ in zip(causes, search.wanted, strict=True) if open_)
        ),
        causes=tuple(_ordered(search, names) for names in causes),
        rounded=rounded,
        roles=tuple(roles[name] for name in search.names),
        alternatives=tuple(_ordered(search, names) for names in others),
        effect=effect,
        shares=tuple(shares.get(name) for name in search.names),
        of_named=search.shares(named, sides) if named else None,
        rest=rest,
        limit=limit,
        proof=growth_of_proof(search, named, sides) if state is State.LIKELY else np.inf,
        samples=samples,
        pairs=min(len(pairs) for pairs in search.pairs.values()),
        seconds=seconds,
    )


def _roles(
    search: Attribution,
    state: State,
    shares: dict[str, Shares],
    target: np.ndarray,
    sets: tuple[Names, Names, Names],
) -> dict[str, Role]:
    """What is said of each departure.

    `sets` are those named, those chosen, and those of which rounding decides how much acts.
    """
    limit = small_limit(len(search.names))
    roles = {}
    for name in search.names:
        small = name in shares and (shares[name].bound[target] < limit).all()
        roles[name] = Role.SMALL if small else Role.UNTRIED if name in search.put_off else Role.OPEN
    named, chosen, by_rounding = sets
    for name in named:
        roles[name] = {State.CAUSE: Role.CAUSE, State.LIKELY: Role.LIKELY}.get(state, Role.PARTIAL)
    for name in chosen - named:
        roles[name] = Role.PARTIAL
    for name in by_rounding:
        roles[name] = Role.LIKELY
    return roles


def _find(
    search: Attribution, sides: Sides, chosen: Names, shares: dict[str, Shares], left: np.ndarray
) -> tuple[State, Names, list[Names]]:
    """The state, the departures that it names, and the sets that are as good as these.

    The data do not distinguish those sets. `left` (N,) is not explained.
    """
    if not left.any():
        size = len(chosen)
        fits = [names for names in _sets(search, sides, shares, size) if _fits(search, sides, names, search.different)]
        proved = [n for n in search.pairs if len(n) == size and search.explained(n, sides)[search.wanted].all()]
        return State.CAUSE, chosen, [names for names in dict.fromkeys([*proved, *fits]) if names != chosen]
    limit = small_limit(len(search.names))
    if len(shares) == len(search.names) and all((one.bound[left] < limit).all() for one in shares.values()):
        return State.NO_REASON, frozenset(), []
    for size in range(1, min(_LIKELY_SIZE, len(shares)) + 1):
        fits = [names for names in _sets(search, sides, shares, size) if _fits(search, sides, names, left)]
        if fits:
            best, *others = sorted(fits, key=lambda names: search.left(names, sides))
            return State.LIKELY, best, others
    helping = {
        name
        for name, one in shares.items()
        if (one.helps & (one.value >= limit) & left).any() and not (one.harms & left).any()
    }
    if helping or chosen:
        return State.PARTIAL, _least_left(search, sides, chosen, helping), []
    return State.RULED_OUT if search.hopeless else State.OPEN, frozenset(), []


def _least_left(search: Attribution, sides: Sides, chosen: Names, helping: set[str]) -> Names:
    """`chosen` and those of `helping` with which the least is left over.

    Two departures that each explain the whole are not added up.
    """
    more = [
        frozenset(s) for size in range(min(_LIKELY_SIZE, len(helping)) + 1) for s in combinations(sorted(helping), size)
    ]
    sets = [chosen | names for names in more if chosen | names]
    return min(sets, key=lambda names: search.left(names, sides))


def _sets(search: Attribution, sides: Sides, shares: dict[str, Shares], size: int) -> list[Names]:
    """The sets of a size whose effect is known, rendered or as a sum, and may matter."""
    names = [name for name in search.acting(sides) if name in shares]
    return [frozenset(chosen) for chosen in combinations(names, size)]


def _fits(search: Attribution, sides: Sides, names: Names, left: np.ndarray) -> bool:
    """Whether a set is compatible with all that is seen, and acts.

    It acts if its share is above 0 where it is known best, and near 1 there.
    """
    if search.is_ruled_out(names, sides):
        return False
    shares = search.shares(names, sides)
    k = clearest(shares, left)
    return bool(shares.alone[0, k] > 0.0 and BAND[0] <= shares.value[k] <= BAND[1])


def clearest(shares: Shares, among: np.ndarray) -> int:
    """The region, of those marked in `among` (N,), whose share is known best.

    It is the first of the narrowest intervals.
    """
    width = np.nan_to_num(shares.alone[1] - shares.alone[0], nan=np.inf, posinf=np.inf)
    return int(np.argmin(np.where(among, width, np.inf)) if np.isfinite(width[among]).any() else np.argmax(among))


def _causes(search: Attribution, sides: Sides) -> tuple[Names, list[Names]]:
    """The best set for the whole image, and the smallest set for each region (N).

    The smallest set is the one that explains the region.
    A set that explains no region that is shown to differ is no cause of others either: those may agree without it.
    """
    wanted = search.wanted
    explained = {names: search.explained(names, sides) for names in search.pairs}
    explained = {names: where for names, where in explained.items() if (where & search.different).any()}
    if not explained:
        return frozenset(), [frozenset()] * wanted.size
    best = min(
        explained,
        key=lambda names: (-int(explained[names][wanted].sum()), len(names), search.left(names, sides)),
    )
    causes = []
    for k, open_ in enumerate(wanted):
        sets = [names for names in explained if open_ and explained[names][k]]
        # Of equal size is the one that serves the image.
        key = {names: (len(names), not names <= best, sorted(names)) for names in sets}
        causes.append(min(sets, key=key.__getitem__) if sets else frozenset())
    return best, causes


def _ordered(search: Attribution, names: Names) -> tuple[str, ...]:
    return tuple(name for name in search.names if name in names)
