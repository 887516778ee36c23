# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon compare`: render with the reference and with Cycles, and print the verdict."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import bpy

from ...lib.cluster.client import connect
from ...lib.cluster.worker import digest_of
from ...lib.comparison.compare import Comparison
from ...lib.errors import EtalonError
from ...lib.plain_text import one_line
from ...lib.progress import Progress
from ...lib.report.read import read_verdict
from ...lib.report.scene_check import scene_check_lines
from ...lib.report.summary import summarize
from ...lib.report.words import sentences, unexplained
from ...lib.settings.common import LOCAL, PageTerminal, Target
from ...lib.settings.comparison import CompareSettings, Settings
from ...lib.settings.words import repeating_command
from .. import job
from ..cycles.spread import spread_over
from ..host.quiet import quiet
from .console import bar, interruptible, open_page, paint, print_json
from .facts import external_files
from .opening import as_opened, open_asked, refuse_archive, results_folder


def run(target: Target, settings: CompareSettings, terminal: PageTerminal) -> int:
    """Open the scene, compare, print the verdict; the exit code is the verdict's."""
    refuse_archive(target)
    name = open_asked(target)
    folder = results_folder(settings.out, name)
    repeat = repeating_command("compare", as_opened(target), settings)
    with interruptible() as interrupted, bar(name, terminal) as shown, quiet():
        progress = Progress(shown.report, interrupted, shown.tell, shown.begin)
        with _workers(as_opened(target), settings) as spread:
            comparison = job.compare_here(bpy.context.scene, settings, folder, repeat, progress, spread)
    if terminal.json:
        print_json(read_verdict(folder / "verdict.json"))
    else:
        _print(comparison, folder)
    if terminal.open:
        open_page(folder / "report.html")
    return comparison.verdict.outcome.exit_code


@contextmanager
def _workers(target: Target, settings: CompareSettings) -> Iterator[job.Spread]:
    """Yield what has the workers of the scheduler render, or this machine.

    Raises EtalonError where a worker differs, and where workers cannot open the scene.
    """
    if settings.scheduler == LOCAL:
        yield job.here
        return
    if target.scene is None:
        raise EtalonError("--scheduler: the open file was never saved; save it, so that workers can open it")
    files: dict[str, str] = {}
    if target.scene.endswith(".blend"):
        target = replace(target, scene=str(Path(target.scene).resolve()))
        paths = [Path(str(target.scene)), *map(Path, external_files())]
        files = {str(path): digest_of(path.read_bytes()) for path in paths if path.is_file()}
    with connect(settings.scheduler) as cluster:
        version, commit, date = bpy.app.version_string, *map(_text, (bpy.app.build_hash, bpy.app.build_date))
        cluster.check(f"{version} {commit}")
        with spread_over(cluster, (version, f"{commit}, {date}"), target, settings.part(Settings), files) as spread:
            yield spread


def _text(value: bytes) -> str:
    return value.decode(errors="replace")


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
