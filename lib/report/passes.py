# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences and figures on the parts of the light.

Sentences are for the terminal and the report, figures for verdict.json. Parts are light passes, images with fewer
bounces, and the light of each emitter.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..comparison.compare import Comparison
from ..comparison.parts import PassChoice, WhyNot
from ..film.light_passes import LightPass
from ..film.parts import BounceLimit, EmitterLight, Part
from ..pages.formats import format_bound, format_percent
from ..relative import worst_channel
from ..verdict.outcome import Outcome
from ..verdict.passes import PassVerdict
from .language import listed, place

# Regions that are named where no pass differs in the image as a whole.
NAMED = 3


def pass_sentences(comparison: Comparison) -> list[str]:
    """Which parts of the light differ and by how much, and the bound on the others.

    Where the default left light passes out, why. Empty where none was asked for.
    """
    said, found = choice_sentences(comparison.pass_choice), comparison.passes
    if found is None:
        return said
    for kind, tell in ((LightPass, _light_passes), (BounceLimit, _bounces), (EmitterLight, _emitters)):
        numbers = np.flatnonzero([isinstance(part, kind) for part in found.passes])
        if numbers.size:
            said += tell(comparison, found, numbers)
    return said


def choice_sentences(choice: PassChoice) -> list[str]:
    """Why light passes were not compared where the default was to decide.

    Empty where they were compared, or were not wanted.
    """
    if choice.why_not is None:
        return []
    share = format_percent(float(f"{choice.cost or 0.0:.2g}"), sign=False)
    return [
        {
            WhyNot.COST: f"Light passes were not compared: they would take about {share} "
            "of Cycles' time. `--passes=all` compares them.",
            WhyNot.UNSUPPORTED: "Light passes were not compared: that is not possible beside unsupported materials.",
            WhyNot.MEMORY: "Light passes were not compared: this machine lacks the memory for them. A lower resolution needs less.",
        }[choice.why_not]
    ]


def choice_figures(choice: PassChoice) -> dict[str, Any]:
    """The choice of light passes, as plain data."""
    return {"asked": choice.asked, "passes": choice.passes, "cost": choice.cost, "why_not": choice.why_not}


def _light_passes(comparison: Comparison, found: PassVerdict, numbers: np.ndarray) -> list[str]:
    """Sentences on the light passes among the parts, by their numbers."""
    differing = [
        f"The {found.passes[k]} pass differs{_where(comparison, at)} by {_difference(found, k, at)}."
        for k, at in _differing(found, numbers)
    ]
    return [*differing, *_others(found, numbers, "light passes", "all other passes")]


def _emitters(comparison: Comparison, found: PassVerdict, numbers: np.ndarray) -> list[str]:
    """Sentences on the light of each emitter."""
    differing = [
        f"The {found.passes[k]} differs{_where(comparison, at)} by {_difference(found, k, at)}."
        for k, at in _differing(found, numbers)
    ]
    return [*differing, *_others(found, numbers, "lights", "all other lights")]


def _bounces(comparison: Comparison, found: PassVerdict, numbers: np.ndarray) -> list[str]:
    """At which bounce the two part."""
    limits = {k: part.bounces for k, part in enumerate(found.passes) if isinstance(part, BounceLimit)}
    ordered = sorted(numbers.tolist(), key=limits.__getitem__)
    differ = found.outcomes == Outcome.DIFFERENT
    first = next((k for k in ordered if differ[k, 0]), next((k for k in ordered if differ[k].any()), None))
    if first is None:
        bound = _largest(found.bounds[ordered, 0])
        if not math.isfinite(bound):
            return ["Too few samples to judge images with fewer bounces."]
        return [
            f"With {found.passes[ordered[-1]]} and with fewer the images agree to within {format_bound(bound)} as a whole."
        ]
    at = int(np.argmax(differ[first]))
    bounces, off = limits[first], _difference(found, first, at)
    where = _where(comparison, at)
    before = [k for k in ordered if limits[k] < bounces]
    if not before:
        return [f"The images differ{where} with {found.passes[first]}, the fewest that were compared, by {off}."]
    bound = _largest(found.bounds[before, at])
    agree = f"agree to within {format_bound(bound)}" if math.isfinite(bound) else "are not decided yet"
    return [
        f"The renderers part at bounce {bounces}{where}: with fewer the images {agree}, with {found.passes[first]} they differ by {off}."
    ]


def _differing(found: PassVerdict, numbers: np.ndarray) -> list[tuple[int, int]]:
    """Parts that differ in the image, the one that takes or adds most light first.

    Where there are none, the parts and regions that are furthest off.
    """
    differ = found.outcomes == Outcome.DIFFERENT
    whole = [(k, 0) for k in _by_size(found, numbers[differ[numbers, 0]], 0)]
    if whole:
        return whole
    pairs = [(k, at) for k, at in np.argwhere(differ).tolist() if k in numbers]
    return sorted(pairs, key=lambda one: -np.nanmax(np.abs(found.difference[one])))[:NAMED]


def _others(found: PassVerdict, numbers: np.ndarray, every: str, rest: str) -> list[str]:
    """How closely the parts that do not differ agree.

    `every` is their name where no part differs.
    """
    differ = found.outcomes == Outcome.DIFFERENT
    others = numbers[~differ[numbers].any(axis=1)]
    if not others.size:
        return []
    name = f"all {every}" if others.size == numbers.size else rest
    bound, everywhere = _largest(found.bounds[others, 0]), _largest(found.bounds[others])
    if math.isfinite(bound):
        told = f"{name} agree to within {format_bound(bound)} as a whole"
        is_larger = bound < everywhere < math.inf
        told += f", and to within {format_bound(everywhere)} in every region with a name." if is_larger else "."
    else:
        noisy = [str(found.passes[k]) for k in numbers if not math.isfinite(found.bounds[k, 0])]
        told = f"too few samples to judge: {listed(tuple(noisy))}."
    return [told[0].upper() + told[1:]]


def _largest(bounds: np.ndarray) -> float:
    """The largest bound of those that there are; infinite where there is none."""
    known = bounds[~np.isnan(bounds)]
    return float(known.max()) if known.size else math.inf


def _by_size(found: PassVerdict, numbers: np.ndarray, region: int) -> list[int]:
    """Passes by their numbers, the one that takes or adds most light first."""
    gap = np.abs(found.candidate[:, region] - found.reference[:, region]).sum(axis=1)
    return sorted(numbers.tolist(), key=lambda k: -gap[k])


def _where(comparison: Comparison, region: int) -> str:
    return "" if region == 0 else f" in {place(comparison, region)}"


def _difference(found: PassVerdict, k: int, region: int) -> str:
    """The difference of part k in a region with its interval, in the channel furthest off."""
    channel = worst_channel(found.difference[k, region])
    low, high = found.low[k, region, channel], found.high[k, region, channel]
    return f"{format_percent(found.difference[k, region, channel])} in {'RGB'[channel]} ({format_percent(low)} to {format_percent(high)})"


def _kind(part: Part) -> str:
    if isinstance(part, LightPass):
        return "light pass"
    return "limit of bounces" if isinstance(part, BounceLimit) else "light"


def pass_figures(comparison: Comparison) -> list[dict[str, Any]] | None:
    """Every part of the light in every region with a name, as plain data.

    None where none was compared.
    """
    found = comparison.passes
    if found is None:
        return None
    return [
        {
            "kind": _kind(name),
            "name": str(name),
            "regions": [
                {
                    "region": region,
                    "outcome": found.outcomes[k, region],
                    "bound": found.bounds[k, region],
                    "difference": found.difference[k, region],
                    "low": found.low[k, region],
                    "high": found.high[k, region],
                    "reference": found.reference[k, region],
                    "candidate": found.candidate[k, region],
                    "share": found.shares[k, region],
                    "channel": "RGB"[worst_channel(found.difference[k, region])],
                }
                for region in range(found.outcomes.shape[1])
            ],
        }
        for k, name in enumerate(found.passes)
    ]
