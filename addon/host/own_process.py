# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures for processes that belong to Étalon alone.

Such a process ends with the process that started it, and removes its temporary files.
"""

from __future__ import annotations

import atexit
import json
import os
import queue
import sys
import tempfile
import threading
from contextlib import ExitStack
from typing import NoReturn

from ...lib.batch.process import AHEAD, ANSWER, FORKS, LEASH
from ...lib.exit_codes import ExitCode
from ...lib.files.ownership import temporary_folder

_temporary = ExitStack()


def watch_leash() -> None:
    """End this process at once when the one that started it has ended, however that happened.

    Nobody waits for its result then. The next run removes what it leaves.
    """
    if os.environ.pop(LEASH, None) is None:
        return

    def watch() -> None:
        while os.read(0, 1024):
            pass
        os._exit(ExitCode.INTERRUPTED)

    threading.Thread(target=watch, name="leash", daemon=True).start()


def is_ahead() -> bool:
    """Whether the process that started this one tells it its words later."""
    return os.environ.get(LEASH) == AHEAD


def is_fork_server() -> bool:
    """Whether the process that started this one asks it to fork others."""
    return os.environ.get(LEASH) == FORKS


class Orders:
    """Words that come as lines of JSON on standard input, one line for each command.

    Where no more can come, this process ends at once. Read it once Blender is loaded.
    """

    def __init__(self) -> None:
        """Receive them from now on."""
        os.environ.pop(LEASH, None)
        self._answer = os.environ.pop(ANSWER, "")
        self._lines: queue.SimpleQueue[list[str]] = queue.SimpleQueue()
        self._is_waiting = True
        threading.Thread(target=self._read, name="leash", daemon=True).start()

    def receive(self) -> list[str]:
        """Wait for the next words."""
        self._is_waiting = True
        words = self._lines.get()
        self._is_waiting = False
        return words

    def answer(self, code: int) -> bool:
        """Tell the process that gave the words how they have ended.

        Returns whether it wants to know.
        """
        if not self._answer:
            return False
        sys.stderr.flush()
        os.write(2, f"{self._answer}{code}\n".encode())
        return True

    def _read(self) -> None:
        rest = b""
        while data := os.read(0, 65536):
            *lines, rest = (rest + data).split(b"\n")
            for line in lines:
                self._lines.put(json.loads(line))
        if self._is_waiting:
            leave()
        # The next run removes what is left.
        os._exit(ExitCode.INTERRUPTED)


def gather_temporary_files() -> None:
    """Put the temporary files of this process into one folder.

    Those of the Blender that it is about to load go there too. The folder goes when the process ends. Where the
    process is killed, the next one removes the folder.
    """
    if "bpy" in sys.modules:  # which has chosen its folder
        return
    folder = str(_temporary.enter_context(temporary_folder()))
    os.environ |= dict.fromkeys(("TMPDIR", "TEMP", "TMP"), folder)
    tempfile.tempdir = None
    atexit.register(_temporary.close)


def leave(code: int = ExitCode.INTERRUPTED) -> NoReturn:
    """End this process at once with that exit code, and remove its temporary files.

    Blender may be half initialised. Whoever wrote to standard output has flushed it.
    """
    _temporary.close()
    os._exit(code)
