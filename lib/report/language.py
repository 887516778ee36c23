# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists, counts and names of regions as a person says them."""

from __future__ import annotations

from ..comparison.compare import Comparison


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
