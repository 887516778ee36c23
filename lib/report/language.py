# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers, lists and names of regions as a person says them."""

from __future__ import annotations

import math

from ..comparison.compare import Comparison


def percent(value: float, sign: bool = True) -> str:
    """A share as a percentage, with three significant digits; 'unbounded' where it is not finite."""
    if not math.isfinite(value):
        return "unbounded"
    return f"{100 * value:+.3g} %" if sign else f"{100 * value:.6g} %"


def part(value: float) -> str:
    """A part of something as a percentage without a plus sign; 'unbounded' where it is not finite."""
    return f"{100 * value:.3g} %" if math.isfinite(value) else "unbounded"


def seconds(value: float) -> str:
    """A duration as a person says it."""
    for limit, unit, size in ((100, "s", 1), (6000, "min", 60), (172800, "h", 3600)):
        if value < limit:
            return f"{value / size:.2g} {unit}" if value / size < 10 else f"{value / size:.0f} {unit}"
    return f"{value / 86400:.0f} days" if value < 1e8 else "years"


def listed(names: tuple[str, ...]) -> str:
    """Names as a person lists them."""
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def plural(count: int, noun: str) -> str:
    """A count with its noun: '1 region', '2 regions'."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def place(comparison: Comparison, k: int) -> str:
    """Region k by its kind and name."""
    kind, name = comparison.regions.kinds[k], comparison.regions.names[k]
    return f"the {name}" if kind == "image" else f"{kind} {name}"
