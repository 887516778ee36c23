# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon stability`: the rounding errors of the reference."""

from __future__ import annotations

from collections.abc import Iterator

from ...lib.exit_codes import ExitCode
from ...lib.settings.commands import StabilityOptions
from ...lib.settings.common import PageTerminal
from ...lib.stability import atlas
from ...lib.stability.case import Case
from ..host.blender import load_blender
from .console import ended_by_interrupt, open_page, print_json


def run(settings: StabilityOptions, terminal: PageTerminal) -> int:
    """Measure every case, print it on a line of its own as it is done, and write the report."""
    cases = []
    for case in _cases(settings):
        if not terminal.json:
            print(atlas.line(case), flush=True)
        cases.append(case)
    figures = atlas.write(cases, settings.out)
    broken = [case.name for case in cases if not case.passed]
    page = settings.out / "stability.html"
    if terminal.json:
        print_json(figures)
    else:
        print(f"{len(cases) - len(broken)} of {len(cases)} held; report: {page}")
    if terminal.open:
        open_page(page)
    return ExitCode.BROKEN if broken else ExitCode.HELD


def _cases(settings: StabilityOptions) -> Iterator[Case]:
    yield from atlas.equations(settings.points)
    if settings.scenes:
        with ended_by_interrupt():
            load_blender()
            from .edge import edge_cases
        yield from edge_cases()
