# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon compare`: render with the reference and with Cycles, and print the verdict."""

from __future__ import annotations

from pathlib import Path

from ...lib.comparison.compare import Comparison
from ...lib.plain_text import one_line
from ...lib.progress import Progress
from ...lib.report.read import read_verdict
from ...lib.report.scene_check import scene_check_lines
from ...lib.report.summary import summarize
from ...lib.report.words import sentences, unexplained
from ...lib.settings.common import PageTerminal, Target
from ...lib.settings.comparison import Settings
from .. import job
from ..host.quiet import quiet
from .comparing import compare_opened
from .console import bar, interruptible, open_page, paint, print_json
from .opening import open_asked, refuse_archive, results_folder


def run(target: Target, settings: Settings, terminal: PageTerminal) -> int:
    """Open the scene, compare, print the verdict; the exit code is the verdict's."""
    refuse_archive(target)
    name = open_asked(target)
    folder = results_folder(settings.out, name)
    with interruptible() as interrupted, bar(name, terminal) as shown, quiet():
        progress = Progress(shown.report, interrupted, shown.tell, shown.begin)
        comparison = compare_opened(target, settings, folder, progress)
    if terminal.json:
        print_json(read_verdict(folder / "verdict.json"))
    else:
        _print(comparison, folder)
    if terminal.open:
        open_page(folder / "report.html")
    return comparison.verdict.outcome.exit_code


def _print(comparison: Comparison, folder: Path) -> None:
    """Print what an artist needs in three lines, where the files are, and the details below."""
    outcome = comparison.verdict.outcome.value
    first, *rest = map(one_line, summarize(comparison))
    print(first.replace(f"{outcome}.", f"{paint(outcome, outcome)}.", 1))
    print("\n".join(rest))
    print(one_line(f"report: {folder / 'report.html'}"))
    if unexplained(comparison) and (folder / job.MINIMAL).is_file():
        print(one_line(f"smallest scene that shows it: {folder / job.MINIMAL}"))
    details = ["details", *(f"  {one_line(sentence)}" for sentence in sentences(comparison))]
    details += map(one_line, scene_check_lines(comparison.findings))
    print("\n" + paint("\n".join(details), "dim"))
