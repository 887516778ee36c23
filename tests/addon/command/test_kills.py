# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands that are ended at random moments lose nothing that was finished.

They leave neither processes nor files behind.
"""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from contextlib import closing
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are found in Linux's /proc")
SMALL = "scene.render.resolution_percentage=10"
PLAN = f"""
out = "sweep"
scenes = ["lambert_analytic"]
[options]
time = "4s"
threads = 1
set = ["{SMALL}"]
[[vary]]
path = "scene.cycles.seed"
values = [1, 2, 3]
"""
COMMANDS = {
    "compare": ["compare", "lambert_analytic", "--time=8s", "--threads=1", f"--set={SMALL}", "--out=compare"],
    "audit": ["audit", "lambert_analytic", "--time=8s", "--threads=1", f"--set={SMALL}", "--out=audit", "--all"],
    "cost": ["cost", "lambert_analytic", "--time=8s", "--threads=1", f"--set={SMALL}", "--out=cost", "--ways=mis"],
    "batch": ["batch", "plan.toml"],
}
# Every way in which a command ends that finished, or was told to end: a verdict, 2 where a batch has less than all, interrupted,
# and the signal itself before the command has begun.
ENDS = {0, 1, 2, 3, 4, 130, -signal.SIGTERM}
PATIENCE = 60.0


class Place:
    """A folder in which commands run, and its content.

    Processes are known by a word in their environment.
    """

    def __init__(self, folder):
        self.work, self.temporary = folder / "work", folder / "tmp"
        self.work.mkdir()
        self.temporary.mkdir()
        (self.work / "plan.toml").write_text(PLAN)
        self.token = f"ETALON_TEST_PLACE={folder}"

    def start(self, name):
        key, _, value = self.token.partition("=")
        environment = os.environ | {key: value, "TMPDIR": str(self.temporary)}
        nowhere = subprocess.DEVNULL
        call = [sys.executable, "-m", "etalon", *COMMANDS[name]]
        return subprocess.Popen(
            call, cwd=self.work, env=environment, stdin=nowhere, stdout=nowhere, stderr=subprocess.PIPE, text=True
        )

    def finish(self, name):
        """Run a command to its end; return the seconds that it took."""
        begin = time.perf_counter()
        process = self.start(name)
        _, errors = process.communicate(timeout=600)
        assert process.returncode in {0, 1, 3, 4}, errors
        return time.perf_counter() - begin

    def processes(self):
        """The processes of this place that run."""
        found = []
        for path in Path("/proc").glob("[0-9]*/environ"):
            try:
                if self.token.encode() in path.read_bytes().split(b"\0"):
                    found.append(int(path.parent.name))
            except OSError:
                continue
        return found

    def all_end(self):
        """Whether all processes end in time."""
        end = time.perf_counter() + PATIENCE
        while self.processes() and time.perf_counter() < end:
            pass
        return not self.processes()

    def results(self, name):
        """The results of a command, and the time at which each was written."""
        folder = self.work / ("sweep" if name == "batch" else name)
        return {p.name: p.stat().st_mtime_ns for p in folder.iterdir() if p.is_file()}

    def finished(self):
        """The comparisons of the batch that are finished."""
        with closing(sqlite3.connect(self.work / "sweep" / "journal.sqlite")) as journal:
            rows = journal.execute("select key, folder from units where status = 'finished'").fetchall()
        for _, folder in rows:
            verdict = json.loads((self.work / "sweep" / folder / "verdict.json").read_text())
            assert verdict["stopped"] != "cancelled"
        return {key for key, _ in rows}

    def left(self):
        """What is half-written or temporary."""
        found = [*self.work.rglob(".unfinished-*"), *self.work.rglob("journal.lock"), *self.temporary.iterdir()]
        return sorted(str(path) for path in found)


@pytest.mark.parametrize(
    "kills", [pytest.param(4, marks=pytest.mark.slow), pytest.param(50, marks=pytest.mark.benchmark)]
)
def test_kills_lose_nothing_and_leave_nothing(tmp_path, rng, kills):
    place = Place(tmp_path)
    seconds = {name: place.finish(name) for name in COMMANDS}
    assert place.left() == []
    names = {name: set(place.results(name)) for name in COMMANDS}
    counted = Counter()
    for number in range(kills):
        name = list(COMMANDS)[number % len(COMMANDS)]
        how = (signal.SIGTERM, signal.SIGKILL)[(number + number // len(COMMANDS)) % 2]
        if name == "batch" and len(place.finished()) == 3:  # begin again, with other settings
            (place.work / "plan.toml").write_text(PLAN.replace("[1, 2, 3]", f"[{number}, {number + 1}, {number + 2}]"))
        before, finished, left = place.results(name), place.finished(), place.left()
        process = place.start(name)
        try:
            process.wait(rng.uniform(0.0, 1.1 * seconds[name]))
        except subprocess.TimeoutExpired:
            process.send_signal(how)
        _, errors = process.communicate(timeout=PATIENCE)
        assert "Traceback" not in errors
        assert process.returncode in ENDS | {-signal.SIGKILL}, errors
        assert place.all_end(), (name, how)
        after = place.results(name)
        if name != "batch":
            same = {file for file in before if after.get(file) == before[file]}
            assert not same or after == before, (name, how)
        assert finished <= place.finished()
        counted[f"{name} {how.name} ended with {process.returncode}"] += 1
        if how == signal.SIGTERM:
            assert set(place.left()) <= set(left)
    (place.work / "plan.toml").write_text(PLAN)
    for name in COMMANDS:
        place.finish(name)
        assert set(place.results(name)) == names[name]
    assert place.processes() == []
    assert place.left() == []
    lines = [f"{count} x {what}" for what, count in sorted(counted.items())]
    sys.stdout.write("\n".join([f"{kills} kills", *lines, ""]))
