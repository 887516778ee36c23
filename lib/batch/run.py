# SPDX-License-Identifier: GPL-3.0-or-later
"""Many comparisons: each in a process of its own, side by side where there are processors for it, finished ones kept in a journal."""

from __future__ import annotations

import json
import re
import threading
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import EtalonError
from ..exit_codes import ExitCode
from ..files.atomic import UNFINISHED, clear_unfinished, replace_files
from ..pages.formats import format_duration
from ..plural import plural
from ..progress import NO_PROGRESS, Progress
from ..report.batch import Row, write_csv, write_grid
from ..report.read import read_verdict
from .comparison import FINISHED, VERDICTS, Limits, run_comparison
from .journal import Entry
from .plan import BatchPlan, Unit
from .prepare import Batch, How, Tell, prepare
from .process import etalon_command

# What a comparison takes beside its time budget, in seconds: to start Blender, to read the scene, to write the report.
_START = 10.0
# The time budget of a comparison whose plan names none.
_TIME = 120.0
# From the best to the worst: a batch ends with the exit code of its worst comparison.
_SEVERITY = (ExitCode.EQUIVALENT, ExitCode.EXPLAINED, ExitCode.UNDECIDED, ExitCode.DIFFERENT)


@dataclass(frozen=True)
class Outlook:
    """What a plan would do: all its comparisons with the journal's entry of each, those to run, and the most seconds that they take.

    `expected` are the seconds that they take if they are like those in the journal, None where there are none.
    """

    units: tuple[tuple[Unit, Entry | None], ...]
    missing: tuple[Unit, ...]
    most: float | None
    expected: float | None


def run_plan(plan: BatchPlan, how: How, tell: Tell, progress: Progress = NO_PROGRESS) -> int:
    """Run what the plan asks for and its journal lacks; return the exit code of the batch.

    `tell` gets a line about each comparison, and one about all; `progress` is told what is begun, and the share that is done.
    """
    with prepare(plan, how, tell, progress) as batch:
        # Also what a killed batch left of comparisons that this plan does not ask for.
        for left in sorted(path.parent for path in plan.out.glob(f"*/{UNFINISHED}*")):
            clear_unfinished(left)
        try:
            _run_missing(batch, tell, progress)
        finally:
            recorded = batch.recorded()
            _write_tables(plan, recorded)
    entries = [entry for _, entry in recorded]
    tell(_summary(entries))
    if any(entry is None or entry.status != FINISHED for entry in entries):
        return ExitCode.BAD_INPUT
    return max((ExitCode(entry.exit_code) for entry in entries if entry), key=_SEVERITY.index)


def preview_plan(plan: BatchPlan, how: How, tell: Tell, progress: Progress = NO_PROGRESS) -> Outlook:
    """Check the whole plan, and say what `run_plan` would do; nothing is rendered."""
    with prepare(plan, how, tell, progress) as batch:
        limit = next((float(w.partition("=")[2]) for w in plan.options if w.startswith("--time=")), _TIME)
        seconds = [entry.seconds for entry in batch.journal.read_all().values() if entry.status == FINISHED]
        turns = -(-len(batch.missing) // how.jobs)
        is_bounded = not any(v.path == "--time" for v in plan.variations)
        return Outlook(
            units=tuple(batch.recorded()),
            missing=tuple(batch.units[key] for key in batch.missing),
            most=turns * (limit + _START) if is_bounded else None,
            expected=turns * sum(seconds) / len(seconds) if seconds else None,
        )


def _run_missing(batch: Batch, tell: Tell, progress: Progress) -> None:
    """Run every unit that is missing, side by side, journal each as it ends, and tell what it came to."""
    total, missing = len(batch.units), batch.missing
    done = total - len(missing)
    if done:
        tell(f"{done} of {plural(total, 'comparison')} {'was' if done == 1 else 'were'} done before")
    begin, stop = time.monotonic(), threading.Event()
    with ThreadPoolExecutor(max_workers=batch.how.jobs) as pool:
        waiting = [pool.submit(_run_unit, batch, key, stop, progress) for key in missing]
        try:
            for number, future in enumerate(as_completed(waiting), 1):
                entry = future.result()
                batch.journal.write(entry)
                reason = f": {entry.message}" if entry.message else ""
                left = (time.monotonic() - begin) / number * (len(missing) - number)
                rest = f"; about {format_duration(left)} left" if number < len(missing) else ""
                label = batch.units[entry.key].label
                tell(f"[{done + number}/{total}] {label}: {_outcome(entry)}{reason} ({entry.seconds:.0f} s){rest}")
                progress.report((done + number) / total)
        except BaseException:
            stop.set()
            for future in waiting:
                future.cancel()
            raise


def _run_unit(batch: Batch, key: str, stop: threading.Event, progress: Progress) -> Entry:
    """Run one comparison; return what it came to."""
    plan, how, unit = batch.plan, batch.how, batch.units[key]
    progress.begin(unit.label)
    folder = _folder_name(unit, key)
    begin = time.perf_counter()
    threads = [] if how.threads is None else [f"--threads={how.threads}"]
    words = ["compare", *unit.arguments(), *plan.options, *threads, f"--out={plan.out / folder}", "--quiet"]
    limits = Limits(plan.time_limit, plan.memory_limit, stop)
    host = how.hosts.get(unit.blender or "")
    command = [*etalon_command(), *words] if host is None else host.command(words)
    status, code, message = run_comparison(command, plan.out / folder, limits)
    assignments = json.dumps({v.name: value for v, value in unit.assignments})
    return Entry(key, unit.scene, assignments, status, code, time.perf_counter() - begin, message, folder)


def _summary(recorded: list[Entry | None]) -> str:
    """How many comparisons there are of each verdict, and how many have none."""
    counts = Counter("not run" if entry is None else _outcome(entry) for entry in recorded)
    return f"{plural(len(recorded), 'comparison')}: {', '.join(f'{count} {outcome}' for outcome, count in counts.most_common())}"


def _outcome(entry: Entry) -> str:
    return VERDICTS[entry.exit_code] if entry.status == FINISHED else entry.status


def _folder_name(unit: Unit, key: str) -> str:
    """A folder name that keeps nothing a file system could read as more than a name."""
    return f"{re.sub(r'[^A-Za-z0-9]+', '_', Path(unit.scene).stem)[:40]}-{key}"


def _write_tables(plan: BatchPlan, recorded: list[tuple[Unit, Entry | None]]) -> None:
    """Write batch.csv and batch.html about the whole plan, as far as the journal knows it."""
    names = [v.name for v in plan.variations]
    results = [_result(plan.out, unit, entry) for unit, entry in recorded]
    with replace_files(plan.out) as beside:
        write_csv(names, results, beside / "batch.csv")
        write_grid(names, results, beside / "batch.html", plan.out, [v.path for v in plan.variations])


def _result(out: Path, unit: Unit, entry: Entry | None) -> Row:
    """What the journal says of a unit, and what the comparison's own verdict.json says of the whole image."""
    values = tuple(value for _, value in unit.assignments)
    if entry is None:
        return Row(unit.scene, values, status="not run")
    facts: dict[str, Any] = {name: getattr(entry, name) for name in ("status", "seconds", "folder", "message")}
    if entry.status != FINISHED:
        return Row(unit.scene, values, **facts)
    try:
        figures = read_verdict(out / entry.folder / "verdict.json")
    except EtalonError as error:
        facts |= {"status": "not run", "message": str(error)}
        return Row(unit.scene, values, **facts)
    image, blender = figures["image"], figures["blender"]
    low, high = image["interval"]
    programs = [f"{name} {version}" for name, version in figures["versions"].items()]
    return Row(
        unit.scene,
        values,
        **facts,
        verdict=VERDICTS[entry.exit_code],
        difference=image["difference"],
        low=low,
        high=high,
        bound=figures["bound"]["value"],
        counts=Counter(region["outcome"] for region in figures["regions"]),
        tolerance=figures["tolerance"],
        confidence=figures["confidence"],
        versions=(*([f"Blender {blender['version']}"] if blender["version"] else []), *programs),
    )
