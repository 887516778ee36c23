# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the atlas and writes what it found: a line a case, stability.json, stability.html."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from itertools import groupby
from pathlib import Path
from typing import Any

from ..files.atomic import replace_files
from ..files.plain_data import write_json
from ..pages import render_page
from .case import Case
from .closed_forms import closed_forms
from .identities import identities
from .inversions import inversions
from .lights import lights_and_factors
from .lobes import lobes
from .measure import measure
from .volumes import volumes
from .watertight import watertightness

POINTS = 200
"""Places for each function: a minute in all."""
FORMAT = "etalon-stability"
VERSION = 1


def equations(points: int = POINTS) -> Iterator[Case]:
    """Yield every closed form, inversion and identity, and rays at edges, as it is done.

    There are `points` places for each function.
    """
    for function in (*closed_forms(), *lobes(), *lights_and_factors(), *volumes(), *inversions()):
        yield measure(function, points)
    yield from identities()
    yield from watertightness()


def number(value: float | None) -> str:
    """An error for a person: two digits, a dash where there is none."""
    if value is None:
        return "-"
    if not math.isfinite(value):
        return "not finite"
    return "0" if value == 0.0 else f"{value:.2g}" if value < 1e5 else f"{value:.1e}"


def line(case: Case) -> str:
    """A case on one line: what it is, worst error and bound, the float32 forms, where."""
    verdict = "ok  " if case.passed else "FAIL"
    held = (
        f"{number(case.judged)} of {number(case.worst)}"
        if case.excuse and case.judged is not None
        else number(case.worst)
    )
    named = {"printed": case.printed, "Cycles": case.cycles}
    forms = "".join(f"{name} {number(value)}; " for name, value in named.items() if value is not None)
    return f"{verdict} {case.name}: {held} (at most {number(case.bound)}) {case.unit}; {forms}{case.where}"


def write(cases: list[Case], folder: Path) -> dict[str, Any]:
    """Write stability.json and stability.html to `folder`, each complete or not at all.

    Returns the content of stability.json. Raises EtalonError where the folder cannot be written.
    """
    figures = _figures(cases)
    with replace_files(folder) as beside:
        write_json(beside / "stability.json", figures)
        (beside / "stability.html").write_text(_page(cases), encoding="utf-8")
    return figures


def _figures(cases: list[Case]) -> dict[str, Any]:
    rows = [{**asdict(case), "passed": case.passed} for case in cases]
    for row in rows:
        row.update({k: str(v) for k, v in row.items() if isinstance(v, float) and not math.isfinite(v)})
    return {"format": FORMAT, "version": VERSION, "passed": all(case.passed for case in cases), "cases": rows}


def _page(cases: list[Case]) -> str:
    families = [(family, list(group)) for family, group in groupby(cases, key=lambda case: case.family)]
    values = {"cases": cases, "families": families}
    return render_page(Path(__file__).with_name("stability.html"), values, {"number": number})
