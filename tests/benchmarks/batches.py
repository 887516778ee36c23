# SPDX-License-Identifier: GPL-3.0-or-later
"""What `etalon batch` costs beside its comparisons.

These are seconds of each, how busy the processors are, and finding its place in a long journal.

    python tests/benchmarks/batches.py [--units 20] [--jobs 2] [--rows 10000] [--per-process 20] [--scene lambert_analytic]

Processor seconds stand beside seconds by the clock, since other programs on the machine change only the latter.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from etalon.lib.batch.journal import Entry, open_journal
from etalon.lib.batch.plan import read_plan
from etalon.lib.batch.prepare import How
from etalon.lib.batch.run import preview_plan

PLAN = """
out = "sweep"
per_process = {turns}
scenes = ["{scene}"]
[options]
{work}
threads = 1
set = ["scene.render.resolution_x=128", "scene.render.resolution_y=128", "scene.render.resolution_percentage=100"]
[[vary]]
path = "scene.cycles.seed"
values = {values}
"""


FIXED = "samples = 4\nreplicates = 8"
# The stages, as a unit names them, that render what is compared.
RENDERING = ("timing the renderers", "first look", "rendering")
# Two comparisons of FIXED in one process: processor seconds of the stages of each, as a unit tells them. The start and the imports are the
# first's first stage; the process is forked, where those of a batch are.
STAGES = """
import json, os, sys, time
from pathlib import Path
from etalon.addon.host.fork_server import load
from etalon.lib.batch.forks import can_fork
if can_fork():
    load()
    if number := os.fork():
        sys.exit(os.waitstatus_to_exitcode(os.waitpid(number, 0)[1]))
import bpy
from etalon import reference_scenes
from etalon.addon.command import compare
from etalon.lib.progress import Progress
from etalon.lib.settings.comparison import Settings
from etalon.lib.wavefront.tuning import tune_process

tune_process()
told, begun = [], [("start and imports", 0.0)]
scene, *folders = sys.argv[1:]
for folder in folders:
    begun.append(("opening the scene", time.process_time()))
    reference_scenes.build(scene)
    render = bpy.context.scene.render
    render.resolution_x = render.resolution_y = 128
    settings = Settings(samples=4, replicates=8, threads=1)
    progress = Progress(begin=lambda stage: begun.append((stage, time.process_time())))
    compare.job.compare_here(bpy.context.scene, settings, Path(folder), "", progress)
    begun.append(("end", time.process_time()))
    told.append({})
    for (name, at), (_, later) in zip(begun, begun[1:]):
        told[-1][name] = told[-1].get(name, 0.0) + later - at
    begun = []
print()
print(json.dumps(told))
"""


class Used:
    """What a command took: seconds by the clock, and processor seconds of its processes."""

    def __init__(self, words: list[str]) -> None:
        """Run `words` to its end."""
        used, begin = children_seconds(), time.perf_counter()
        subprocess.run(words, check=False, stdout=subprocess.DEVNULL)
        self.wall, self.processor = time.perf_counter() - begin, children_seconds() - used


def children_seconds() -> float:
    """Processor seconds of all processes that were started here and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure_sweep(folder: Path, scene: str, units: int, seconds: float, jobs: int, turns: int) -> None:
    """Run a batch as a command, and print what it costs beside its comparisons.

    Printed are the seconds of a unit beside its comparison, and the share of `jobs` processors that was used: by the whole command, and
    without its own start and validation, which are what `--dry-run` takes.
    """
    plan = folder / "plan.toml"
    plan.write_text(PLAN.format(scene=scene, work=f'time = "{seconds}s"', values=list(range(units)), turns=turns))
    words = [sys.executable, "-m", "etalon", "batch", str(plan), f"--jobs={jobs}", "--quiet"]
    start, sweep = Used([*words, "--dry-run"]), Used(words)
    rows = json.loads((folder / "sweep" / "batch.json").read_text(encoding="utf-8"))["comparisons"]
    beside, sizes = [], []
    for row in rows:
        place = folder / "sweep" / row["folder"]
        beside.append(row["seconds"] - json.loads((place / "verdict.json").read_text(encoding="utf-8"))["seconds"])
        sizes.append(sum(file.stat().st_size for file in place.iterdir()))
    print(
        f"beside its comparison a unit takes {statistics.median(beside):.2f} s (median of {units}, worst {max(beside):.2f} s)"
    )
    print(f"{sweep.wall:.0f} s for {units} units of {seconds:g} s, {start.wall:.1f} s of them start and validation")
    later = (sweep.processor - start.processor) / (sweep.wall - start.wall)
    print(
        f"{sweep.processor / sweep.wall / jobs:.1%} of {jobs} processors in use, {later / jobs:.1%} without start and validation"
    )
    print(f"a report has {statistics.median(sizes) / 1e6:.2f} MB")
    resume = Used([*words, "--dry-run"])
    print(f"the command finds its place among {units} rows in {resume.wall:.2f} s, its own start included")


def measure_unit(folder: Path, scene: str, turns: int, units: int = 4) -> None:
    """Print the processor seconds of a unit with fixed samples beyond rendering.

    They are those of the stages of a second comparison in one process. Prints those of the first beside them, and what a batch with
    `units` more comparisons takes more than one with two. Other programs change them less than seconds by the clock.
    """
    used = []
    for count in (2, units + 2):
        plan = folder / f"fixed{count}.toml"
        plan.write_text(
            PLAN.format(scene=scene, work=FIXED, values=list(range(count)), turns=turns).replace(
                "sweep", f"fixed{count}"
            )
        )
        used.append(Used([sys.executable, "-m", "etalon", "batch", str(plan), "--jobs=1", "--quiet"]).processor)
    unit = (used[1] - used[0]) / units
    places = [str(folder / "first"), str(folder / "second")]
    told = subprocess.run([sys.executable, "-c", STAGES, scene, *places], check=True, capture_output=True)
    first, second = json.loads(told.stdout.splitlines()[-1])
    print("processor seconds of the first and of a later comparison in one process:")
    for name, seconds in first.items():
        print(f"  {seconds:6.2f} {second.get(name, 0.0):6.2f} {name}")
    beyond = [sum(s for name, s in stages.items() if name not in RENDERING) for stages in (first, second)]
    more = (beyond[0] - beyond[1]) / turns
    print(f"beyond rendering {beyond[1]:.2f} and, as a share of the first in each process, {more:.2f}")
    print(f"a later comparison takes {sum(second.values()):.2f} in all, and {unit:.2f} in a batch")


def measure_start(runs: int = 3) -> None:
    """Print what starting a unit's process takes, in parts."""
    for what, code in {"Python and bpy": "import bpy", "and Étalon": "import bpy, etalon.addon.job"}.items():
        used = children_seconds()
        for _ in range(runs):
            subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
        print(f"{what}: {(children_seconds() - used) / runs:.2f} processor seconds")


def measure_resume(folder: Path, rows: int) -> None:
    """Print how long a batch takes to find that `rows` comparisons are done or refused."""
    plan = folder / "long.toml"
    plan.write_text(
        PLAN.format(scene="glossy_spheres", work="time = 1", values=list(range(rows)), turns=1).replace("sweep", "long")
    )
    read = read_plan(plan)
    from etalon.lib.batch.keys import make_key

    with open_journal(read.out) as journal:
        for unit in read.units():
            journal.write(
                Entry(make_key(unit, read.options, "5.3.0", ""), unit.scene, "{}", "refused", 2, 1.0, "no", "x")
            )
    begin, used = time.perf_counter(), time.process_time()
    outlook = preview_plan(read, How("5.3.0"), print)
    used, wall = time.process_time() - used, time.perf_counter() - begin
    print(f"{rows - len(outlook.missing)} of {rows} rows are found in {wall:.2f} s, {used:.2f} processor seconds")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--units", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--rows", type=int, default=10_000)
    parser.add_argument("--scene", default="glossy_spheres")
    parser.add_argument("--per-process", type=int, default=1, help="comparisons that one process runs")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        (Path(made) / "long").mkdir()
        measure_resume(Path(made), arguments.rows)
        measure_unit(Path(made), arguments.scene, arguments.per_process)
        measure_start()
        measure_sweep(
            Path(made), arguments.scene, arguments.units, arguments.seconds, arguments.jobs, arguments.per_process
        )


if __name__ == "__main__":
    main()
