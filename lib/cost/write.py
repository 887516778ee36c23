# SPDX-License-Identifier: GPL-3.0-or-later
"""The folder that a measurement writes.

It holds cost.html, cost.json, cost.csv, and the pictures as PNG and SVG.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from markupsafe import Markup

from ..files.plain_data import write_json
from ..pages import render_page
from .document import Extras, document, write_csv
from .measure import Measurement
from .plots import error_figure, save, stage_figure
from .spans import ends, middle, took
from .summary import summarize

STAGES = "stages"
STAGE_PICTURES = (f"{STAGES}.png", f"{STAGES}.svg")
"""Files that only some strategies have: those of an older measurement go with it."""


def write_cost(measurement: Measurement, extras: Extras, folder: Path) -> dict[str, Any]:
    """Write all files into `folder`, which must be there; returns what cost.json holds."""
    figures = document(measurement, extras)
    summary = summarize(figures)
    write_json(folder / "cost.json", figures)
    write_csv(figures, folder / "cost.csv")
    pictures = {"error": save(error_figure(figures), folder, "cost")}
    if any(len(way.get("stages", ())) > 3 for way in figures["ways"]):
        pictures["stages"] = save(stage_figure(figures), folder, STAGES)
    values = {"figures": figures, "summary": summary, "pictures": {name: Markup(svg) for name, svg in pictures.items()}}
    filters = {f.__name__: f for f in (digits, interval, middle, ends, took)}
    page = render_page(Path(__file__).with_name("cost.html"), values, filters)
    (folder / "cost.html").write_text(page, encoding="utf-8")
    return figures


def digits(estimate: dict[str, float | None], scale: float = 1.0) -> str:
    """The value of an estimate times `scale`, three digits."""
    return "—" if estimate["value"] is None else _short(scale * estimate["value"])


def interval(estimate: dict[str, float | None], scale: float = 1.0) -> str:
    """The ends of its interval, or nothing."""
    low, high = estimate["low"], estimate["high"]
    return "" if low is None or high is None else f"{_short(scale * low)} to {_short(scale * high)}"


def _short(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 1000.0 else f"{value:.0f}"


def table(figures: dict[str, Any]) -> str:
    """The forecasts for a terminal, cheapest first."""
    rows = [["", *(f"to {100 * t:g} %" for t in figures["targets"])]]
    ways = [way for way in figures["ways"] if way["points"]]
    for way in sorted(ways, key=lambda way: _order(way["to_error"])):
        rows.append([way["label"], *(took(told["seconds"]) for told in way["to_error"])])
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    missing = [f"{way['label']}: {way['missing']}" for way in figures["ways"] if way["missing"]]
    return "\n".join([*lines, *missing])


def _order(told: list[dict[str, Any]]) -> list[float]:
    """Forecasts from the last target on, those not reached last."""
    medians = [entry["seconds"]["median"] for entry in reversed(told)]
    return [math.inf if median is None else median for median in medians]
