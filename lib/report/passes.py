# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of light passes: sentences for the terminal and the report, and figures for verdict.json."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..comparison.compare import Comparison
from ..pages.formats import format_bound, format_percent
from ..relative import worst_channel
from ..verdict.outcome import Outcome
from .language import listed, place

# Regions that are named where no pass differs in the image as a whole.
NAMED = 3


def pass_sentences(comparison: Comparison) -> list[str]:
    """Which light passes differ and by how much, and up to what the others agree; nothing where none was compared."""
    found = comparison.passes
    if found is None:
        return []
    differ = found.outcomes == Outcome.DIFFERENT
    said = [_differs(comparison, k, 0) for k in _by_size(comparison, np.argwhere(differ[:, :1])[:, 0], 0)]
    if not said:
        pairs = sorted(np.argwhere(differ).tolist(), key=lambda at: -np.nanmax(np.abs(found.difference[tuple(at)])))
        said = [_differs(comparison, k, region) for k, region in pairs[:NAMED]]
    others = ~differ.any(axis=1)
    if not others.any():
        return said
    name = "all other passes" if said else "all light passes"
    bound, everywhere = _largest(found.bounds[others, 0]), _largest(found.bounds[others])
    if math.isfinite(bound):
        rest = f"{name} agree to within {format_bound(bound)} as a whole"
        is_larger = bound < everywhere < math.inf
        rest += f", and to within {format_bound(everywhere)} in every region with a name." if is_larger else "."
    else:
        noisy = [str(p) for p, one in zip(found.passes, found.bounds[:, 0], strict=True) if not math.isfinite(one)]
        rest = f"too few samples to judge: {listed(tuple(noisy))}."
    return [*said, rest[0].upper() + rest[1:]]


def _largest(bounds: np.ndarray) -> float:
    """The largest bound of those that there are; infinite where there is none."""
    known = bounds[~np.isnan(bounds)]
    return float(known.max()) if known.size else math.inf


def _by_size(comparison: Comparison, numbers: np.ndarray, region: int) -> list[int]:
    """Passes by their numbers, the one that takes or adds most light first."""
    found = comparison.passes
    gap = np.abs(found.candidate[:, region] - found.reference[:, region]).sum(axis=1)
    return sorted(numbers.tolist(), key=lambda k: -gap[k])


def _differs(comparison: Comparison, k: int, region: int) -> str:
    found = comparison.passes
    channel = worst_channel(found.difference[k, region])
    low, high = found.low[k, region, channel], found.high[k, region, channel]
    where = "" if region == 0 else f" in {place(comparison, region)}"
    return (
        f"The {found.passes[k]} pass differs{where} by {format_percent(found.difference[k, region, channel])} in {'RGB'[channel]} "
        f"({format_percent(low)} to {format_percent(high)})."
    )


def pass_figures(comparison: Comparison) -> list[dict[str, Any]] | None:
    """Every light pass in every region with a name, as plain data; None where none was compared."""
    found = comparison.passes
    if found is None:
        return None
    return [
        {
            "name": name,
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
