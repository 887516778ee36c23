# SPDX-License-Identifier: GPL-3.0-or-later
"""All figures of an audit as plain data, audit.json, and its table.

The published form of audit.json is audit.schema.json beside this file.
"""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from ..cost.estimates import CONFIDENCE
from ..files.plain_data import make_plain
from ..pages.formats import format_percent
from ..relative import worst_channel
from ..verdict.outcome import Outcome
from .findings import DRAWN, SQUARES, Audit, Finding
from .setting import FACTORY, FILE

FORMAT = "etalon-audit"
# Grows when a field changes its meaning or goes; a reader compares it before it reads on.
VERSION = 1

WORDS = {Outcome.DIFFERENT: "biased", Outcome.EQUIVALENT: "no bias", Outcome.UNDECIDED: "undecided"}
SAME = "0"
ORIGINS = {FILE: "yours", FACTORY: "factory"}
HEADINGS = ("setting", "value", "verdict", "whole image", "worst block", "where", "time", "noise")


def document(audit: Audit, command: str) -> dict[str, Any]:
    """audit.json as a dictionary; numbers that are not finite are None.

    Settings come in the order of what they cost.
    """
    return make_plain(
        {
            "format": FORMAT,
            "version": VERSION,
            "scene": audit.scene,
            "size": {"width": audit.neutral.shape[1], "height": audit.neutral.shape[0]},
            "tolerance": audit.options.tolerance,
            "confidence": audit.options.confidence,
            "interval_confidence": CONFIDENCE,
            "floor": audit.floor,
            "settings": [_finding(audit, finding) for finding in sorted(audit.findings, key=_cost, reverse=True)],
            "same": [asdict(setting) for setting in audit.same],
            "missing": [asdict(setting) for setting in audit.missing],
            "rounds": audit.rounds,
            "samples": audit.samples,
            "samples_of_file": audit.asked,
            "seconds_neutral": audit.seconds_neutral,
            "nonfinite_pixels": audit.nonfinite,
            "drawn": {"standard_errors": DRAWN, "squares": SQUARES},
            "neutral": audit.settings,
            "options": asdict(audit.options),
            "stopped": audit.stopped,
            "started": audit.started,
            "seconds": audit.seconds,
            "versions": audit.versions,
            "command": command,
        }
    )


def _cost(finding: Finding) -> tuple[bool, int, float]:
    """The key that sorts findings by what they cost.

    It ranks single settings before those together, biased ones before others, and by the largest difference.
    """
    rank = (Outcome.EQUIVALENT, Outcome.UNDECIDED, Outcome.DIFFERENT).index(finding.outcome)
    worst = float(np.nan_to_num(np.abs(finding.difference[finding.worst])))
    return not finding.setting.together, rank, worst


def _finding(audit: Audit, finding: Finding) -> dict[str, Any]:
    setting = finding.setting
    place, channel = finding.worst
    whole = int(worst_channel(finding.difference[0]))
    return {
        "key": setting.key,
        "label": setting.label,
        "value": setting.value,
        "neutral": setting.neutral,
        "origin": setting.origin,
        "together": setting.together,
        "statement": setting.statement,
        "outcome": finding.outcome,
        "regions": {outcome.value: int((finding.outcomes == outcome).sum()) for outcome in WORDS},
        "image": _bias(finding, 0, whole),
        "worst": {**_bias(finding, place, channel), "box": audit.boxes[place]},
        "seconds": finding.seconds,
        "time_ratio": asdict(finding.time),
        "variance_ratio": asdict(finding.noise),
        "map": map_name(setting.key),
    }


def _bias(finding: Finding, region: int, channel: int) -> dict[str, Any]:
    return {
        "channel": "RGB"[channel],
        "outcome": finding.outcomes[region],
        "difference": finding.difference[region, channel],
        "interval": [finding.low[region, channel], finding.high[region, channel]],
    }


def map_name(key: str) -> str:
    """The file with the map of the setting of that key."""
    return f"map-{key}.png"


def cells(entry: dict[str, Any]) -> list[str]:
    """One setting of audit.json in the words of the table, HEADINGS above."""
    x0, y0, x1, y1 = entry["worst"]["box"]
    worst = bias(entry["worst"])
    return [
        entry["label"],
        ", ".join(filter(None, (entry["value"], FACTORY if entry["origin"] == FACTORY else ""))),
        WORDS[Outcome(entry["outcome"])],
        bias(entry["image"]),
        worst,
        "" if worst == SAME else f"x {x0}-{x1}, y {y0}-{y1}",
        ratio(entry["time_ratio"]),
        ratio(entry["variance_ratio"]),
    ]


def bias(told: dict[str, Any]) -> str:
    """A relative difference and its interval, in per cent.

    SAME where both sides are exactly equal.
    """
    value, (low, high) = told["difference"], told["interval"]
    if value == low == high == 0:
        return SAME
    ends = "unbounded" if low is None or high is None else f"{100 * low:+.3g} to {100 * high:+.3g}"
    return f"{'unbounded' if value is None else format_percent(value)} ({ends})"


def ratio(estimate: dict[str, float | None]) -> str:
    """A ratio and its interval."""
    value, low, high = (estimate[key] for key in ("value", "low", "high"))
    if value is None:
        return "not known"
    return f"x{value:.3g}" + ("" if low is None or high is None else f" ({low:.3g} to {high:.3g})")


def table(figures: dict[str, Any]) -> str:
    """The whole table for a terminal, and what was as neutral below it."""
    lines = []
    if figures["settings"]:
        rows = [list(HEADINGS), *(cells(entry) for entry in figures["settings"])]
        widths = [max(len(row[k]) for row in rows) for k in range(len(HEADINGS))]
        lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    for setting in figures["missing"]:
        lines.append(f"{setting['label']} {setting['value']}: not measured, {setting['missing']}")
    if figures["same"]:
        lines.append("as neutral: " + ", ".join(setting["label"] for setting in figures["same"]))
    return "\n".join(lines)
