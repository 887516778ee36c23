# SPDX-License-Identifier: GPL-3.0-or-later
"""What a fit found, in lines for a terminal and as plain data."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..plural import plural
from .candidates import FRESNELS
from .identify import LEVEL, Identification
from .solve import Solution

_MASKING = {"correlated": "correlated Smith", "separable": "separable Smith", "torrance_sparrow": "Torrance-Sparrow"}
_FRESNEL = {"none": "no Fresnel term", "schlick": "Schlick's Fresnel term", "exact": "exact Fresnel term"}


def fit_lines(found: Identification) -> list[str]:
    """The answer in lines.

    It has the model, its parameters with intervals, whether it fits, and what cannot be told.
    """
    seen, best = found.seen, found.best
    lines = [
        f"{seen.source}: {plural(seen.values.shape[1], 'value')} in {plural(seen.colors, 'colour')}",
        *_verdict(found),
        "",
        *(_row(name, value, found.intervals[name]) for name, value in best.named.items()),
    ]
    if "1/g" not in best.named:
        middle, low, high = found.inverse_g
        lines.append(_row("1/g", middle, (low, high)) + "  if a Student-t distribution; GGX 0.5, Beckmann 0")
    what = "colour" if best.candidate.fresnel == "none" else "F0"
    lines += [f"  {what:<12} {_numbers(found.reflectances())}"]
    if best.candidate.fresnel == "exact":
        lines += [f"  {'index':<12} " + ", ".join(f"{ior:.3g} + {k:.3g} i" for ior, k in found.indices())]
    lines += [f"  {'diffuse':<12} {_numbers(best.linear[:, 0])}", ""]
    return [line.rstrip() for line in lines + _alternatives(found)]


def _verdict(found: Identification) -> list[str]:
    name = describe(found.best)
    test = f"chi^2 {found.best.chi2:,.0f} for {found.seen.values.size:,} values, p = {found.p_value:.2g}"
    if found.fits:
        return [f"{name}: explains the data ({test})"]
    return [
        f"none of these models explains the data ({test})",
        f"the nearest is {name}; its intervals below assume that it is right",
    ]


def _row(name: str, value: float, interval: tuple[float, float]) -> str:
    shown = "alpha_x/_y" if name == "anisotropy" else name
    return f"  {shown:<12} {value:.5g}  95 %: {interval[0]:.5g} to {interval[1]:.5g}"


def _numbers(values: np.ndarray) -> str:
    return "  ".join(f"{value:.4g}" for value in values)


def _alternatives(found: Identification) -> list[str]:
    others = [one for one in found.equivalent if one is not found.best]
    lines = [f"this data cannot tell the {what}: {', '.join(names)}" for what, names in untold(found).items()]
    if others:
        lines.append("as good, by chi^2:")
        lines += [
            f"  {describe(one)}: {one.chi2 - found.best.chi2:+.1f}, alpha {one.named['alpha']:.5g}" for one in others
        ]
    rejected = next((one for one in found.solutions if one not in found.equivalent), None)
    if rejected is not None:
        lines.append(f"next: {describe(rejected)}: chi^2 {rejected.chi2 - found.best.chi2:+,.1f}")
    return lines


def describe(one: Solution) -> str:
    """A model in words."""
    candidate = one.candidate
    return f"{candidate.distribution}, {_MASKING[candidate.masking]} masking, {_FRESNEL[candidate.fresnel]}"


def untold(found: Identification) -> dict[str, list[str]]:
    """The parts of the model that the data cannot tell, with their possible values.

    A part is a distribution, a masking or a Fresnel term. Models are compared that are alike in the other two.
    """
    best, result = found.best.candidate, {}
    fields = {"distribution": "distribution", "masking": "masking", "Fresnel term": "fresnel"}
    for what, field in fields.items():
        rest = [other for other in fields.values() if other != field]
        alike = [
            getattr(one.candidate, field)
            for one in found.equivalent
            if all(getattr(one.candidate, other) == getattr(best, other) for other in rest)
        ]
        if field == "fresnel" and not found.seen.tells_fresnel:
            alike = list(FRESNELS)
        if len(alike) > 1:
            result[what] = sorted(alike)
    return result


def fit_figures(found: Identification) -> dict[str, Any]:
    """The same as plain data, all candidates with it."""
    middle, low, high = found.inverse_g
    return {
        "source": found.seen.source,
        "values": int(found.seen.values.shape[1]),
        "colours": found.seen.colors,
        "noise": found.seen.noise,
        "fits": found.fits,
        "p_value": found.p_value,
        "level": LEVEL,
        "best": _figures(found, found.best) | {"intervals": {k: list(v) for k, v in found.intervals.items()}},
        "inverse_g": {"value": middle, "interval": [low, high]},
        "reflectances": found.reflectances().tolist(),
        "indices": found.indices().tolist() if found.best.candidate.fresnel == "exact" else None,
        "cannot_tell": untold(found),
        "candidates": [_figures(found, one) for one in found.solutions],
    }


def _figures(found: Identification, one: Solution) -> dict[str, Any]:
    candidate = one.candidate
    return {
        "distribution": candidate.distribution,
        "masking": candidate.masking,
        "fresnel": candidate.fresnel,
        "parameters": one.named,
        "diffuse": one.linear[:, 0].tolist(),
        "chi2": one.chi2,
        "equivalent": one in found.equivalent,
    }
