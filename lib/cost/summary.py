# SPDX-License-Identifier: GPL-3.0-or-later
"""A cost measurement in one sentence.

It names the cheapest unbiased way to the error that most people want.
"""

from __future__ import annotations

from typing import Any

from .document import BASELINE
from .spans import took
from .ways import Bias

# The error that the sentence is about, where it was among the targets.
USUAL = 0.01


def summarize(figures: dict[str, Any]) -> str:
    """The cheapest unbiased way to 1 %, or to the first target, and what Cycles takes.

    `figures` are those of cost.json.
    """
    targets = list(figures["targets"])
    k = targets.index(USUAL) if USUAL in targets else 0
    goal = f"{100 * targets[k]:g} %"
    measured = [way for way in figures["ways"] if way["points"]]
    unbiased = [way for way in measured if Bias(way["bias_kind"]) is Bias.NONE]
    reached = [way for way in unbiased if way["to_error"][k]["reached"]]
    cycles = next((way for way in measured if way["key"] == BASELINE), None)
    beside = "" if cycles is None else f"; {cycles['label']}: {_spent(cycles, k)}"
    if not unbiased:
        return f"No unbiased way was measured{beside}."
    if not reached:
        return f"No unbiased way that was measured is likely to reach {goal}{beside}."
    cheapest = min(reached, key=lambda way: way["to_error"][k]["seconds"]["median"])
    beside = "" if cheapest is cycles else beside
    return f"The cheapest unbiased way to {goal} is {cheapest['label']}: {_spent(cheapest, k)} of rendering{beside}."


def _spent(way: dict[str, Any], k: int) -> str:
    return took(way["to_error"][k]["seconds"])
