# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists and names of regions as a person says them."""

from __future__ import annotations

from collections.abc import Sequence

from ..comparison.compare import Comparison


def listed(names: Sequence[str]) -> str:
    """Names as a person lists them."""
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]


def place(comparison: Comparison, k: int) -> str:
    """Region k by its kind and name."""
    kind, name = comparison.regions.kinds[k], comparison.regions.names[k]
    return f"the {name}" if kind == "image" else f"{kind} {name}"
