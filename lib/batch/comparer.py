# SPDX-License-Identifier: GPL-3.0-or-later
"""A process that compares: an `etalon compare`, or one that runs several, one after the other.

The second kind is started ahead and gets a line of words for each comparison. It says that a comparison is over in a line on standard
error, which begins with a word that only it and this process know. So nothing that a scene has printed is taken for it.
"""

from __future__ import annotations

import contextlib
import json
import queue
import secrets
import subprocess
import threading
import time
from pathlib import Path

from .forks import ForkServer
from .process import AHEAD, ANSWER, LEASH, Process, end, send, start

# A process that waits ends once its standard input is closed; one that still loads does so first. In seconds.
_PATIENCE = 10.0


class Comparer:
    """A process that compares, and what it says.

    `turns` counts the comparisons that it was given, and `is_free` says whether it waits for another one.
    """

    def __init__(
        self,
        command: list[str],
        temporary: Path | None = None,
        ahead: bool = False,
        forks: ForkServer | None = None,
    ) -> None:
        """Start `command`, an `etalon compare`; started `ahead`, it gets its words from `give`.

        Its temporary files go to the folder `temporary`, as `start` says. With `forks`, it is forked there instead.
        Raises OSError.
        """
        self.turns, self.is_free = 0, ahead
        self._answer = secrets.token_hex(16)
        variables = {ANSWER: self._answer} if ahead else {}
        self.process: Process
        if forks is not None:
            self.process = forks.fork({LEASH: AHEAD, **variables})
        else:
            pipes = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, "encoding": "utf-8", "errors": "replace"}
            self.process = start(command, temporary, leash=True, ahead=ahead, variables=variables, **pipes)
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._errors: list[str] = []
        self._reader = threading.Thread(target=self._read, name="errors", daemon=True)
        self._reader.start()

    def give(self, words: list[str]) -> bool:
        """Give the process the words of one comparison; whether there is somebody to read them."""
        self.turns, self.is_free = self.turns + 1, False
        self._errors.clear()
        try:
            send(self.process, json.dumps(words) + "\n")
        except OSError:
            return False
        return True

    def wait(self, seconds: float) -> tuple[int, str] | None:
        """Wait for the end of the comparison; return its exit code and its errors.

        None where it has not ended after `seconds`.
        """
        until = time.monotonic() + seconds
        while True:
            try:
                line = self._lines.get(timeout=max(until - time.monotonic(), 0.0))
            except queue.Empty:
                return None
            if line is None:
                return self.process.wait(), "".join(self._errors)
            before, answer, code = line.partition(self._answer)
            self._errors.append(before)
            if answer:
                self.is_free = True
                return int(code), "".join(self._errors)

    def end(self) -> None:
        """End the process at once, and close its pipes."""
        self.is_free = False
        end(self.process)
        self.close_input()
        self._reader.join(_PATIENCE)

    def dismiss(self) -> None:
        """Have a process that waits end by itself, so that it removes its temporary files."""
        self.close_input()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(_PATIENCE)
        self.end()

    def close_input(self) -> None:
        """Close the standard input of the process, which ends it."""
        if self.process.stdin is not None:
            # What a process that is gone did not read is lost.
            with contextlib.suppress(OSError):
                self.process.stdin.close()

    def _read(self) -> None:
        """Queue the lines of standard error, and None at its end."""
        if self.process.stderr is not None:
            with self.process.stderr as errors:
                for line in errors:
                    self._lines.put(line)
        self._lines.put(None)
