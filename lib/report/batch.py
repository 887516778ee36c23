# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of a batch: a CSV and an HTML grid.

The HTML is self-contained. Its grid has scenes against property values.
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..pages import render_page
from ..pages.formats import format_bound, format_duration, format_percent
from ..plain_text import spreadsheet_cell
from .page import DIFFERENCE_LIMIT, URGENCY

COLUMNS = ("status", "verdict", "relative_difference", "low", "high", "seconds", "folder", "message")


@dataclass(frozen=True)
class Row:
    """One comparison of a batch.

    `values` those of the varied properties, in the order of their names; `status` 'finished', 'refused', 'failed' or 'not run'; `verdict`
    empty unless finished; `difference`, `low`, `high` the whole image's relative difference and its interval, None if unknown;
    `folder` with its report, relative to the table's. `bound` is that of all regions, None without one; `counts` has the number of regions of
    each outcome; `tolerance` and `confidence` are those of the comparison; `versions` names the programs.
    """

    scene: str
    values: tuple[Any, ...]
    status: str
    verdict: str = ""
    difference: float | None = None
    low: float | None = None
    high: float | None = None
    seconds: float = 0.0
    folder: str = ""
    message: str = ""
    bound: float | None = None
    counts: Mapping[str, int] = field(default_factory=dict)
    tolerance: float | None = None
    confidence: float | None = None
    versions: tuple[str, ...] = ()


def write_csv(names: list[str], rows: list[Row], path: Path) -> None:
    """Write one line a comparison; `names` are those of the varied properties."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([spreadsheet_cell(name) for name in ("scene", *names, *COLUMNS)])
        for r in rows:
            numbers = [r.difference, r.low, r.high, round(r.seconds, 1)]
            cells = [r.scene, *r.values, r.status, r.verdict, *numbers, r.folder, r.message]
            writer.writerow([spreadsheet_cell(cell) for cell in cells])


def write_grid(
    names: list[str], rows: list[Row], path: Path, source: Path, properties: list[str], changes: Sequence[str] = ()
) -> None:
    """Write the grid, then maps of bound, difference and time.

    In the grid the last varied property goes across, scenes and the other properties down. `source` is the plan's
    folder of results, `properties` are the data paths of the varied properties, and `changes` says what differs from
    an earlier batch; the page shows them all.
    """
    across = list(dict.fromkeys(r.values[-1] for r in rows)) if names else [None]
    lines: dict[tuple[Any, ...], dict[Any, Row]] = {}
    for r in rows:
        lines.setdefault((r.scene, *r.values[:-1]), {})[r.values[-1] if names else None] = r
    found = Counter(r.verdict or r.status for r in rows)
    values = {
        "names": names,
        "across": across,
        "lines": lines,
        "total": len(rows),
        "counts": {one: found[one] for one in sorted(found, key=_severity)},
        "first": {one: next(r for r in rows if (r.verdict or r.status) == one) for one in found},
        "tolerances": sorted({r.tolerance for r in rows if r.tolerance is not None}),
        "confidences": sorted({r.confidence for r in rows if r.confidence is not None}),
        "versions": sorted({version for r in rows for version in r.versions}),
        "limit": DIFFERENCE_LIMIT,
        "source": source,
        "varied": dict(zip(names, properties, strict=True)),
        "seconds": sum(r.seconds for r in rows),
        "maps": _maps(rows),
        "changes": changes,
    }
    text = render_page(Path(__file__).with_name("batch.html"), values)
    path.write_text(text, encoding="utf-8")


def _maps(rows: list[Row]) -> list[dict[str, Any]]:
    """The quantities that are drawn as maps.

    Each has a title, the row's number, how it is written, and the value that has the full colour.
    """
    tolerance = max((r.tolerance for r in rows if r.tolerance is not None), default=0.01)
    found = [
        ("Bound", "bound", format_bound, 2 * tolerance),
        ("Difference of the whole image", "difference", format_percent, tolerance),
        ("Time", "seconds", format_duration, max((r.seconds for r in rows), default=1.0) or 1.0),
    ]
    return [{"title": title, "of": of, "show": show, "most": most} for title, of, show, most in found]


def _severity(outcome: str) -> int:
    """The place of a verdict in the order of urgency; what is not finished comes first."""
    return URGENCY.index(outcome) if outcome in URGENCY else -1
