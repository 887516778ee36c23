# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon compare`: render with the reference and with Cycles, and print the verdict."""

from __future__ import annotations

import bpy

from ...lib.plain_text import one_line
from ...lib.progress import Progress
from ...lib.report.scene_check import scene_check_lines
from ...lib.report.words import sentences, unexplained
from ...lib.settings.common import Target
from ...lib.settings.comparison import Settings
from ...lib.settings.words import repeating_command
from .. import job
from ..host.quiet import quiet
from .console import bar, interruptible
from .opening import as_opened, open_target, refuse_archive, results_folder


def run(target: Target, settings: Settings) -> int:
    """Open the scene, compare, print the verdict; the exit code is the verdict's."""
    refuse_archive(target)
    name = open_target(target.scene, target.frame, target.camera, target.assignments)
    folder = results_folder(settings.out, name)
    repeat = repeating_command("compare", as_opened(target), settings)
    with interruptible() as interrupted, bar(name) as shown, quiet():
        progress = Progress(shown.report, interrupted, shown.tell)
        comparison = job.compare_here(bpy.context.scene, settings, folder, repeat, progress)
    print(f"{one_line(comparison.scene)}: {comparison.verdict.outcome.value}")
    for sentence in sentences(comparison):
        print(f"  {one_line(sentence)}")
    for line in scene_check_lines(comparison.findings):
        print(f"  {one_line(line)}")
    print(one_line(f"report: {folder / 'report.html'}"))
    if unexplained(comparison):
        print(one_line(f"smallest scene that shows it: {folder / job.MINIMAL}"))
    return comparison.verdict.outcome.exit_code
