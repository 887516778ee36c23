# SPDX-License-Identifier: GPL-3.0-or-later
"""A comparison in three sentences for an artist.

They are the same on the terminal, in the panel and in the report. The whole picture comes first, then what differs or
is too noisy and where, then what to do next.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..comparison.compare import Comparison
from ..comparison.run import Stop
from ..pages.formats import format_bound, format_duration, format_part, format_percent
from ..plural import plural
from ..relative import worst_channel
from ..scene.findings import Finding
from ..verdict.outcome import Outcome
from .bound import TELLING, both_names
from .causes import proof_seconds, unexplained
from .language import listed, place
from .words import catcher_sentences, count_left_out, forecast_seconds, furthest, region_total

_CHANNELS = ("red", "green", "blue")
# Regions with a name of the user's that are given, and cells of the picture.
NAMED, CELLS = 2, 1


def summarize(comparison: Comparison) -> tuple[str, str, str]:
    """The whole picture; what differs or is too noisy, and where; what to do next."""
    return whole_picture(comparison), open_places(comparison), next_step(comparison)


def whole_picture(comparison: Comparison) -> str:
    """The file's name, the verdict, and how far the whole picture is off at most."""
    verdict, (candidate, reference) = comparison.verdict, both_names(comparison)
    head = f"{comparison.scene}: {verdict.outcome.value}."
    bound, outcome = float(verdict.bounds[0]), verdict.outcomes[0]
    limit = format_percent(verdict.tolerance, sign=False)
    agrees = verdict.outcome in (Outcome.EQUIVALENT, Outcome.UNDECIDED) and not verdict.count(Outcome.EXPLAINED)
    if agrees and verdict.bound <= TELLING:
        sure = f"with {format_percent(verdict.confidence, sign=False)} confidence"
        rest = "" if verdict.outcome is Outcome.EQUIVALENT else f"; whether to within {limit} is not known yet"
        return f"{head} {candidate} agrees with {reference} to within {format_bound(verdict.bound)} everywhere, {sure}{rest}."
    if outcome in (Outcome.DIFFERENT, Outcome.EXPLAINED):
        channel = int(worst_channel(verdict.difference[0]))
        off = float(verdict.difference[0, channel])
        brighter = "brighter" if off > 0 else "darker"
        size = format_part(abs(off))
        return f"{head} The whole picture is {size} {brighter} in {candidate} than in {reference}, most in {_CHANNELS[channel]}."
    if not bound <= TELLING:
        return f"{head} There are too few samples to say anything about the whole picture."
    if outcome is Outcome.EQUIVALENT:
        return f"{head} As a whole, the picture agrees to within {format_bound(bound)}."
    return f"{head} As a whole, the picture agrees to within {format_bound(bound)}; {limit} is not reached yet."


def open_places(comparison: Comparison) -> str:
    """What differs or cannot be judged, and where; what was tested where nothing does."""
    verdict, total = comparison.verdict, region_total(comparison)
    limit, said = format_percent(verdict.tolerance, sign=False), []
    off = verdict.count(Outcome.DIFFERENT) + verdict.count(Outcome.EXPLAINED)
    if off:
        differs = "differs" if off == 1 else "differ"
        order = [k for k in furthest(comparison, len(comparison.regions)) if k]
        where = _places(comparison, order, _signed)
        said.append(f"{off} of {plural(total, 'region')} {differs} by more than {limit}{where}.")
    # One whose bound is within the tolerance is not proved together with all others, but it is no place to look at.
    open_regions = (verdict.outcomes == Outcome.UNDECIDED) & (verdict.bounds > verdict.tolerance)
    still = np.flatnonzero(open_regions & ~verdict.blocked)
    if still.size:
        are = "is" if still.size == 1 else "are"
        order = [k for k in still[np.argsort(-verdict.bounds[still], kind="stable")].tolist() if k]
        where = "" if off else _places(comparison, order, _limited)
        said.append(f"{still.size} of {plural(total, 'region')} {are} too noisy to judge{where}.")
    blocked = int((open_regions & verdict.blocked).sum())
    if blocked:
        are = "is" if blocked == 1 else "are"
        said.append(f"{blocked} of {plural(total, 'region')} {are} open because of an unsupported material.")
    if not said:
        said.append(f"No part of the picture is off by more than {limit}: {plural(total, 'region')} tested.")
    return " ".join([*said, *_replaced(comparison), *_masked(comparison)])


def next_step(comparison: Comparison) -> str:
    """What to do next."""
    verdict = comparison.verdict
    if comparison.stopped is Stop.CANCELLED:
        return "Next: run it again and let it finish; it was cancelled."
    faults = scene_faults(comparison)
    if faults:
        more = [fault.check for fault in faults[1:]]
        also = f" The scene check names {listed(tuple(more))}, too." if more else ""
        return f"Next: repair the scene, then compare again. {faults[0].what} {faults[0].remedy}{also}"
    if verdict.outcome is Outcome.EQUIVALENT:
        return "Next: nothing is left to do."
    why = comparison.explanation
    if verdict.outcome is Outcome.EXPLAINED and why is not None:
        names = why.chosen
        if why.rounded.any():
            return (
                f"Next: change the scene where the scene check says so; it explains the difference ({listed(names)})."
            )
        return (
            f"Next: nothing is wrong in your scene. {comparison.candidate.name} is known to differ so ({listed(names)}); "
            "the report says where and why."
        )
    if verdict.outcome is Outcome.DIFFERENT:
        return _next_of_difference(comparison)
    return _next_of_noise(comparison)


def scene_faults(comparison: Comparison) -> list[Finding]:
    """The findings about the scene that departures which explain a difference come from."""
    why = comparison.explanation
    if why is None:
        return []
    checks = {departure.finding for departure in why.departures if departure.name in why.chosen}
    return [finding for finding in comparison.findings if finding.check in checks]


def _next_of_difference(comparison: Comparison) -> str:
    why = comparison.explanation
    if _replaced(comparison):
        return "Next: look at these places in the report. To see what is Cycles' own, compare without the other model of Glossy nodes, too."
    seconds = proof_seconds(comparison)
    if why is not None and why.named and math.isfinite(seconds):
        return f"Next: allow about {format_duration(seconds)} to prove the likely cause, {listed(why.named)}."
    if why is not None and why.chosen:
        left = plural(len(unexplained(comparison)), "region")
        return f"Next: {listed(why.chosen)} explains a part; look at the other {left} in the report."
    if comparison.findings:
        checks = listed(tuple(dict.fromkeys(finding.check for finding in comparison.findings)))
        return f"Next: look at the scene check first ({checks}), then at these places in the report."
    return "Next: look at these places in the report. No known cause explains them; unexplained.blend is the smallest scene that shows it."


def _next_of_noise(comparison: Comparison) -> str:
    ends, forecast = forecast_seconds(comparison), comparison.verdict.forecast
    open_regions = comparison.verdict.outcomes == Outcome.UNDECIDED
    if comparison.verdict.blocked.any() and comparison.verdict.blocked[open_regions].all():
        return "Next: replace the unsupported material to judge the rest; more time shows no more."
    if ends is None or forecast is None:
        return "Next: allow much more time, or accept a larger tolerance; so few samples tell no more."
    low, median, high, _ = ends
    goal = format_bound(forecast.bound)
    span = f"{format_duration(low)} to {format_duration(high)}"
    return f"Next: allow about {format_duration(median)} ({span}) to know it to within {goal} everywhere."


def _replaced(comparison: Comparison) -> list[str]:
    """The model that took the place of Glossy nodes in the reference, by choice."""
    settings = comparison.reference.settings
    model, term = settings.get("model"), settings.get("fresnel", "none")
    chosen = [*([str(model)] if model is not None else []), *([f"Fresnel {term}"] if term != "none" else [])]
    return [f"Glossy nodes have another model in the reference, by choice: {', '.join(chosen)}."] if chosen else []


def _masked(comparison: Comparison) -> list[str]:
    """The pixels that were not compared, and why."""
    left_out, broken = count_left_out(comparison), int(comparison.excluded.sum())
    said = catcher_sentences(comparison)
    if left_out:
        why = "they show unsupported materials" if comparison.passive else "unsupported materials can affect them"
        said.append(f"{plural(left_out, 'pixel')} left out: {why}.")
    if broken:
        said.append(f"{plural(broken, 'pixel')} left out: a renderer gave no finite number there.")
    return said


def _places(comparison: Comparison, order: list[int], describe: Callable[[Comparison, int], str]) -> str:
    """The first regions of `order`: what the user gave a name, then a cell of the picture."""
    kinds = comparison.regions.kinds
    is_cell = {k: kinds[k] in ("block", "cell") for k in order}
    named = [k for k in order if not is_cell[k]]
    named = [k for k in named if kinds[k] != "facing"] or named
    shown = [*named[:NAMED], *[k for k in order if is_cell[k]][:CELLS]]
    return f", most of all {listed(tuple(describe(comparison, k) for k in shown))}" if shown else ""


def _signed(comparison: Comparison, k: int) -> str:
    channel = int(worst_channel(comparison.verdict.difference[k]))
    return f"{_where(comparison, k)} ({format_percent(comparison.verdict.difference[k, channel])})"


def _limited(comparison: Comparison, k: int) -> str:
    bound = float(comparison.verdict.bounds[k])
    known = f"known to within {format_bound(bound)}" if math.isfinite(bound) else "nothing is known yet"
    return f"{_where(comparison, k)} ({known})"


def _where(comparison: Comparison, k: int) -> str:
    """A region as an artist would point to it: by its name, or by its place in the picture."""
    if comparison.regions.kinds[k] not in ("block", "cell"):
        return place(comparison, k)
    return f"the {describe_box(tuple(comparison.regions.boxes[k].tolist()), comparison.regions.shape)} of the picture"


def describe_box(box: tuple[int, int, int, int], shape: tuple[int, int]) -> str:
    """Where a box of pixels lies in an image of the given shape (height, width).

    The box is first column, first row, last column, last row.

    >>> describe_box((0, 0, 15, 15), (240, 320)), describe_box((150, 100, 165, 115), (240, 320))
    ('top left', 'centre')
    """
    height, width = shape
    row = ("top", "", "bottom")[min(3 * (box[1] + box[3] + 1) // (2 * height), 2)]
    column = ("left", "", "right")[min(3 * (box[0] + box[2] + 1) // (2 * width), 2)]
    return " ".join(filter(None, (row, column))) or "centre"
