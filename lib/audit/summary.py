# SPDX-License-Identifier: GPL-3.0-or-later
"""An audit in one sentence: the setting that costs most."""

from __future__ import annotations

from typing import Any

from ..pages.formats import format_percent
from ..plural import plural
from ..verdict.outcome import Outcome
from .document import ORIGINS, bias


def summarize(figures: dict[str, Any]) -> str:
    """The setting whose bias is the largest, or that none is biased.

    `figures` are those of audit.json, whose settings are sorted by what they cost.
    """
    single = [entry for entry in figures["settings"] if not entry["together"]]
    limit = format_percent(figures["tolerance"], sign=False)
    if not single:
        missing = plural(len(figures["missing"]), "setting")
        return (
            f"Nothing was measured: {missing} cannot be."
            if figures["missing"]
            else "Every setting is at its neutral value."
        )
    first, outcome = single[0], Outcome(single[0]["outcome"])
    name = f"{first['label']}, {first['value']} ({ORIGINS[first['origin']]})"
    worst = f"{bias(first['worst'])} in the worst block"
    if outcome is Outcome.DIFFERENT:
        return f"The setting that costs most is {name}: {worst}."
    if outcome is Outcome.UNDECIDED:
        return f"No setting is known to be off by more than {limit}; {name} may be, and is too noisy to judge: {worst}."
    return f"No setting costs accuracy: none is off by more than {limit} anywhere."
