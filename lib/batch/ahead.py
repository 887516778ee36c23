# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes that are started ahead.

Each loads Blender while the comparisons before its own still render, then waits for its words.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
from collections.abc import Callable, Sequence

from .process import end, send, start_comparison

Command = Callable[[list[str]], list[str]]
"""The command line that runs words of `etalon` in one of the Blenders."""
Begin = Callable[[list[str]], subprocess.Popen[str]]
"""Gives the words of a comparison to a process, and returns it."""
# A process that waits ends once its standard input is closed; one that still loads does so first. In seconds.
_PATIENCE = 10.0


class Ahead:
    """The processes of comparisons that begin in order, `count` of them started ahead.

    `commands` has one entry for each comparison. A process runs one comparison, so one that crashes takes no other with it.
    """

    def __init__(self, name: str, commands: Sequence[Command], count: int) -> None:
        self._name, self._commands, self._count = name, commands, count
        self._waiting: dict[int, subprocess.Popen[str]] = {}
        self._begun: set[int] = set()

    def begin(self, number: int, words: list[str]) -> subprocess.Popen[str]:
        """The process of comparison `number`, which has got its words after the command's name.

        Another is started for the comparison that begins `count` later. Called again for the same comparison, it is a new process.
        """
        self._begun.add(number)
        process = self._waiting.pop(number, None)
        if process is None or not _tell(process, words):
            if process is not None:
                _discard(process)
            process = self._start(number)
            # A process that has ended is found by whoever waits for it.
            _tell(process, words)
        later = number + self._count
        if later < len(self._commands) and later not in self._begun:
            # Where it cannot be started now, its own turn says so.
            with contextlib.suppress(OSError):
                self._waiting[later] = self._start(later)
                self._begun.add(later)
        return process

    def close(self) -> None:
        """End the processes that still wait."""
        waiting, self._waiting = list(self._waiting.values()), {}
        for process in waiting:
            if process.stdin is not None:
                process.stdin.close()
        for process in waiting:
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(_PATIENCE)
            _discard(process)

    def _start(self, number: int) -> subprocess.Popen[str]:
        return start_comparison(self._commands[number]([self._name]), ahead=True)


def _tell(process: subprocess.Popen[str], words: list[str]) -> bool:
    """Give a process the rest of its command line; whether there is somebody to read it."""
    try:
        send(process, json.dumps(words) + "\n")
    except OSError:
        return False
    return True


def _discard(process: subprocess.Popen[str]) -> None:
    """End a process that nobody waits for, and close its pipes."""
    end(process)
    for pipe in (process.stdin, process.stdout, process.stderr):
        if pipe is not None:
            pipe.close()
