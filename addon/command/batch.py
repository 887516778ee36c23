# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon batch`: many comparisons."""

from __future__ import annotations

from ...lib.batch.run import read_plan, run_plan
from ...lib.settings.commands import BatchOptions


def run(settings: BatchOptions) -> int:
    """Run a PLAN.toml; the exit code is that of the worst comparison."""
    plan = read_plan(settings.plan)
    code = run_plan(plan)
    print(f"grid: {plan.out / 'batch.html'}")
    return code
