# SPDX-License-Identifier: GPL-3.0-or-later
"""The details of a verdict in words.

The same sentences serve the terminal and the report. summary.py has what an artist needs.
"""

from __future__ import annotations

import numpy as np

from ..blender_versions import describe_unchecked
from ..comparison.compare import Comparison, Side
from ..comparison.run import Stop
from ..pages.formats import format_bound, format_duration, format_part, format_percent
from ..plural import plural
from ..relative import worst_channel
from ..verdict.forecast import MOST_GROWTH
from ..verdict.outcome import Outcome
from .bound import blind_sentence, both_names, bound_title, level_sentence, setting_sentences
from .causes import cause_sentences, unexplained
from .language import listed, place
from .passes import pass_sentences

FURTHEST = 5
_ENDED = {
    Stop.DECIDED: "everything was decided",
    Stop.TIME: "the time was spent",
    Stop.REPLICATES: "the replicates asked for were done",
    Stop.CANCELLED: "it was cancelled",
    Stop.LOST: "what was open had lost pixels to samples that are not finite",
}


def title(comparison: Comparison) -> str:
    """The verdict in one sentence."""
    verdict = comparison.verdict
    names = both_names(comparison)
    limit = f"{format_percent(verdict.tolerance, sign=False)}"
    total = region_total(comparison)
    count = verdict.count(Outcome.DIFFERENT) + verdict.count(Outcome.EXPLAINED)
    if verdict.outcome is Outcome.DIFFERENT or (count and verdict.outcome is Outcome.UNDECIDED):
        most = f"; nowhere by more than {format_bound(verdict.bound)}" if np.isfinite(verdict.bound) else ""
        return f"{names[0]} differs from {names[1]} by more than {limit} in {count} of {plural(total, 'region')}{most}."
    why = comparison.explanation
    if verdict.outcome is Outcome.EXPLAINED and why is not None:
        causes = why.chosen
        known = "a known departure is" if len(causes) == 1 else "known departures are"
        return f"{names[0]} differs from {names[1]}, and {known} sufficient to explain it: {listed(causes)}."
    return bound_title(comparison)


def sentences(comparison: Comparison) -> tuple[str, ...]:
    """The details of a verdict.

    They are the verdict, its grounds, where the differences are, and what deciding the rest would cost.
    """
    verdict = comparison.verdict
    said = [title(comparison), level_sentence(comparison), _basis(comparison)]
    unchecked = describe_unchecked(comparison.blender)
    if unchecked:
        said.append(unchecked)
    if verdict.count(Outcome.DIFFERENT) or verdict.count(Outcome.EXPLAINED):
        said.append("Furthest off: " + "; ".join(_region(comparison, k) for k in furthest(comparison)) + ".")
    said += pass_sentences(comparison)
    said += cause_sentences(comparison)
    said += [f"{reason[0].upper()}{reason[1:]}." for reason in verdict.reasons if verdict.outcome is Outcome.UNDECIDED]
    if verdict.outcome is not Outcome.UNDECIDED and np.any(comparison.excluded):
        said.append(_excluded(int(comparison.excluded.sum())))
    if comparison.unknown:
        said.append(_left_out(comparison))
    said += catcher_sentences(comparison)
    said += setting_sentences(comparison)
    blind = blind_sentence(comparison)
    if blind:
        said.append(blind)
    forecast = _forecast(comparison)
    return (*said, forecast) if forecast else tuple(said)


def _excluded(count: int) -> str:
    return f"{plural(count, 'pixel')} with non-finite samples {'is' if count == 1 else 'are'} excluded."


def _left_out(comparison: Comparison) -> str:
    """The part of the image that is not compared, and the materials that cause it."""
    count, total = count_left_out(comparison), comparison.left_out.size
    named = [f"'{name}' ({what})" for name, what in comparison.unknown.items()]
    share = format_part(count / total)
    why = "they show materials that are" if comparison.passive else "light reaches them from materials that are"
    said = (
        f"{count} of {plural(total, 'pixel')} ({share}) are not compared: {why} not simulated: {listed(tuple(named))}."
    )
    return f"{said} {_elsewhere(comparison)}" if comparison.passive else said


def count_left_out(comparison: Comparison) -> int:
    """How many pixels are not compared because of unsupported materials."""
    caught = comparison.caught
    left_out = comparison.left_out if caught is None else comparison.left_out & ~caught.pixels
    return int(left_out.sum())


def catcher_sentences(comparison: Comparison) -> list[str]:
    """What is not compared of shadow catchers; nothing where there are none."""
    caught = comparison.caught
    if caught is None:
        return []
    names = listed(tuple(f"'{name}'" for name in caught.names))
    which = f"the shadow catcher{'' if len(caught.names) == 1 else 's'} {names}"
    share = format_part(caught.count / caught.pixels.size)
    return [f"{share} of the image shows {which}: shown pixels of shadow catchers are set aside."]


def _elsewhere(comparison: Comparison) -> str:
    """How much light unsupported materials may add to the compared pixels.

    It also says what the figure is based on.
    """
    verdict = comparison.verdict
    judged = verdict.unsupported[~verdict.blocked]
    most = format_bound(float(judged.max(initial=0.0)))
    return (
        f"Their light makes at most {most} of the regions that it does not keep open, if they brighten these no more than a white diffuse or "
        "a clear surface would; light that a mirror or a lens focuses is not bounded."
    )


def furthest(comparison: Comparison, count: int = FURTHEST) -> list[int]:
    """The DIFFERENT regions to name, at most `count`, or the EXPLAINED ones if there is none.

    What the user named comes first, then the largest difference.
    """
    verdict = comparison.verdict
    size = np.take_along_axis(np.abs(verdict.difference), worst_channel(verdict.difference)[:, None], 1)[:, 0]
    different = unexplained(comparison)
    if not different:
        different = np.flatnonzero(verdict.outcomes == Outcome.EXPLAINED).tolist()
    return sorted(different, key=lambda k: (comparison.regions.kinds[k] == "block", -size[k]))[:count]


def forecast_seconds(comparison: Comparison) -> tuple[float, float, float, float] | None:
    """Seconds for the whole comparison until all is decided, and until most is.

    Low end, median and high end of the forecast; then the time until most is decided. None if there is no forecast.
    """
    forecast = comparison.verdict.forecast
    if forecast is None:
        return None
    ends = forecast.low, forecast.factor, forecast.high, forecast.most
    round_ = comparison.candidate.replicates * comparison.round_seconds
    low, median, high, most = (comparison.seconds + (f - 1) * round_ for f in ends)
    return low, median, high, most


def _basis(comparison: Comparison) -> str:
    verdict, parts = comparison.verdict, []
    gone = _gone(comparison)
    for outcome in Outcome:
        count = verdict.count(outcome) - (gone if outcome is Outcome.UNDECIDED else 0)
        if count:
            parts.append(f"{count} {outcome.value}")
    if gone:
        parts.append(f"{gone} without a pixel to compare")
    a, b = comparison.reference, comparison.candidate
    return (
        f"Of {plural(verdict.outcomes.size, 'region')}: {', '.join(parts)}; confidence {format_percent(verdict.confidence, sign=False)} "
        f"for all of them together, from {_drawn(a)} and {_drawn(b)} samples per pixel "
        f"in {format_duration(comparison.seconds)}, when {_end(comparison)}."
    )


def _end(comparison: Comparison) -> str:
    if comparison.stopped is Stop.DECIDED and comparison.verdict.blocked.any():
        return "everything that samples can decide was decided"
    return _ENDED[comparison.stopped]


def region_total(comparison: Comparison) -> int:
    """How many regions have a pixel to compare."""
    return comparison.verdict.outcomes.size - _gone(comparison)


def _gone(comparison: Comparison) -> int:
    """How many undecided regions have lost all of their pixels."""
    verdict = comparison.verdict
    return int(((verdict.excluded == comparison.regions.sizes) & (verdict.outcomes == Outcome.UNDECIDED)).sum())


def _drawn(side: Side) -> str:
    """Replicates times samples of a side.

    They are given for the whole image, and for the parts that were sampled longest.
    """
    count = str(side.replicates) if side.whole == side.replicates else f"{side.whole} to {side.replicates}"
    return f"{count} x {side.film.samples}"


def _region(comparison: Comparison, k: int) -> str:
    verdict = comparison.verdict
    channel = worst_channel(verdict.difference[k])
    low, high = verdict.low[k, channel], verdict.high[k, channel]
    return (
        f"{place(comparison, k)} {format_percent(verdict.difference[k, channel])} in {'RGB'[channel]} "
        f"({format_percent(low)} to {format_percent(high)})"
    )


def _forecast(comparison: Comparison) -> str:
    """What more time would show, or why that is unknown."""
    verdict, forecast, ends = comparison.verdict, comparison.verdict.forecast, forecast_seconds(comparison)
    if forecast is None or ends is None:
        if (
            verdict.outcome is not Outcome.UNDECIDED
            or not np.isfinite(verdict.bound)
            or verdict.bound <= verdict.tolerance
        ):
            return ""
        noisy = (verdict.outcomes == Outcome.UNDECIDED) & ~verdict.blocked
        if not noisy.any():
            return "No forecast: more time decides no region that an unsupported material keeps open."
        worst = place(comparison, int(np.nanargmax(np.where(noisy, verdict.bounds, -np.inf))))
        return f"No forecast: within {MOST_GROWTH:g} times the time so far nothing better can be promised; {worst} is too noisy."
    low, median, high, nearly = ends
    count, bound = forecast.regions, forecast.bound
    samples = comparison.candidate.film.samples * comparison.candidate.replicates * forecast.factor
    what = f"{format_bound(bound)} everywhere"
    before = f"; for nine in ten of the {count} open regions after {format_duration(nearly)}" if count >= 10 else ""
    return (
        f"Forecast: {what} after about {format_duration(median)} ({format_duration(low)} to {format_duration(high)}), "
        f"{float(f'{samples:.2g}'):,.0f} samples per pixel of {comparison.candidate.name}{before}."
    )
