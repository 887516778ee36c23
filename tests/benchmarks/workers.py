# SPDX-License-Identifier: GPL-3.0-or-later
"""What a second worker brings to one comparison, and to one image of the reference.

Seconds of `etalon compare` and `etalon render` with one Dask worker of one thread, and with two, in pairs. The work is
fixed: the same samples and replicates.

    python tests/benchmarks/workers.py [--pairs 3] [--size 256] [--samples 32] [--replicates 8]

What the command takes for next to no work, its start and that of the workers' Blenders, is measured first and taken off.
Processor seconds of the command, the workers and the scheduler stand beside seconds by the clock.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

SCENE = "glossy_spheres"
TARGET = 1.8


@dataclass(frozen=True)
class Spent:
    """What a command took, in seconds: by the clock, and processor seconds of it, its workers and the scheduler."""

    wall: float
    command: float
    workers: tuple[float, ...]
    scheduler: float

    @property
    def processors(self) -> float:
        """Processor seconds of all."""
        return self.command + sum(self.workers) + self.scheduler


def wait(process: subprocess.Popen) -> float:
    """Wait for a process; its processor seconds, with those of the processes that it waited for."""
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return used.ru_utime + used.ru_stime


@contextmanager
def machines(folder: Path, count: int) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """A scheduler and `count` workers of one thread, which have registered; its address, and the processes."""
    from distributed import Client

    told, log = folder / f"scheduler-{time.monotonic_ns()}.json", (folder / "dask.log").open("a")
    dask, nowhere = [sys.executable, "-m", "dask"], {"stdout": log, "stderr": log, "cwd": folder}
    words = ["scheduler", "--host=127.0.0.1", "--port=0", "--no-dashboard", f"--scheduler-file={told}"]
    processes = [subprocess.Popen([*dask, *words], **nowhere)]
    while not told.is_file():
        time.sleep(0.05)
    address = json.loads(told.read_text())["address"]
    words = ["worker", address, "--nthreads=1", "--no-nanny", "--no-dashboard", f"--local-directory={folder}"]
    processes += [subprocess.Popen([*dask, *words], **nowhere) for _ in range(count)]
    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=60)
    try:
        yield address, processes
    finally:
        for process in processes:
            if process.returncode is None:
                process.terminate()
                process.wait()
        log.close()


def run(folder: Path, words: list[str], count: int) -> Spent:
    """Run a command of `etalon` on `count` workers."""
    with machines(folder, count) as (address, processes):
        begin = time.perf_counter()
        call = [sys.executable, "-m", "etalon", *words, f"--scheduler={address}", "--quiet"]
        process = subprocess.Popen(call, cwd=folder, stdout=subprocess.DEVNULL)
        command = wait(process)
        wall = time.perf_counter() - begin
        if process.returncode not in (0, 1, 3, 4):
            raise SystemExit(f"{' '.join(call)} ended with code {process.returncode}")
        used = []
        for one in reversed(processes):
            one.terminate()
            used.append(wait(one))
        return Spent(wall, command, tuple(reversed(used[:-1])), used[-1])


def describe(spent: Spent) -> str:
    """One line of figures."""
    workers = " + ".join(f"{one:.1f}" for one in spent.workers)
    load = os.getloadavg()[0]
    return (
        f"{spent.wall:6.1f} s; processor seconds: command {spent.command:.1f}, workers {workers}, "
        f"scheduler {spent.scheduler:.1f}; load {load:.1f}"
    )


def measure(name: str, words: list[str], least: list[str], folder: Path, pairs: int) -> None:
    """Print the seconds of a command on one worker and on two, in pairs whose order alternates."""
    starts = {count: run(folder, least, count) for count in (1, 2)}
    for count, spent in starts.items():
        print(f"{name}, {count} of 2 workers, next to no work: {describe(spent)}")
    whole, apart = [], []
    for number in range(pairs):
        found = {count: run(folder, words, count) for count in ((1, 2), (2, 1))[number % 2]}
        for count in (1, 2):
            print(f"{name}, {count} of 2 workers: {describe(found[count])}")
        whole.append(found[1].wall / found[2].wall)
        apart.append((found[1].wall - starts[1].wall) / (found[2].wall - starts[2].wall))
        more = found[2].processors / found[1].processors - 1
        print(f"  {whole[-1]:.2f} times as fast, {apart[-1]:.2f} without the start; {more:+.0%} processor seconds")
    print(
        f"{name}: two workers are {statistics.median(whole):.2f} times as fast as one, "
        f"{statistics.median(apart):.2f} without the start (medians of {pairs}; target {TARGET})"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--samples", type=int, default=32)
    parser.add_argument("--replicates", type=int, default=8)
    parser.add_argument("--only", choices=("compare", "render"))
    asked = parser.parse_args()
    sizes = {"x": asked.size, "y": asked.size, "percentage": 100}
    same = [SCENE, "--threads=1", *(f"--set=scene.render.resolution_{name}={value}" for name, value in sizes.items())]
    commands = {
        "compare": ["compare", *same, "--passes=none", "--size=full", "--time=1h", "--out=report"],
        "render": ["render", *same, "--out=image.exr"],
    }
    work = [f"--samples={asked.samples}", f"--replicates={asked.replicates}"]
    with tempfile.TemporaryDirectory() as made:
        for name, words in commands.items():
            if asked.only in (None, name):
                measure(name, [*words, *work], [*words, "--samples=1", "--replicates=2"], Path(made), asked.pairs)


if __name__ == "__main__":
    main()
