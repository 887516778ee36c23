# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder for commands that are killed, and what they leave there and among the processes."""

import json
import os
import select
import signal
import sqlite3
import subprocess
import sys
import time
from contextlib import closing
from pathlib import Path

SMALL = "scene.render.resolution_percentage=10"
# Every way in which a command ends that finished, or was told to end: a verdict, 2 where a batch has less than all, interrupted,
# and the signal itself before the command has begun.
ENDS = {0, 1, 2, 3, 4, 130, -signal.SIGTERM}
PATIENCE = 60.0


def wait_for_end(number, seconds):
    """Wait until the process `number`, which need not be a child of this one, has ended, `seconds` at most."""
    try:
        descriptor = os.pidfd_open(number)
    except ProcessLookupError:
        return
    try:
        select.select([descriptor], [], [], seconds)
    finally:
        os.close(descriptor)


class Place:
    """A folder in which commands run, and its content.

    `plan` is the text of the batch in it, whose results go to `sweep`. Processes are known by a word in their
    environment.
    """

    def __init__(self, folder, plan):
        self.work, self.temporary = folder / "work", folder / "tmp"
        self.work.mkdir()
        self.temporary.mkdir()
        self.token = f"ETALON_TEST_PLACE={folder}"
        self._done = set()
        self.plan(plan)

    def plan(self, text):
        """Write the plan of the batch; what was finished before is not of it."""
        (self.work / "plan.toml").write_text(text)
        self._done = self.finished()

    def is_done(self, count):
        """Whether `count` comparisons of the plan are finished."""
        return len(self.finished() - self._done) == count

    def start(self, words, module="etalon", errors=subprocess.PIPE):
        """Start a command whose errors go to `errors`."""
        key, _, value = self.token.partition("=")
        environment = os.environ | {key: value, "TMPDIR": str(self.temporary)}
        nowhere = subprocess.DEVNULL
        call = [sys.executable, "-m", module, *words]
        return subprocess.Popen(
            call, cwd=self.work, env=environment, stdin=nowhere, stdout=nowhere, stderr=errors, text=True
        )

    def finish(self, words):
        """Run a command to its end; return the seconds that it took."""
        begin = time.perf_counter()
        process = self.start(words)
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

    def all_end(self, but=()):
        """Whether all processes end in time, those of the numbers `but` aside."""
        end = time.perf_counter() + PATIENCE
        while (left := set(self.processes()) - set(but)) and time.perf_counter() < end:
            wait_for_end(left.pop(), max(end - time.perf_counter(), 0.0))
        return not left

    def results(self, name):
        """The results in a folder, and the time at which each was written."""
        folder = self.work / name
        return {p.name: p.stat().st_mtime_ns for p in folder.iterdir() if p.is_file()}

    def finished(self):
        """The comparisons of the batch that are finished."""
        if not (self.work / "sweep" / "journal.sqlite").is_file():
            return set()
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
