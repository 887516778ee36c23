# SPDX-License-Identifier: GPL-3.0-or-later
"""Many comparisons: scenes times property values, each in a process of its own, finished ones kept in a journal."""

from __future__ import annotations

import hashlib
import itertools
import json
import re
import sqlite3
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tqdm import tqdm

from ..errors import EtalonError, unknown
from ..exit_codes import ExitCode
from ..files.atomic import replace_files
from ..report.batch import Row, write_csv, write_grid
from ..report.read import read_verdict
from ..settings.common import Target
from ..settings.comparison import Settings
from ..settings.words import read_table
from ..verdict.outcome import Outcome
from .process import end, etalon_command, start

VERDICTS = {outcome.exit_code: outcome.value for outcome in Outcome}
# From the best to the worst: a batch ends with the exit code of its worst comparison.
_SEVERITY = (ExitCode.EQUIVALENT, ExitCode.EXPLAINED, ExitCode.UNDECIDED, ExitCode.DIFFERENT)
ENTRIES = ("out", "scenes", "options", "vary")
_JOURNAL = """
create table if not exists units (
    key text primary key, scene text, assignments text, status text, exit_code integer, seconds real, message text, folder text
)"""


@dataclass(frozen=True)
class Variation:
    """One property and the values it takes; `name` is what tables call it."""

    name: str
    path: str
    values: tuple[Any, ...]


@dataclass(frozen=True)
class Unit:
    """One comparison: a scene, as the plan names it, and the values of all varied properties."""

    scene: str
    target: str
    assignments: tuple[tuple[Variation, Any], ...]

    def arguments(self) -> list[str]:
        """The part of the command line that makes this unit what it is."""
        return [self.target, *(f"--set={v.path}={json.dumps(value)}" for v, value in self.assignments)]

    @property
    def label(self) -> str:
        """What the user calls it."""
        return " ".join([self.scene, *(f"{v.name}={value}" for v, value in self.assignments)])


@dataclass(frozen=True)
class BatchPlan:
    """What a PLAN.toml says."""

    out: Path
    scenes: tuple[str, ...]
    folder: Path
    options: tuple[str, ...]
    variations: tuple[Variation, ...]

    def units(self) -> Iterator[Unit]:
        """All combinations, scene by scene."""
        for scene in self.scenes:
            target = str(self.folder / scene) if scene.endswith(".blend") else scene
            for values in itertools.product(*(v.values for v in self.variations)):
                yield Unit(scene, target, tuple(zip(self.variations, values, strict=True)))


def read_plan(path: Path) -> BatchPlan:
    """Read a PLAN.toml; raise EtalonError naming the entry that is wrong."""
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise EtalonError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    except ValueError as error:
        raise EtalonError(f"{path}: is not TOML ({error}); see `etalon batch --help`") from error
    for name in data.keys() - set(ENTRIES):
        raise EtalonError(f"{path}: {unknown('entry', name, ENTRIES)}")
    scenes = data.get("scenes")
    if not isinstance(scenes, list) or not scenes or not all(isinstance(s, str) for s in scenes):
        raise EtalonError(f"{path}: 'scenes' must be a list of names or .blend files")
    options, vary = data.get("options", {}), data.get("vary", [])
    if not isinstance(options, dict) or not isinstance(vary, list) or not isinstance(data.get("out", ""), str):
        raise EtalonError(
            f"{path}: 'out' is a text, 'options' a table, 'vary' a list of tables; see `etalon batch --help`"
        )
    folder = path.resolve().parent
    return BatchPlan(
        out=folder / data.get("out", path.stem),
        scenes=tuple(scenes),
        folder=folder,
        options=_options(path, options),
        variations=tuple(_variation(path, entry) for entry in vary),
    )


def _options(path: Path, table: dict[str, Any]) -> tuple[str, ...]:
    """The table [options] as words for `etalon compare`; --out is the batch's own."""
    if "out" in table:
        raise EtalonError(
            f"{path}: [options] cannot set 'out'; each comparison gets a folder below the plan's own 'out'"
        )
    try:
        return read_table((Target, Settings), table)
    except EtalonError as error:
        raise EtalonError(f"{path}: [options]: {error}") from None


def _variation(path: Path, entry: Any) -> Variation:
    """One [[vary]] table."""
    if (
        not isinstance(entry, dict)
        or not isinstance(entry.get("path"), str)
        or not isinstance(entry.get("values"), list)
    ):
        raise EtalonError(f"{path}: each [[vary]] needs a text 'path' and a list 'values'; see `etalon batch --help`")
    if not entry["values"]:
        raise EtalonError(f"{path}: 'values' of {entry['path']} is empty; give at least one")
    values = tuple(tuple(value) if isinstance(value, list) else value for value in entry["values"])
    return Variation(str(entry.get("name", entry["path"])), entry["path"], values)


def _key(unit: Unit, options: tuple[str, ...]) -> str:
    """What a unit's result depends on: its command line, the package's version, and the file as it is now."""
    from ..version import VERSION

    stamp = ""
    if unit.target.endswith(".blend") and Path(unit.target).is_file():
        status = Path(unit.target).stat()
        stamp = f"{status.st_mtime_ns} {status.st_size}"
    return hashlib.sha256(json.dumps([VERSION, stamp, *unit.arguments(), *options]).encode()).hexdigest()[:16]


def run_plan(plan: BatchPlan) -> int:
    """Run what the plan asks for and its journal lacks; return the exit code of the batch."""
    keyed = {_key(unit, plan.options): unit for unit in plan.units()}
    with replace_files(plan.out):  # says at once when the folder cannot be written
        pass
    with closing(_open_journal(plan.out / "journal.sqlite")) as journal:
        try:
            _run_missing(plan, keyed, journal)
        finally:
            recorded = [_row(journal, key) for key in keyed]
            _write_tables(plan, list(zip(keyed.values(), recorded, strict=True)))
    if any(row is None or row["status"] != "finished" for row in recorded):
        return ExitCode.BAD_INPUT
    return max((ExitCode(row["exit_code"]) for row in recorded), key=_SEVERITY.index)


def _open_journal(path: Path) -> sqlite3.Connection:
    """Open the journal, made when missing; raise EtalonError if the file is something else."""
    journal = sqlite3.connect(path, isolation_level=None)
    journal.row_factory = sqlite3.Row
    try:
        journal.execute(_JOURNAL)
    except sqlite3.DatabaseError as error:
        journal.close()
        raise EtalonError(f"{path}: is not a journal of this command ({error}); move it away") from error
    return journal


def _row(journal: sqlite3.Connection, key: str) -> sqlite3.Row | None:
    return journal.execute("select * from units where key = ?", (key,)).fetchone()


def _is_finished(out: Path, row: sqlite3.Row | None) -> bool:
    """Whether the journal has a verdict, and the folder still has it too, as this version writes it; what has not is said."""
    path = out / row["folder"] / "verdict.json" if row is not None else out
    if row is None or row["status"] != "finished" or not path.is_file():
        return False
    try:
        read_verdict(path)
    except EtalonError as error:
        tqdm.write(f"etalon: {error}", file=sys.stderr)
        return False
    return True


def _run_missing(plan: BatchPlan, keyed: dict[str, Unit], journal: sqlite3.Connection) -> None:
    """Run every unit that is not finished, and journal each as it ends."""
    missing = [key for key in keyed if not _is_finished(plan.out, _row(journal, key))]
    with tqdm(total=len(keyed), initial=len(keyed) - len(missing), unit="comparison", file=sys.stderr) as shown:
        for key in missing:
            unit = keyed[key]
            shown.set_description(unit.label)
            folder = _folder_name(unit, key)
            begin = time.perf_counter()
            code, words = _run_unit([*unit.arguments(), *plan.options, f"--out={plan.out / folder}"])
            # A crash may end with any code; what counts as a verdict has been written as one.
            judged = code in VERDICTS and (plan.out / folder / "verdict.json").is_file()
            status = "finished" if judged else "refused" if code == ExitCode.BAD_INPUT else "failed"
            assignments = json.dumps({v.name: value for v, value in unit.assignments})
            journal.execute(
                "insert or replace into units values (?, ?, ?, ?, ?, ?, ?, ?)",
                (
                    key,
                    unit.scene,
                    assignments,
                    status,
                    code,
                    time.perf_counter() - begin,
                    "" if judged else words,
                    folder,
                ),
            )
            shown.update()


def _folder_name(unit: Unit, key: str) -> str:
    """A folder name that keeps nothing a file system could read as more than a name."""
    return f"{re.sub(r'[^A-Za-z0-9]+', '_', Path(unit.scene).stem)[:40]}-{key}"


def _run_unit(arguments: list[str]) -> tuple[int, str]:
    """Run `etalon compare` in a process of its own; return its exit code and its last words."""
    process = start([*etalon_command(), "compare", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        _, errors = process.communicate()
    except BaseException:
        end(process)
        raise
    lines = [line.strip() for line in errors.replace("\r", "\n").splitlines() if line.strip()]
    return process.returncode, lines[-1] if lines else f"the process ended with code {process.returncode}"


def _write_tables(plan: BatchPlan, recorded: list[tuple[Unit, sqlite3.Row | None]]) -> None:
    """Write batch.csv and batch.html about the whole plan, as far as the journal knows it."""
    names = [v.name for v in plan.variations]
    results = [_result(plan.out, unit, row) for unit, row in recorded]
    with replace_files(plan.out) as beside:
        write_csv(names, results, beside / "batch.csv")
        write_grid(names, results, beside / "batch.html")


def _result(out: Path, unit: Unit, row: sqlite3.Row | None) -> Row:
    """What the journal says of a unit, and what the comparison's own verdict.json says of the whole image."""
    values = tuple(value for _, value in unit.assignments)
    if row is None:
        return Row(unit.scene, values, status="not run")
    facts: dict[str, Any] = {
        "status": row["status"],
        "seconds": row["seconds"],
        "folder": row["folder"],
        "message": row["message"],
    }
    if row["status"] != "finished":
        return Row(unit.scene, values, **facts)
    try:
        image = read_verdict(out / row["folder"] / "verdict.json")["image"]
    except EtalonError as error:
        facts |= {"status": "not run", "message": str(error)}
        return Row(unit.scene, values, **facts)
    low, high = image["interval"]
    verdict = VERDICTS[row["exit_code"]]
    return Row(unit.scene, values, **facts, verdict=verdict, difference=image["difference"], low=low, high=high)
