# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon batch`: many comparisons."""

from __future__ import annotations

import csv
import sys
from pathlib import Path

from tqdm import tqdm

from ...lib.batch.plan import read_plan
from ...lib.batch.run import run_plan
from ...lib.plain_text import one_line
from ...lib.progress import Progress
from ...lib.settings.commands import BatchOptions
from ...lib.settings.common import PageTerminal
from ..host.blender import load_blender
from .console import bar, ended_by_interrupt, open_page, print_json


def run(settings: BatchOptions, terminal: PageTerminal) -> int:
    """Check a PLAN.toml and run it; the exit code is that of the worst comparison."""
    plan = read_plan(settings.plan)
    with ended_by_interrupt():
        bpy = load_blender()
        from ...reference_scenes import SCENES
    plan.require_scenes(SCENES)
    blender = f"{bpy.app.version_string} {bpy.app.build_hash.decode(errors='replace')}"
    tell = _tell_nobody if terminal.json else _tell
    with bar(settings.plan.stem, terminal) as shown:
        code = run_plan(plan, blender, tell, Progress(shown.report, begin=shown.begin))
    page = plan.out / "batch.html"
    if terminal.json:
        print_json({"page": page, "exit_code": int(code), "comparisons": _rows(plan.out / "batch.csv")})
    else:
        print(one_line(f"grid: {page}"))
    if terminal.open:
        open_page(page)
    return code


def _tell(line: str) -> None:
    """Print one line above the progress bar."""
    tqdm.write(one_line(line), file=sys.stdout)
    sys.stdout.flush()


def _tell_nobody(line: str) -> None:
    """Keep standard output for the JSON, which has the same facts."""


def _rows(table: Path) -> list[dict[str, str]]:
    """The lines of batch.csv, by the names of its columns."""
    with table.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
