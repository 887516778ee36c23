# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon cost`: error against time of every way to render a scene.

It also says what one given error would take.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

from ...lib.cost.result import Cost
from ...lib.cost.spans import took
from ...lib.cost.summary import summarize
from ...lib.cost.verify import Verification
from ...lib.cost.write import table
from ...lib.plain_text import one_line
from ...lib.progress import Progress
from ...lib.settings.common import PageTerminal, Target
from ...lib.settings.cost import CostOptions
from ...lib.settings.words import repeating_command
from ..host.blender import load_blender
from .console import bar, ended_by_interrupt, interruptible, open_page, print_json


def run(target: Target, settings: CostOptions, terminal: PageTerminal) -> int:
    """Measure, print the table, leave the report."""
    begin = time.perf_counter()  # before Blender is imported, which is part of what a command costs
    with ended_by_interrupt():
        load_blender()
        import bpy

        from ..cost import measure_cost
        from .opening import as_opened, open_asked, refuse_archive, results_folder
    refuse_archive(target)
    name = open_asked(target)
    folder = results_folder(settings.out, name)
    repeat = repeating_command("cost", as_opened(target), settings)

    opened = time.perf_counter() - begin
    with interruptible() as interrupted:

        @contextmanager
        def phase(words: str) -> Iterator[Progress]:
            with bar(name, terminal) as shown:
                shown.begin(words)
                yield Progress(shown.report, interrupted, shown.tell, shown.begin)

        found = measure_cost(name, bpy.context.scene, settings, folder, repeat, phase, opened)
    page = folder / "cost.html"
    if terminal.json:
        print_json(found.figures)
    else:
        _print(found, settings, page)
    if terminal.open:
        open_page(page)
    return 0


def _print(found: Cost, settings: CostOptions, page: Path) -> None:
    """Print the summary, the table, and where the report is."""
    print(one_line(f"{found.figures['scene']}: {summarize(found.figures)}") + "\n")
    print(table(found.figures))
    if found.verification is not None:
        print(_verdict(found.verification))
    elif settings.verify:
        print("not verified: interrupted, or no strategy reaches the target")
    print(one_line(f"report: {page}"))


def _verdict(v: Verification) -> str:
    return (
        f"{v.label}: forecast {took(asdict(v.forecast.seconds))} with {v.samples} samples per pixel to {100 * v.forecast.target:g} %; "
        f"it took {v.seconds:.2f} s ({'inside' if v.held else 'outside'} the interval) "
        f"and the error is {100 * v.error:.3g} %; exactly {100 * v.forecast.target:g} % would have taken {v.to_target:.2f} s"
    )
