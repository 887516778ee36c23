# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of a batch: one CSV and one self-contained HTML grid of scenes against property values."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..pages import render_page
from ..plain_text import spreadsheet_cell

COLUMNS = ("status", "verdict", "relative_difference", "low", "high", "seconds", "folder", "message")


@dataclass(frozen=True)
class Row:
    """One comparison of a batch.

    `values` those of the varied properties, in the order of their names; `status` 'finished', 'refused', 'failed' or 'not run'; `verdict`
    empty unless finished; `difference`, `low`, `high` the whole image's relative difference and its interval, None if unknown;
    `folder` with its report, relative to the table's.
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


def write_csv(names: list[str], rows: list[Row], path: Path) -> None:
    """Write one line a comparison; `names` are those of the varied properties."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([spreadsheet_cell(name) for name in ("scene", *names, *COLUMNS)])
        for r in rows:
            numbers = [r.difference, r.low, r.high, round(r.seconds, 1)]
            cells = [r.scene, *r.values, r.status, r.verdict, *numbers, r.folder, r.message]
            writer.writerow([spreadsheet_cell(cell) for cell in cells])


def write_grid(names: list[str], rows: list[Row], path: Path) -> None:
    """Write the grid: the last varied property across, scenes and the other properties down."""
    across = list(dict.fromkeys(r.values[-1] for r in rows)) if names else [None]
    lines: dict[tuple[Any, ...], dict[Any, Row]] = {}
    for r in rows:
        lines.setdefault((r.scene, *r.values[:-1]), {})[r.values[-1] if names else None] = r
    text = render_page(Path(__file__).with_name("batch.html"), {"names": names, "across": across, "lines": lines})
    path.write_text(text, encoding="utf-8")
