# SPDX-License-Identifier: GPL-3.0-or-later
"""Many comparisons in other processes.

They run side by side where there are processors for it, and a journal keeps the finished ones.
"""

from __future__ import annotations

import json
import math
import re
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from ..files.atomic import UNFINISHED, clear_unfinished
from ..pages.formats import format_duration
from ..plural import plural
from ..progress import NO_PROGRESS, Progress
from .ahead import Ahead, Command
from .comparison import FINISHED, Limits, run_comparison
from .forks import ForkServer, can_fork
from .journal import Entry
from .plan import BatchPlan, Unit
from .prepare import Batch, How, Tell, prepare
from .process import etalon_command
from .remote import run_on_cluster
from .results import End, Results, outcome_of, read_row, write_results

# The command of a comparison.
_NAME = "compare"
# What a comparison takes beside its time budget, in seconds: to start Blender, to read the scene, to write the report.
_START = 10.0
# So many comparisons are handed to a scheduler at once; each waits in a thread.
_AT_ONCE = 1024
# The time budget of a comparison whose plan names none.
_TIME = 120.0


@dataclass(frozen=True)
class Outlook:
    """What a plan would do.

    It has all its comparisons with the journal's entry of each, those to run, and the most seconds that they take.
    `expected` are the seconds that they take if they are like those in the journal, None where there are none.
    """

    units: tuple[tuple[Unit, Entry | None], ...]
    missing: tuple[Unit, ...]
    most: float | None
    expected: float | None


def run_plan(plan: BatchPlan, how: How, tell: Tell, progress: Progress = NO_PROGRESS, end: End = End()) -> int:  # noqa: B008
    """Run the comparisons that the journal lacks, and write the tables.

    Returns the exit code of the batch, as `end` says. `tell` gets a line about each comparison, and one about all;
    `progress` receives what is begun, and the share that is done.
    """
    with prepare(plan, how, tell, progress) as batch:
        # Also what a killed batch left of comparisons that this plan does not ask for.
        for left in sorted(path.parent for path in plan.out.glob(f"*/{UNFINISHED}*")):
            clear_unfinished(left)
        try:
            _run_missing(batch, tell, progress)
        finally:
            results = Results(plan, [read_row(plan, *one) for one in batch.recorded()], end)
            write_results(results)
    for line in results.sentences():
        tell(line)
    return results.exit_code


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
    """Run every missing unit, side by side, and journal each as it ends.

    `tell` gets the result of each.
    """
    total, missing = len(batch.units), _longest_first(batch)
    done = total - len(missing)
    if done:
        tell(f"{done} of {plural(total, 'comparison')} {'was' if done == 1 else 'were'} done before")
    begin, stop = time.monotonic(), threading.Event()
    # A scheduler has a queue of its own, and workers may come later.
    jobs = batch.how.jobs if batch.how.cluster is None else _AT_ONCE
    # What the comparisons before it have left in a process is no part of a comparison's memory.
    turns = batch.plan.per_process if batch.plan.memory_limit is None else 1
    kinds = [batch.units[key].blender or "" for key in missing]
    with (
        _fork_servers(batch, kinds) as forks,
        closing(Ahead(_NAME, [_command(batch, key) for key in missing], kinds, jobs, turns, forks)) as ahead,
        ThreadPoolExecutor(max_workers=jobs) as pool,
    ):
        waiting = [
            pool.submit(_run_unit, batch, key, ahead, number, stop, progress) for number, key in enumerate(missing)
        ]
        try:
            for number, future in enumerate(as_completed(waiting), 1):
                entry = future.result()
                batch.journal.write(entry)
                reason = f": {entry.message}" if entry.message else ""
                left = (time.monotonic() - begin) / number * (len(missing) - number)
                rest = f"; about {format_duration(left)} left" if number < len(missing) else ""
                label = batch.units[entry.key].label
                tell(f"[{done + number}/{total}] {label}: {outcome_of(entry)}{reason} ({entry.seconds:.0f} s){rest}")
                progress.report((done + number) / total)
        except BaseException:
            stop.set()
            ended = [future for future in waiting if not future.cancel()]
            # What has finished in the same moment is kept.
            for future in ended:
                if future.exception() is None:
                    batch.journal.write(future.result())
            raise


@contextmanager
def _fork_servers(batch: Batch, kinds: Sequence[str]) -> Iterator[dict[str, ForkServer]]:
    """The fork server of the Blender at hand, if several comparisons, of `kinds`, need that and it can have one."""
    here = [kind for kind in kinds if kind not in batch.how.hosts]
    if batch.how.cluster is not None or len(here) < 2 or not can_fork():
        yield {}
        return
    with closing(ForkServer([*etalon_command(), _NAME])) as server:
        yield dict.fromkeys(here, server)


def _longest_first(batch: Batch) -> list[str]:
    """The keys of the missing comparisons in the order in which they begin.

    Scenes that took long go before those that took less, going by the journal, so that a long one is not alone at the end. Those that it
    does not know come first, in the plan's order.
    """
    seconds: dict[str, list[float]] = {}
    for entry in batch.journal.read_all().values():
        if entry.status == FINISHED:
            seconds.setdefault(entry.scene, []).append(entry.seconds)
    means = {scene: sum(times) / len(times) for scene, times in seconds.items()}
    return sorted(batch.missing, key=lambda key: -means.get(batch.units[key].scene, math.inf))


def _command(batch: Batch, key: str) -> Command:
    """The command line that runs words of `etalon` in the Blender of one comparison."""
    host = batch.how.hosts.get(batch.units[key].blender or "")
    return host.command if host is not None else lambda words: [*etalon_command(), *words]


def _run_unit(batch: Batch, key: str, ahead: Ahead, number: int, stop: threading.Event, progress: Progress) -> Entry:
    """Run one comparison, the missing one of that `number`, and return its result.

    It runs in a process that `ahead` gives its words, or on a worker.
    """
    plan, how, unit = batch.plan, batch.how, batch.units[key]
    progress.begin(unit.label)
    folder = _folder_name(unit, key)
    begin = time.perf_counter()
    words = [*unit.arguments(), *plan.options, "--quiet"]
    limits = Limits(plan.time_limit, plan.memory_limit, stop.is_set)
    if how.cluster is not None:
        files = batch.files.get(unit.target, {})
        status, code, message = run_on_cluster(how.cluster, [_NAME, *words], files, plan.out / folder, limits)
    else:
        words += [] if how.threads is None else [f"--threads={how.threads}"]
        words.append(f"--out={plan.out / folder}")
        status, code, message = run_comparison(
            partial(ahead.begin, number, words), plan.out / folder, limits, partial(ahead.release, number)
        )
    assignments = json.dumps({v.name: value for v, value in unit.assignments})
    return Entry(key, unit.scene, assignments, status, code, time.perf_counter() - begin, message, folder)


def _folder_name(unit: Unit, key: str) -> str:
    """A folder name that keeps nothing a file system could read as more than a name."""
    return f"{re.sub(r'[^A-Za-z0-9]+', '_', Path(unit.scene).stem)[:40]}-{key}"
