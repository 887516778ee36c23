# SPDX-License-Identifier: GPL-3.0-or-later
"""What `etalon batch` costs beside its comparisons.

These are seconds of each, how busy the processors are, and finding its place in a long journal.

    python tests/benchmarks/batches.py [--units 20] [--jobs 2] [--rows 10000]

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
scenes = ["glossy_spheres"]
[options]
{work}
threads = 1
set = ["scene.render.resolution_x=128", "scene.render.resolution_y=128", "scene.render.resolution_percentage=100"]
[[vary]]
path = "scene.cycles.seed"
values = {values}
"""


FIXED = "samples = 4\nreplicates = 8"
RENDERING = ("timing the renderers", "looking for caustics", "first look", "rendering")
# One comparison of FIXED where it stands: processor seconds of its stages, Python's start and the imports first.
STAGES = """
import json, sys, time
from pathlib import Path
import bpy
from etalon import reference_scenes
from etalon.addon.command import compare
from etalon.lib.progress import Progress
from etalon.lib.settings.comparison import Settings
from etalon.lib.wavefront.tuning import tune_process

begun = [("start and imports", 0.0)]
def begin(stage):
    begun.append((stage, time.process_time()))
tune_process()
begin("opening the scene")
reference_scenes.build("glossy_spheres")
render = bpy.context.scene.render
render.resolution_x = render.resolution_y = 128
settings = Settings(samples=4, replicates=8, threads=1)
compare.job.compare_here(bpy.context.scene, settings, Path(sys.argv[1]), "", Progress(begin=begin))
begin("end")
print()
print(json.dumps({name: later - at for (name, at), (_, later) in zip(begun, begun[1:])}))
"""


def children_seconds() -> float:
    """Processor seconds of all processes that were started here and have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure_sweep(folder: Path, units: int, seconds: float, jobs: int) -> None:
    """Run a batch as a command, and print what it costs beside its comparisons.

    Printed are the seconds of a unit beside its comparison, and the share of `jobs` processors that was used.
    """
    plan = folder / "plan.toml"
    plan.write_text(PLAN.format(work=f'time = "{seconds}s"', values=list(range(units))))
    words = [sys.executable, "-m", "etalon", "batch", str(plan), f"--jobs={jobs}", "--quiet"]
    used, begin = children_seconds(), time.perf_counter()
    subprocess.run(words, check=False, stdout=subprocess.DEVNULL)
    wall, used = time.perf_counter() - begin, children_seconds() - used
    rows = json.loads((folder / "sweep" / "batch.json").read_text(encoding="utf-8"))["comparisons"]
    beside, sizes = [], []
    for row in rows:
        place = folder / "sweep" / row["folder"]
        beside.append(row["seconds"] - json.loads((place / "verdict.json").read_text(encoding="utf-8"))["seconds"])
        sizes.append(sum(file.stat().st_size for file in place.iterdir()))
    print(
        f"beside its comparison a unit takes {statistics.median(beside):.2f} s (median of {units}, worst {max(beside):.2f} s)"
    )
    print(f"{wall:.0f} s for {units} units of {seconds:g} s; {used / wall / jobs:.0%} of {jobs} processors in use")
    print(f"a report has {statistics.median(sizes) / 1e6:.2f} MB")
    begin = time.perf_counter()
    subprocess.run([*words, "--dry-run"], check=True, stdout=subprocess.DEVNULL)
    print(
        f"the command finds its place among {units} rows in {time.perf_counter() - begin:.2f} s, its own start included"
    )


def measure_unit(folder: Path, units: int = 4) -> None:
    """Print the processor seconds of a unit with fixed samples.

    Prints those of its stages in one process beside them.

    They do not depend on what else the machine does.
    """
    plan = folder / "fixed.toml"
    plan.write_text(PLAN.format(work=FIXED, values=list(range(units))).replace("sweep", "fixed"))
    words = [sys.executable, "-m", "etalon", "batch", str(plan), "--jobs=1", "--quiet"]
    used = []
    for call in ([*words, "--dry-run"], words):
        before = children_seconds()
        subprocess.run(call, check=False, stdout=subprocess.DEVNULL)
        used.append(children_seconds() - before)
    unit = (used[1] - used[0]) / units
    told = subprocess.run([sys.executable, "-c", STAGES, str(folder / "stages")], check=True, capture_output=True)
    stages = json.loads(told.stdout.splitlines()[-1])
    for name, seconds in stages.items():
        print(f"  {seconds:6.2f} {name}")
    rendering = sum(seconds for name, seconds in stages.items() if name in RENDERING)
    print(f"a unit takes {unit:.2f} processor seconds, {unit - rendering:.2f} of them beside rendering")


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
    plan.write_text(PLAN.format(work="time = 1", values=list(range(rows))).replace("sweep", "long"))
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
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        (Path(made) / "long").mkdir()
        measure_resume(Path(made), arguments.rows)
        measure_unit(Path(made))
        measure_start()
        measure_sweep(Path(made), arguments.units, arguments.seconds, arguments.jobs)


if __name__ == "__main__":
    main()
