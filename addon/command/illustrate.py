# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon illustrate`: the lecture's figures, computed, on one page."""

from __future__ import annotations

from ...lib.errors import Cancelled, EtalonError
from ...lib.exit_codes import ExitCode
from ...lib.lecture.figure import Figure
from ...lib.lecture.illustrations import illustrate_missing, illustrate_rows
from ...lib.lecture.page import FIGURES, illustrate
from ...lib.progress import Progress
from ...lib.settings.commands import IllustrateOptions
from ...lib.settings.common import PageTerminal
from ..host.blender import load_blender
from .console import bar, interruptible, open_page, print_json


def run(options: IllustrateOptions, terminal: PageTerminal) -> int:
    """Compute the figures, write the page, and print its place, or the numbers as JSON."""
    names = tuple(FIGURES) if options.only is None else (options.only,)
    with interruptible() as interrupted, bar("illustrate", terminal) as shown:
        progress = Progress(shown.report, interrupted, shown.tell, shown.begin)
        makers = {**FIGURES, "illustrations": lambda seed: _illustrate_rows(seed, progress)}
        figures = illustrate(options.out, names, options.seed, progress, makers)
    if terminal.json:
        print_json({name: figure.numbers for name, figure in figures.items()})
    else:
        print(f"page: {options.out}")
    if terminal.open:
        open_page(options.out)
    return ExitCode.DONE


def _illustrate_rows(seed: int, progress: Progress) -> Figure:
    """The two rows by both renderers, or what is missing for them.

    The other figures need no Blender.
    """
    try:
        load_blender()
        from ..illustrations import render_rows

        return illustrate_rows(render_rows(seed, progress), seed)
    except Cancelled:
        raise
    except EtalonError as error:
        return illustrate_missing(str(error))
