# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences on causes.

They are the same for the terminal, the panel, the report and verdict.json.
"""

from __future__ import annotations

import math

import numpy as np

from ..comparison.compare import Comparison
from ..comparison.run import Stop
from ..pages.formats import format_duration, format_part, format_percent
from ..plural import plural
from ..relative import worst_channel
from ..verdict.causes import BAND, Explanation, Role, Shares, State
from ..verdict.explain import clearest
from ..verdict.outcome import Outcome
from .language import listed, place


def unexplained(comparison: Comparison) -> list[int]:
    """The regions that differ and that no departure explains."""
    return np.flatnonzero(comparison.verdict.outcomes == Outcome.DIFFERENT).tolist()


def is_shown(explanation: Explanation, departure: int) -> bool:
    """Whether the statement on a departure, by its number, is a claim and not an estimate.

    The interval of a claim is simultaneous.
    """
    return explanation.roles[departure] in (Role.CAUSE, Role.PARTIAL, Role.SMALL)


def strongest(comparison: Comparison, shares: Shares | None) -> int:
    """The region for which the shares of a departure, or of what is named, are given.

    That is where they are known best, among the regions that differ, those without an explanation if there are any; the first, where
    nothing was rendered or nothing differs.
    """
    return 0 if shares is None else clearest(shares, _differs(comparison))


def proof_seconds(comparison: Comparison) -> float:
    """Seconds for the whole comparison until a likely cause is proved.

    Infinite where no such time can be foreseen.
    """
    why = comparison.explanation
    if why is None or not math.isfinite(why.proof):
        return math.inf
    more = comparison.candidate.replicates * comparison.round_seconds + why.seconds
    return comparison.seconds + (why.proof - 1.0) * more


def cause_sentences(comparison: Comparison) -> list[str]:
    """Sentences on the causes that were found; empty where no region differs.

    A region that differs always has a sentence.
    """
    why, left = comparison.explanation, len(unexplained(comparison))
    if why is None:
        return [f"Unexplained: {_differ(left)}. Departures were not searched."] if left else []
    said = _SENTENCES[why.state](comparison, why)
    apart = tuple(name for name in why.chosen if name not in why.named)
    if apart:
        said.insert(
            0,
            f"Partial {'cause' if len(apart) == 1 else 'causes'}: {listed(apart)}.{_explains(comparison, left, len(apart))}",
        )
    number = {departure.name: departure for departure in why.departures}
    return [*said, *(f"{name}: {number[name].statement}" for name in (*apart, *why.named))]


def _differs(comparison: Comparison) -> np.ndarray:
    """The regions (N,) that differ; those without an explanation, if there are any."""
    outcomes = comparison.verdict.outcomes
    left = outcomes == Outcome.DIFFERENT
    return left if left.any() else outcomes == Outcome.EXPLAINED


def share_text(comparison: Comparison, shares: Shares, k: int, shown: bool) -> str:
    """A share and its interval in region k.

    The interval is simultaneous if `shown`, else for this share alone.
    """
    low, high = (shares.low[k], shares.high[k]) if shown else shares.alone[:, k]
    ends = f"{format_part(low)} to {format_part(high)}" if math.isfinite(high - low) else "no bound yet"
    alone = (
        ""
        if shown
        else f", {format_percent(comparison.verdict.confidence, sign=False)} confidence for this share alone"
    )
    return f"{format_part(shares.value[k])} of the difference in {place(comparison, k)} ({ends}{alone})"


def _differ(count: int) -> str:
    return f"{plural(count, 'region')} {'differs' if count == 1 else 'differ'}"


def _of_named(comparison: Comparison, why: Explanation, shown: bool) -> str:
    if why.of_named is None:
        raise ValueError("no departure is named, so there is no share to tell")
    return share_text(comparison, why.of_named, strongest(comparison, why.of_named), shown)


def _rivals(why: Explanation) -> list[str]:
    if not why.alternatives:
        return []
    sets = [" with ".join(names) for names in (why.named, *why.alternatives)]
    return [f"{' or '.join(sets)}: the data do not tell them apart."]


def _cause(comparison: Comparison, why: Explanation) -> list[str]:
    one = len(why.named) == 1
    limit = format_percent(comparison.verdict.tolerance, sign=False)
    head = f"{'Cause' if one else 'Causes, together'}: {listed(why.named)}."
    does = f"{'It is' if one else 'They are'} sufficient to explain every region that differs: with {'it' if one else 'them'}, "
    agrees = f"the reference agrees with {comparison.candidate.name} to within {limit}"
    return [f"{head} {does}{agrees}, and accounts for {_of_named(comparison, why, True)}.", *_rivals(why)]


def _partial(comparison: Comparison, why: Explanation) -> list[str]:
    left, k = len(unexplained(comparison)), strongest(comparison, why.of_named)
    one = len(why.named) == 1
    channel = int(worst_channel(why.rest[k]))
    over = f"{format_percent(why.rest[k, channel])} is left over there, in {'RGB'[channel]}"
    does = _explains(comparison, left, len(why.named))
    head = f"Partial {'cause' if one else 'causes, together'}: {listed(why.named)}."
    return [
        f"{head} {'It accounts' if one else 'They account'} for {_of_named(comparison, why, True)}; {over}.{does}",
        f"Unexplained: {_differ(left)} for reasons that are not known in full.",
        *_contradictions(comparison, why),
    ]


def _explains(comparison: Comparison, left: int, names: int) -> str:
    """How many of the regions that differ are explained, without those that are open.

    Empty where none is.
    """
    count = comparison.verdict.count(Outcome.EXPLAINED)
    whole = plural(count + left, "region")
    return f" {'It explains' if names == 1 else 'They explain'} {count} of the {whole} that differ." if count else ""


def _rounded(comparison: Comparison, why: Explanation) -> list[str]:
    count = int((why.rounded & (comparison.verdict.outcomes == Outcome.EXPLAINED)).sum())
    whole = comparison.verdict.count(Outcome.EXPLAINED)
    where = plural(count, "region") if count == whole else f"{count} of the {whole} regions that differ"
    names = {name for names, here in zip(why.causes, why.rounded, strict=True) if here for name in names}
    beside = names - {departure.name for departure in why.departures if departure.by_rounding}
    full = (
        f" Beside it, {listed(tuple(sorted(beside)))} {'acts' if len(beside) == 1 else 'act'} in full."
        if beside
        else ""
    )
    return [
        f"Explained by the scene: {listed(tuple(sorted(names - beside)))}. Rounding in single precision, or how Cycles weighs light "
        f"samples, decides how much of it acts. In {where}, {comparison.candidate.name} lies between the reference with this departure "
        f"and the reference without it.{full}"
    ]


def _likely(comparison: Comparison, why: Explanation) -> list[str]:
    one = len(why.named) == 1
    head = f"Likely {'cause' if one else 'causes, together'}, not proved yet: {listed(why.named)}."
    does = f"{'It accounts' if one else 'They account'} for {_of_named(comparison, why, False)}."
    return [f"{head} {does} {_proof(comparison, why)}", *_rivals(why)]


def _proof(comparison: Comparison, why: Explanation) -> str:
    whole = proof_seconds(comparison)
    if not math.isfinite(whole):
        return "What a proof would cost cannot be told from so few samples."
    return f"A proof should take about {format_duration(whole)} in all, {_times(why.proof)} the replicates."


def _times(growth: float) -> str:
    return f"{growth:.2g} times" if growth < 100 else f"{float(f'{growth:.2g}'):,.0f} times"


def _no_reason(comparison: Comparison, why: Explanation) -> list[str]:
    names = tuple(departure.name for departure in why.departures)
    less = f"{'it is' if len(names) == 1 else 'each is'} shown to account for less than {format_part(why.limit)} of the difference"
    return [
        f"Unexplained: {_differ(len(unexplained(comparison)))} for no known reason. Tried: {listed(names)}; {less}.",
    ]


def _ruled_out(comparison: Comparison, why: Explanation) -> list[str]:
    left = _differ(len(unexplained(comparison)))
    return [
        f"Unexplained: {left}, and no set of the departures that apply fits what was measured. {_estimates(comparison, why)}",
        *_contradictions(comparison, why),
    ]


def _contradictions(comparison: Comparison, why: Explanation) -> list[str]:
    """Why a departure whose share is near 1 somewhere is not the whole cause.

    It names regions where its share is shown to be another.
    """
    said = []
    for departure, shares in zip(why.departures, why.shares, strict=True):
        if shares is None or not BAND[0] <= shares.value[fits := strongest(comparison, shares)] <= BAND[1]:
            continue
        off = shares.off & _differs(comparison)
        if off.any():
            worst = int(np.argmax(np.where(off, np.abs(np.nan_to_num(shares.value) - 1.0), -1.0)))
            part = f"{format_part(shares.value[worst])} of the difference in {place(comparison, worst)}"
            fit = f"it fits {place(comparison, fits)}"
            said.append(f"{departure.name} is not the whole cause: {fit}, but accounts for {part}.")
    return said


def _open(comparison: Comparison, why: Explanation) -> list[str]:
    left = _differ(len(unexplained(comparison)))
    return [
        f"Unexplained so far: {left}. The shares of the departures that apply are too noisy to name a cause or to rule one out. "
        f"{_estimates(comparison, why)}"
    ]


def _estimates(comparison: Comparison, why: Explanation) -> str:
    """The share of each departure where it is known best, the largest first."""

    def size(k: int) -> float:
        shares = why.shares[k]
        return -1.0 if shares is None else float(np.nan_to_num(abs(shares.value[strongest(comparison, shares)])))

    said = []
    for k in sorted(range(len(why.departures)), key=size, reverse=True):
        name, shares = why.departures[k].name, why.shares[k]
        known = shares and share_text(comparison, shares, strongest(comparison, shares), is_shown(why, k))
        said.append(f"{name}: {known or 'not measured'}")
    return "; ".join(said) + "."


def _no_time(comparison: Comparison, why: Explanation) -> list[str]:
    names = listed(tuple(departure.name for departure in why.departures))
    reason = "the comparison was cancelled" if comparison.stopped is Stop.CANCELLED else "no time was left"
    left = _differ(len(unexplained(comparison)))
    return [f"Unexplained: {left}. The departures that apply ({names}) were not measured: {reason}."]


def _no_departure(comparison: Comparison, why: Explanation) -> list[str]:
    left = _differ(len(unexplained(comparison)))
    return [f"Unexplained: {left}, and no known departure of Cycles applies to this scene."]


_SENTENCES = {
    State.CAUSE: _cause,
    State.PARTIAL: _partial,
    State.LIKELY: _likely,
    State.ROUNDED: _rounded,
    State.NO_REASON: _no_reason,
    State.RULED_OUT: _ruled_out,
    State.OPEN: _open,
    State.NO_TIME: _no_time,
    State.NO_DEPARTURE: _no_departure,
}
