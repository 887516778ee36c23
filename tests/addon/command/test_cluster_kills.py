# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch on a scheduler with two workers, of which parts are killed at random moments.

These parts are the command, a worker, and the process of a comparison below a worker. Nothing that was finished is
lost, and neither processes nor files are left behind. Where the command lives, it finishes everything.
"""

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from contextlib import ExitStack
from pathlib import Path

import pytest
from etalon.tests.killed import ENDS, PATIENCE, SMALL, Place

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are found in Linux's /proc")
PLAN = f"""
out = "sweep"
scenes = ["lambert_analytic"]
[options]
samples = 2
replicates = 2
threads = 1
passes = "none"
set = ["{SMALL}"]
seed = [0, 1]
"""
UNITS = 2
PARTS = ("command", "worker", "comparison")


class Machines:
    """A scheduler and two workers without nannies, as processes of a place."""

    def __init__(self, place, stack, distributed):
        self._place, self._stack, self._count = place, stack, 0
        self.folder = place.work / "dask"
        self.folder.mkdir()
        self._log = stack.enter_context((self.folder / "log").open("w"))
        told = self.folder / "scheduler.json"
        words = ["--host=127.0.0.1", "--port=0", "--no-dashboard", f"--scheduler-file={told}"]
        self._scheduler = self._start(["scheduler", *words])
        wait_until(told.is_file, self._scheduler)
        self.address = json.loads(told.read_text())["address"]
        self._client = stack.enter_context(distributed.Client(self.address, set_as_default=False))
        self.workers = {}
        self.complete()

    def numbers(self):
        """The numbers of the scheduler's and the workers' processes."""
        return {process.pid for process in (self._scheduler, *self.workers.values())}

    def complete(self):
        """Start workers in the places of those that have ended, and wait until the scheduler has both."""
        self.workers = {name: worker for name, worker in self.workers.items() if worker.poll() is None}
        while len(self.workers) < 2:
            self._count += 1
            name = f"w{self._count}"
            words = [self.address, "--nthreads=1", "--no-nanny", "--no-dashboard", f"--name={name}"]
            self.workers[name] = self._start(["worker", *words, f"--local-directory={self.folder}"])
        wait_until(lambda: self._known() == set(self.workers), self._scheduler)

    def comparisons(self):
        """The numbers of the processes below workers in which comparisons run."""
        parents, found = {worker.pid for worker in self.workers.values()}, []
        for number in self._place.processes():
            try:
                status = Path(f"/proc/{number}/stat").read_text()
                words = Path(f"/proc/{number}/cmdline").read_bytes().split(b"\0")
            except OSError:
                continue
            if b"compare" in words and int(status.rpartition(")")[2].split()[1]) in parents:
                found.append(number)
        return found

    def left(self):
        """The files that comparisons left on workers."""
        return [path for path in self.folder.rglob("tmp*/**/*") if path.is_file()]

    def _known(self):
        def names(dask_scheduler):
            return [worker.name for worker in dask_scheduler.workers.values()]

        return set(self._client.run_on_scheduler(names))

    def _start(self, words):
        process = self._place.start(words, "dask", self._log)
        self._stack.callback(process.wait, PATIENCE)
        self._stack.callback(process.terminate)
        return process


def wait_until(is_there, process):
    """Look again and again whether something is there, while a process runs."""
    end = time.perf_counter() + PATIENCE
    while not is_there():
        assert time.perf_counter() < end
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.05)


def kill(part, how, process, machines, rng):
    """Send a signal to a part of a batch; whether it was there."""
    if part == "command":
        process.send_signal(how)
    elif part == "worker":
        worker = machines.workers[rng.choice(sorted(machines.workers))]
        worker.send_signal(how)
        worker.wait(PATIENCE)
    else:
        while not (found := machines.comparisons()):
            try:
                process.wait(0.05)
                return False
            except subprocess.TimeoutExpired:
                continue
        try:
            os.kill(int(rng.choice(found)), how)
        except ProcessLookupError:
            return False
    return True


def run_and_kill(place, machines, words, part, how, latest, rng):
    """Run the batch, kill a part of it at a random moment; return the exit code, None where it was not killed."""
    before, left = place.finished(), place.left()
    process, is_killed = place.start(words), False
    try:
        process.wait(rng.uniform(0.0, latest))
    except subprocess.TimeoutExpired:
        is_killed = kill(part, how, process, machines, rng)
    _, errors = process.communicate(timeout=600)
    assert "Traceback" not in errors
    assert process.returncode in ENDS | {-signal.SIGKILL}, errors
    machines.complete()
    assert place.all_end(machines.numbers()), (part, how)
    assert before <= place.finished()
    assert machines.left() == [], (part, how)
    if part != "command" or how == signal.SIGTERM:
        assert set(place.left()) <= set(left), (part, how)
    if part == "worker" or (part == "comparison" and how == signal.SIGKILL):
        assert place.is_done(UNITS), errors
    return process.returncode if is_killed else None


@pytest.mark.parametrize(
    "kills", [pytest.param(3, marks=pytest.mark.slow), pytest.param(50, marks=pytest.mark.benchmark)]
)
def test_kills_on_a_cluster_lose_nothing_and_leave_nothing(tmp_path, rng, monkeypatch, kills):
    distributed = pytest.importorskip("distributed", reason="Dask is not installed; `pip install etalon[cluster]`")
    place, counted = Place(tmp_path, PLAN), Counter()
    monkeypatch.setenv("DASK_TEMPORARY_DIRECTORY", str(place.work / "dask"))  # the scheduler's own, which it leaves
    with ExitStack() as stack:
        machines = Machines(place, stack, distributed)
        words = ["batch", "plan.toml", f"--scheduler={machines.address}", "--quiet"]
        seconds = place.finish(words)
        for number in range(kills):
            if place.is_done(UNITS):  # begin again, with other seeds
                first = UNITS * (number + 1)
                place.plan(PLAN.replace("[0, 1]", str(list(range(first, first + UNITS)))))
            part, how = PARTS[number % 3], (signal.SIGTERM, signal.SIGKILL)[(number + number // 3) % 2]
            code = run_and_kill(place, machines, words, part, how, seconds, rng)
            counted[f"{part} {how.name}, " + ("over before" if code is None else f"ended with {code}")] += 1
        place.finish(words)
        assert place.is_done(UNITS)
        assert place.all_end(machines.numbers())
    assert place.all_end()
    assert place.left() == machines.left() == []
    lines = [f"{count} x {what}" for what, count in sorted(counted.items())]
    sys.stdout.write("\n".join([f"{kills} kills, {seconds:.1f} s for a batch without one", *lines, ""]))
