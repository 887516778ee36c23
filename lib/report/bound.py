# SPDX-License-Identifier: GPL-3.0-or-later
"""How closely both sides agree, in words.

These are the bound, level by level, and what it cannot exclude.
"""

from __future__ import annotations

import math

import numpy as np

from ..comparison.compare import Comparison
from ..pages.formats import format_bound, format_percent
from ..plural import plural
from ..verdict.outcome import Outcome
from .language import listed, place

# Above this shape of its tail the noise of a region's replicates has no variance to rely on (Vehtari et al. 2024: 0.7).
HEAVY = 0.7
# A larger bound excludes nothing that a reader would think of: not even a candidate that is black.
TELLING = 1.0
_PLURALS = {"facing": "facing bands"}


def both_names(comparison: Comparison) -> tuple[str, str]:
    """The candidate and the reference, as sentences call them."""
    candidate, reference = (
        f"the {side.name}" if side.name == "reference" else side.name
        for side in (comparison.candidate, comparison.reference)
    )
    return candidate, reference


def bound_title(comparison: Comparison) -> str:
    """The headline of a comparison that found no difference."""
    verdict = comparison.verdict
    names = both_names(comparison)
    sure = f"({format_percent(verdict.confidence, sign=False)} confidence)"
    limit = format_percent(verdict.tolerance, sign=False)
    if verdict.outcome is Outcome.EQUIVALENT:
        return f"{names[0]} agrees with {names[1]} to within {format_bound(verdict.bound)} everywhere {sure}."
    if not math.isfinite(verdict.bound):
        return f"Whether {names[0]} agrees with {names[1]} is not known: there is no bound on the difference yet."
    if verdict.bound > TELLING:
        return (
            f"Whether {names[0]} agrees with {names[1]} is not known yet: "
            f"somewhere the bound on the difference is {format_bound(verdict.bound)}."
        )
    if verdict.bound <= verdict.tolerance:
        return f"{names[0]} agrees with {names[1]} to within {format_bound(verdict.bound)} wherever they can be compared {sure}."
    return (
        f"{names[0]} agrees with {names[1]} to within {format_bound(verdict.bound)} everywhere {sure}; "
        f"whether to within {limit} is not decided yet."
    )


def level_names(comparison: Comparison) -> list[tuple[int, str]]:
    """The levels of regions that there are, from coarse to fine.

    Their names are those that sentences use, in the plural.
    """
    regions = comparison.regions
    named = []
    for family in np.unique(regions.families).tolist():
        members = np.flatnonzero(regions.families == family)
        if family == 0:
            named.append((family, "the whole image"))
        elif family == 1:
            kinds = list(dict.fromkeys(regions.kinds[k] for k in members))
            named.append((family, listed(tuple(_PLURALS.get(kind, f"{kind}s") for kind in kinds))))
        else:
            box = regions.boxes[members]
            edge = int(max((box[:, 2] - box[:, 0]).max(), (box[:, 3] - box[:, 1]).max())) + 1
            named.append((family, f"cells of {edge} x {edge} pixels"))
    return named


def level_sentence(comparison: Comparison) -> str:
    """What is shown of each level of regions.

    It says how many regions agree to within the tolerance, and the bound on the others.
    """
    verdict, said = comparison.verdict, []
    for family, name in level_names(comparison):
        members = (verdict.families == family) & ~np.isnan(verdict.bounds)
        agree = members & (verdict.outcomes == Outcome.EQUIVALENT)
        total, count = int(members.sum()), int(agree.sum())
        if not total:
            continue
        if count == total:
            said.append(name if family == 0 else f"all {total} {name}" if total > 1 else f"the only one of the {name}")
            continue
        others = float(verdict.bounds[members & ~agree].max())
        limit = f"to within {format_bound(others)}" if math.isfinite(others) else "without a bound yet"
        if family == 0:
            said.append(f"{name} only {limit}")
        else:
            rest = "each" if not count else "the other" if total - count == 1 else f"the other {total - count}"
            said.append(f"{count} of {total} {name}, {rest} {limit}")
    if not said:
        return "No pixel is left to compare."
    return f"Within {format_percent(verdict.tolerance, sign=False)}: {'; '.join(said)}."


def blind_sentence(comparison: Comparison) -> str | None:
    """What a claim of agreement does not exclude; None where it excludes everything."""
    verdict = comparison.verdict
    agree = (verdict.outcomes == Outcome.EQUIVALENT) & (verdict.blind > 0)
    if not agree.any():
        return None
    worth = float(f"{verdict.blind[agree].min():.1g}")
    return (
        f"Blind spot: light that arrives only in samples of more than {worth:,.0f} times a region's mean, too rare for any to have been met, "
        "is not excluded."
    )


def setting_sentences(comparison: Comparison) -> list[str]:
    """Sentences on settings of the comparison that the user might not expect.

    They are on size, dark regions, and claims that were withdrawn.
    """
    verdict, said = comparison.verdict, []
    height, width = comparison.regions.shape
    if comparison.divisor > 1:
        said.append(
            f"Compared at {width} x {height} pixels, {comparison.divisor} times narrower and lower than the scene asks for: the time is too "
            "short for the whole size (an image size of 'full' insists on it)."
        )
    said += _caustics(comparison)
    dark = int((verdict.dark & ~np.isnan(verdict.bounds)).sum())
    if dark:
        are = "is" if dark == 1 else "are"
        said.append(
            f"{plural(dark, 'region')} {are} darker than a thousandth of the image's median; there, differences are relative to that."
        )
    if verdict.withdrawn:
        count = len(verdict.withdrawn)
        said.append(
            f"{plural(count, 'claim')} of earlier looks {'was' if count == 1 else 'were'} withdrawn when later samples did not bear "
            f"{'it' if count == 1 else 'them'} out."
        )
    tails = int((verdict.shapes > HEAVY).sum())
    if tails:
        have = "has" if tails == 1 else "have"
        said.append(f"{plural(tails, 'region')} {have} noise with heavy tails (Pareto shape above {HEAVY:g}).")
    return said


def _caustics(comparison: Comparison) -> list[str]:
    """How much of the light path tracing can hardly find, where that matters."""
    share, verdict = comparison.caustics, comparison.verdict
    if share is None:
        return []
    # Caustics of wide lamps are met as any other light is; only what keeps a region open is told.
    much = (share > verdict.tolerance) & verdict.is_rare
    if not much.any():
        return []
    most = int(np.argmax(np.where(much, share, 0.0)))
    return [
        f"Caustics, found by tracing light from the lamps, give more than {format_percent(verdict.tolerance, sign=False)} of the light of "
        f"{plural(int(much.sum()), 'region')}, most in {place(comparison, most)}: at most {format_bound(float(share[most]))}. "
        "A path from the camera seldom meets such light, so they stay undecided until there are samples enough."
    ]
