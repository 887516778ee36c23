# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon batch`: many comparisons."""

from __future__ import annotations

import sys

from tqdm import tqdm

from ...lib.batch.plan import read_plan
from ...lib.batch.run import run_plan
from ...lib.plain_text import one_line
from ...lib.settings.commands import BatchOptions
from ..host.blender import load_blender
from .console import ended_by_interrupt


def run(settings: BatchOptions) -> int:
    """Check a PLAN.toml and run it; the exit code is that of the worst comparison."""
    plan = read_plan(settings.plan)
    with ended_by_interrupt():
        bpy = load_blender()
        from ...reference_scenes import SCENES
    plan.require_scenes(SCENES)
    blender = f"{bpy.app.version_string} {bpy.app.build_hash.decode(errors='replace')}"
    code = run_plan(plan, blender, _tell)
    print(one_line(f"grid: {plan.out / 'batch.html'}"))
    return code


def _tell(line: str) -> None:
    """Print one line above the progress bar."""
    tqdm.write(one_line(line), file=sys.stdout)
    sys.stdout.flush()
