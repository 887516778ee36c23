# SPDX-License-Identifier: GPL-3.0-or-later
"""The processes of a batch.

Each loads Blender once and runs as many comparisons as the plan allows, one after the other. One that is needed later is started while
the comparisons before still render.
"""

from __future__ import annotations

import contextlib
import threading
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

from ..memory import resident_memory
from .comparer import Comparer
from .forks import ForkServer

Command = Callable[[list[str]], list[str]]
"""The command line that runs words of `etalon` in one of the Blenders."""
# A process that has more memory in use after a comparison is replaced, in bytes.
_MOST_MEMORY = 1.5e9


class Ahead:
    """The processes of comparisons that begin in order, `count` of them side by side.

    `commands` has one entry for each comparison, and `kinds` names the Blender of each; `forks` has the fork servers of those Blenders that
    have one. A process runs up to `turns` comparisons of one Blender. One that crashes takes no other comparison with it: those before it are
    done, and those after it get another process.
    """

    def __init__(
        self,
        name: str,
        commands: Sequence[Command],
        kinds: Sequence[str],
        count: int,
        turns: int,
        forks: Mapping[str, ForkServer] = MappingProxyType({}),
    ) -> None:
        self._name, self._commands, self._kinds, self._count, self._turns = name, commands, kinds, count, turns
        self._forks = forks
        self._waiting: defaultdict[str, list[Comparer]] = defaultdict(list)
        self._begun: set[int] = set()
        self._lock = threading.Lock()

    def begin(self, number: int, words: list[str]) -> Comparer:
        """The process of comparison `number`, which has got its words after the command's name.

        Where the comparison that begins `count` later will need another process, that is started now. Called again for the same comparison, it
        is a new process. Raises OSError where none can be started.
        """
        with self._lock:
            waiting = self._waiting[self._kinds[number]]
            process = waiting.pop() if waiting and number not in self._begun else None
            self._begun.add(number)
        if process is None or not process.give(words):
            if process is not None:
                process.end()
            process = self._start(number)
            # A process that has ended is found by whoever waits for it.
            process.give(words)
        self._start_later(number + self._count, self._kinds[number], process.turns)
        return process

    def release(self, number: int, process: Comparer) -> None:
        """Take back the process of a comparison that has given a verdict; one that is not to run another one is ended."""
        if not process.is_free:
            process.end()
        elif process.turns < self._turns and (resident_memory(process.process.pid) or 0) < _MOST_MEMORY:
            with self._lock:
                self._waiting[self._kinds[number]].append(process)
        else:
            process.dismiss()

    def close(self) -> None:
        """End the processes that still wait."""
        with self._lock:
            waiting = [process for kind in self._waiting.values() for process in kind]
            self._waiting.clear()
        for process in waiting:
            process.close_input()
        for process in waiting:
            process.dismiss()

    def _start_later(self, later: int, kind: str, turns: int) -> None:
        """Start a process for the comparison `later`, unless one will be there.

        The comparison that begins now is in a process of this `kind`, which has run `turns` with it.
        """
        if later >= len(self._commands) or later in self._begun:
            return
        wanted = self._kinds[later]
        if self._waiting[wanted] or (wanted == kind and turns < self._turns):
            return
        # Where it cannot be started now, its own turn says so.
        with contextlib.suppress(OSError):
            process = self._start(later)
            with self._lock:
                self._waiting[wanted].append(process)

    def _start(self, number: int) -> Comparer:
        command, forks = self._commands[number]([self._name]), self._forks.get(self._kinds[number])
        if forks is not None:
            # Where the server is gone, as systems end one when memory runs out, processes begin from nothing.
            with contextlib.suppress(ConnectionError):
                return Comparer(command, ahead=True, forks=forks)
        return Comparer(command, ahead=True)
