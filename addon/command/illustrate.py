# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon illustrate`: the lecture's figures, computed, on one page."""

from __future__ import annotations

from ...lib.exit_codes import ExitCode
from ...lib.lecture.page import FIGURES, illustrate
from ...lib.progress import Progress
from ...lib.settings.commands import IllustrateOptions
from ...lib.settings.common import PageTerminal
from .console import bar, interruptible, open_page, print_json


def run(options: IllustrateOptions, terminal: PageTerminal) -> int:
    """Compute the figures, write the page, and print its place, or the numbers as JSON."""
    names = tuple(FIGURES) if options.only is None else (options.only,)
    with interruptible() as interrupted, bar("illustrate", terminal) as shown:
        progress = Progress(shown.report, interrupted, shown.tell, shown.begin)
        figures = illustrate(options.out, names, options.seed, progress)
    if terminal.json:
        print_json({name: figure.numbers for name, figure in figures.items()})
    else:
        print(f"page: {options.out}")
    if terminal.open:
        open_page(options.out)
    return ExitCode.DONE
