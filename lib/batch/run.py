# SPDX-License-Identifier: GPL-3.0-or-later
"""Many comparisons: each in a process of its own, finished ones kept in a journal."""

from __future__ import annotations

import hashlib
import json
import re
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..errors import EtalonError
from ..exit_codes import ExitCode
from ..files.atomic import UNFINISHED, clear_unfinished, replace_files
from ..plural import plural
from ..progress import NO_PROGRESS, Progress
from ..report.batch import Row, write_csv, write_grid
from ..report.read import read_verdict
from ..version import VERSION
from .comparison import VERDICTS, run_comparison
from .journal import Entry, Journal, open_journal
from .plan import BatchPlan, Unit
from .process import etalon_command

# From the best to the worst: a batch ends with the exit code of its worst comparison.
_SEVERITY = (ExitCode.EQUIVALENT, ExitCode.EXPLAINED, ExitCode.UNDECIDED, ExitCode.DIFFERENT)

Tell = Callable[[str], None]


def _key(unit: Unit, options: tuple[str, ...], blender: str) -> str:
    """What a unit's result depends on: its command line, both programs' versions, and the file as it is now."""
    stamp = ""
    if unit.target.endswith(".blend") and Path(unit.target).is_file():
        status = Path(unit.target).stat()
        stamp = f"{status.st_mtime_ns} {status.st_size}"
    what = [VERSION, blender, stamp, *unit.arguments(), *options]
    return hashlib.sha256(json.dumps(what).encode()).hexdigest()[:16]


def run_plan(plan: BatchPlan, blender: str, tell: Tell, progress: Progress = NO_PROGRESS) -> int:
    """Run what the plan asks for and its journal lacks; return the exit code of the batch.

    `blender` names the release and the build that the comparisons will run in. `tell` gets a line about each comparison, and one about all;
    `progress` is told each comparison as it begins, and the share that is done.
    """
    keyed = {_key(unit, plan.options, blender): unit for unit in plan.units()}
    with replace_files(plan.out):  # says at once when the folder cannot be written
        pass
    with open_journal(plan.out) as journal:
        # Also what a killed batch left of comparisons that this plan does not ask for.
        for left in sorted(path.parent for path in plan.out.glob(f"*/{UNFINISHED}*")):
            clear_unfinished(left)
        try:
            _run_missing(plan, keyed, journal, tell, progress)
        finally:
            recorded = [journal.read(key) for key in keyed]
            _write_tables(plan, list(zip(keyed.values(), recorded, strict=True)))
    tell(_summary(recorded))
    if any(entry is None or entry.status != "finished" for entry in recorded):
        return ExitCode.BAD_INPUT
    return max((ExitCode(entry.exit_code) for entry in recorded if entry), key=_SEVERITY.index)


def _summary(recorded: list[Entry | None]) -> str:
    """How many comparisons there are of each verdict, and how many have none."""
    counts = Counter("not run" if entry is None else _outcome(entry) for entry in recorded)
    return f"{plural(len(recorded), 'comparison')}: {', '.join(f'{count} {outcome}' for outcome, count in counts.most_common())}"


def _outcome(entry: Entry) -> str:
    return VERDICTS[entry.exit_code] if entry.status == "finished" else entry.status


def _is_finished(out: Path, entry: Entry | None, tell: Tell) -> bool:
    """Whether the journal has a verdict, and the folder still has it too, as this version writes it; what has not is said."""
    if entry is None or entry.status != "finished":
        return False
    path = out / entry.folder / "verdict.json"
    if not path.is_file():
        return False
    try:
        read_verdict(path)
    except EtalonError as error:
        tell(str(error))
        return False
    return True


def _run_missing(plan: BatchPlan, keyed: dict[str, Unit], journal: Journal, tell: Tell, progress: Progress) -> None:
    """Run every unit that is not finished, journal each as it ends, and tell what it came to."""
    missing = [key for key in keyed if not _is_finished(plan.out, journal.read(key), tell)]
    done = len(keyed) - len(missing)
    if done:
        tell(f"{done} of {plural(len(keyed), 'comparison')} {'was' if done == 1 else 'were'} finished before")
    plan.require_properties(dict.fromkeys(keyed[key].scene for key in missing))
    for number, key in enumerate(missing, done + 1):
        unit = keyed[key]
        progress.begin(unit.label)
        progress.report((number - 1) / len(keyed))
        entry = _run_unit(plan, unit, key)
        journal.write(entry)
        reason = f": {entry.message}" if entry.message else ""
        tell(f"[{number}/{len(keyed)}] {unit.label}: {_outcome(entry)}{reason} ({entry.seconds:.0f} s)")


def _run_unit(plan: BatchPlan, unit: Unit, key: str) -> Entry:
    """Run one comparison; return what it came to."""
    folder = _folder_name(unit, key)
    begin = time.perf_counter()
    arguments = [*unit.arguments(), *plan.options, f"--out={plan.out / folder}", "--quiet"]
    status, code, message = run_comparison([*etalon_command(), "compare", *arguments], plan.out / folder)
    assignments = json.dumps({v.name: value for v, value in unit.assignments})
    return Entry(key, unit.scene, assignments, status, code, time.perf_counter() - begin, message, folder)


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
    if entry.status != "finished":
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
