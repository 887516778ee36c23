# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon batch`: many comparisons."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from tqdm import tqdm

from ...lib.batch.against import read_batch
from ...lib.batch.plan import BatchPlan, read_plan
from ...lib.batch.prepare import Host, How
from ...lib.batch.results import CHANGED, End, read_fail_on
from ...lib.batch.run import Outlook, preview_plan, run_plan
from ...lib.cluster.client import Cluster, connect
from ...lib.errors import EtalonError
from ...lib.exit_codes import ExitCode
from ...lib.memory import usable_memory
from ...lib.pages.formats import format_duration
from ...lib.plain_text import one_line
from ...lib.plural import plural
from ...lib.progress import Progress
from ...lib.settings.commands import BatchOptions
from ...lib.settings.common import LOCAL, PageTerminal, count_processors
from ...lib.versions.programs import Blender, find_blenders
from ..cycles.second_blender import WORKER
from ..host.blender import load_blender
from .batch_example import EXAMPLE
from .console import bar, ended_by_interrupt, open_page, print_json
from .doctor import PACKAGES

# Memory that a comparison of a large scene takes; more of them than fit are not run side by side.
MEMORY = 4e9


def run(settings: BatchOptions, terminal: PageTerminal) -> int:
    """Check a PLAN.toml and run it; the exit code is that of the worst comparison."""
    if settings.example:
        print(EXAMPLE.rstrip())
        return ExitCode.DONE
    plan = read_plan(settings.plan)
    with ended_by_interrupt():
        bpy = load_blender()
        from ...reference_scenes import SCENES
    plan.require_scenes(SCENES)
    end = _end(settings, plan)
    blender = f"{bpy.app.version_string} {bpy.app.build_hash.decode(errors='replace')}"
    tell = _tell_nobody if terminal.json else _tell
    with bar(settings.plan.stem, terminal) as shown, _workers(settings, plan, blender) as cluster:
        jobs, threads = (cluster.slots, None) if cluster else _share_processors(plan, settings.jobs)
        hosts = _find_hosts(plan, shown.begin)
        how = How(blender, hosts, jobs, threads, settings.force, settings.retry_failed, cluster)
        progress = Progress(shown.report, begin=shown.begin)
        if settings.dry_run:
            outlook = preview_plan(plan, how, tell, progress)
        else:
            code = run_plan(plan, how, tell, progress, end)
    if settings.dry_run:
        _print_outlook(outlook, how, terminal)
        return ExitCode.DONE
    page = plan.out / "batch.html"
    if terminal.json:
        print_json({"page": page, **json.loads((plan.out / "batch.json").read_text(encoding="utf-8"))})
    else:
        print(one_line(f"grid: {page}"))
    if terminal.open:
        open_page(page)
    return code


@contextmanager
def _workers(settings: BatchOptions, plan: BatchPlan, blender: str) -> Iterator[Cluster | None]:
    """Yield the workers of the scheduler, which have this Étalon and this Blender.

    None where everything runs here.
    """
    if settings.scheduler == LOCAL:
        yield None
        return
    if plan.blenders:
        raise EtalonError(f"--scheduler: 'blenders' of the plan are programs of this machine; leave it at {LOCAL}")
    if settings.jobs is not None:
        raise EtalonError("--jobs: workers say themselves how much runs side by side; use `dask worker --nthreads`")
    with connect(settings.scheduler) as cluster:
        cluster.check(blender)
        yield cluster


def _end(settings: BatchOptions, plan: BatchPlan) -> End:
    """How the batch ends.

    Raises EtalonError for an unknown rule, or an earlier batch that cannot be read.
    """
    earlier = None if settings.against is None else read_batch(settings.against)
    if earlier is not None and earlier["folder"].resolve() == plan.out.resolve():
        raise EtalonError(
            f"--against {settings.against}: is the folder of this batch; name that of an earlier one, or another 'out'"
        )
    try:
        rule = None if settings.fail_on is None else read_fail_on(settings.fail_on)
    except ValueError as error:
        raise EtalonError(f"--fail-on: {error}") from None
    if rule is not None and rule.rule == CHANGED and earlier is None:
        raise EtalonError("--fail-on changed needs an earlier batch; add --against EARLIER")
    return End(rule, earlier)


def _find_hosts(plan: BatchPlan, tell: Callable[[str], None]) -> dict[str, Host]:
    """The Blenders that the plan names, by what it calls them."""

    def host(blender: Blender) -> Host:
        return Host(f"{blender.label} {blender.build}", lambda words: blender.request({"words": words}))

    return {one.asked: host(one) for one in find_blenders(plan.blenders, WORKER, PACKAGES, tell)}


def _share_processors(plan: BatchPlan, jobs: int | None) -> tuple[int, int | None]:
    """How many comparisons run side by side, and the threads of each.

    The threads are given where the plan does not set them: together the comparisons use all processors.
    """
    processors = count_processors()
    asked = next((int(word.partition("=")[2]) for word in plan.options if word.startswith("--threads=")), None)
    if jobs is None:
        memory = usable_memory()
        fitting = processors if memory is None else int(memory / MEMORY)
        count = math.prod(len(v.values) for v in plan.variations) * len(plan.scenes)
        jobs = max(min(processors // (asked or 1), fitting, count), 1)
    varied = any(v.path == "--threads" for v in plan.variations)
    return jobs, None if asked or varied or jobs == 1 else max(processors // jobs, 1)


def _print_outlook(outlook: Outlook, how: How, terminal: PageTerminal) -> None:
    """Print what would be run, and how long it takes."""
    states = [entry.status if entry else "to run" for _, entry in outlook.units]
    missing = {id(unit) for unit in outlook.missing}
    rows = [
        (unit.label, "to run" if id(unit) in missing else state)
        for (unit, _), state in zip(outlook.units, states, strict=True)
    ]
    if terminal.json:
        figures = {"count": len(rows), "missing": len(missing), "jobs": how.jobs}
        times = {"most_seconds": outlook.most, "expected_seconds": outlook.expected}
        print_json(figures | times | {"comparisons": [{"comparison": label, "state": state} for label, state in rows]})
        return
    for label, state in rows:
        print(one_line(f"{state:9} {label}"))
    said = [f"{plural(len(rows), 'comparison')}, {len(missing)} to run, {how.jobs} side by side"]
    if missing and outlook.expected is not None:
        said.append(f"about {format_duration(outlook.expected)}, going by those in the journal")
    if missing and outlook.most is not None:
        said.append(f"at most about {format_duration(outlook.most)}")
    print("; ".join(said))


def _tell(line: str) -> None:
    """Print one line above the progress bar."""
    tqdm.write(one_line(line), file=sys.stdout)
    sys.stdout.flush()


def _tell_nobody(line: str) -> None:
    """Keep standard output for the JSON, which has the same facts."""
