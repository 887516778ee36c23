# SPDX-License-Identifier: GPL-3.0-or-later
"""A verdict in one short line.

It is a template and its values, so that the line can be translated.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..comparison.compare import Comparison
from ..comparison.parts import PassChoice, WhyNot
from ..comparison.run import Stop
from ..pages.formats import format_bound, format_duration, format_percent
from ..relative import worst_channel
from ..verdict.outcome import Outcome
from .page import GRIDS
from .ranking import RankedRegion
from .words import forecast_seconds, region_total

AGREES = "Agrees with Cycles' render within {bound} everywhere"
SO_FAR = "Agrees within {bound} so far; {tolerance} is not decided yet"
NOTHING = "Too few samples to say anything yet"
DIFFERS = "Differs by {difference} on '{name}'"
PASS_DIFFERS = "{light} differs by {difference} on '{name}'"
WHOLE_DIFFERS = "Differs by {difference} in the whole image"
PASS_WHOLE_DIFFERS = "{light} differs by {difference} in the whole image"
CELL_DIFFERS = "Differs by {difference} {place}, from pixel {pixel} on"
KNOWN = "For a known reason: {causes}"
COUNT_DIFFERS = "{count} of {total} regions differ"
COUNT_NOISY = "{count} of {total} regions are too noisy to judge"
COUNT_AGREES = "{total} regions tested, {confidence} confidence"
TIME = "About {time} should decide them"
CANCELLED = "Cancelled; this is what was gathered"
LEFT_OUT = "{count} pixels are left out"
PASSES_COST = "Light passes were not compared: about {cost} of Cycles' time"
PASSES_UNSUPPORTED = "Light passes were not compared: not possible beside unsupported materials"
PASSES_MEMORY = "Light passes were not compared: too little memory"
TEMPLATES = (
    *(AGREES, SO_FAR, NOTHING, DIFFERS, PASS_DIFFERS, WHOLE_DIFFERS, PASS_WHOLE_DIFFERS, CELL_DIFFERS, KNOWN),
    *(COUNT_DIFFERS, COUNT_NOISY, COUNT_AGREES, TIME, CANCELLED, LEFT_OUT),
    *(PASSES_COST, PASSES_UNSUPPORTED, PASSES_MEMORY),
)
"""Every template, for translations."""


@dataclass(frozen=True)
class Phrase:
    """One of the TEMPLATES, and what is put into it.

    >>> str(Phrase(AGREES, {"bound": "1.3 %"}))
    "Agrees with Cycles' render within 1.3 % everywhere"
    """

    template: str
    values: dict[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        return self.template.format(**self.values)


def headline(comparison: Comparison, ranked: list[RankedRegion]) -> Phrase:
    """The verdict in one line; `ranked` as from rank_regions.

    It states the bound, or the difference that matters most and where it is.
    """
    verdict = comparison.verdict
    if verdict.outcome in (Outcome.DIFFERENT, Outcome.EXPLAINED):
        return _light(comparison) or _difference(ranked)
    explained = [region for region in ranked if region.outcome is Outcome.EXPLAINED]
    if explained:  # others are open
        return _difference(explained)
    if not math.isfinite(verdict.bound):
        return Phrase(NOTHING)
    bound = format_bound(verdict.bound)
    if verdict.outcome is Outcome.EQUIVALENT or verdict.bound <= verdict.tolerance:
        return Phrase(AGREES, {"bound": bound})
    return Phrase(SO_FAR, {"bound": bound, "tolerance": format_percent(verdict.tolerance, sign=False)})


def details(comparison: Comparison) -> list[Phrase]:
    """The lines below the headline.

    They say how many regions there are, the known reason, and the time that would decide the rest.
    """
    verdict, total, said = comparison.verdict, region_total(comparison), []
    light = _light(comparison)
    if light is not None and verdict.outcome in (Outcome.EQUIVALENT, Outcome.UNDECIDED):
        said.append(light)
    causes = comparison.explanation.chosen if comparison.explanation is not None else ()
    if verdict.outcome is Outcome.EXPLAINED and causes:
        said.append(Phrase(KNOWN, {"causes": ", ".join(causes)}))
    off = verdict.count(Outcome.DIFFERENT) + verdict.count(Outcome.EXPLAINED)
    undecided = (verdict.outcomes == Outcome.UNDECIDED) & (verdict.bounds > verdict.tolerance)
    noisy, blocked = int((undecided & ~verdict.blocked).sum()), bool((undecided & verdict.blocked).any())
    for count, template in ((off, COUNT_DIFFERS), (noisy, COUNT_NOISY)):
        if count:
            said.append(Phrase(template, {"count": str(count), "total": str(total)}))
    if not off and not noisy and not blocked:
        confidence = format_percent(verdict.confidence, sign=False)
        said.append(Phrase(COUNT_AGREES, {"total": str(total), "confidence": confidence}))
    ends = forecast_seconds(comparison)
    if comparison.stopped is Stop.CANCELLED:
        said.append(Phrase(CANCELLED))
    elif noisy and ends is not None:
        said.append(Phrase(TIME, {"time": format_duration(ends[1])}))
    left_out = int(comparison.left_out.sum())
    if left_out:
        said.append(Phrase(LEFT_OUT, {"count": str(left_out)}))
    return [*said, *_without_passes(comparison.pass_choice)]


def _without_passes(choice: PassChoice) -> list[Phrase]:
    """Why the default compared no light passes, if it did not."""
    if choice.why_not is None:
        return []
    if choice.why_not is WhyNot.COST:
        return [Phrase(PASSES_COST, {"cost": format_percent(choice.cost or 0.0, sign=False)})]
    return [Phrase(PASSES_UNSUPPORTED if choice.why_not is WhyNot.UNSUPPORTED else PASSES_MEMORY)]


def _difference(ranked: list[RankedRegion]) -> Phrase:
    """The first region that differs, one that the user gave a name before the whole image."""
    differ = [r for r in ranked if r.outcome is ranked[0].outcome]
    named = [r for r in differ if r.kind in ("material", "object")]
    worst = (named or differ)[0]
    values = {"difference": format_percent(worst.difference), "name": worst.label}
    if worst.kind == "image":
        return Phrase(WHOLE_DIFFERS, values)
    if worst.kind in GRIDS:
        place, x, y = worst.label.rsplit(" ", 2)
        return Phrase(CELL_DIFFERS, {"difference": values["difference"], "place": place, "pixel": f"{x} {y}"})
    return Phrase(DIFFERS, values)


def _light(comparison: Comparison) -> Phrase | None:
    """The light pass that adds or takes most light where it differs; None where no pass does."""
    found = comparison.passes
    if found is None:
        return None
    differ = np.argwhere(found.outcomes == Outcome.DIFFERENT).tolist()
    regions = comparison.regions.named
    differ = [(p, k) for p, k in differ if regions.kinds[k] in ("material", "object")] or differ
    if not differ:
        return None
    gap = np.abs(found.candidate - found.reference).sum(axis=2)
    p, k = max(differ, key=lambda at: gap[at[0], at[1]])
    channel = worst_channel(found.difference[p, k])
    values = {
        "light": str(found.passes[p]).capitalize(),
        "difference": format_percent(float(found.difference[p, k, channel])),
        "name": regions.names[k],
    }
    return Phrase(PASS_WHOLE_DIFFERS if regions.kinds[k] == "image" else PASS_DIFFERS, values)
