# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures for processes that belong to Étalon alone.

Such a process ends with the process that started it, and removes its temporary files.
"""

from __future__ import annotations

import atexit
import json
import os
import sys
import tempfile
import threading
from contextlib import ExitStack

from ...lib.batch.process import AHEAD, LEASH
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
    """Whether the process that started this one tells it the rest of its words later."""
    return os.environ.get(LEASH) == AHEAD


def receive_words() -> list[str]:
    """Receive words as one line of JSON on standard input.

    Ends this process where no more words can come.
    """
    line = b""
    while not line.endswith(b"\n"):
        # One byte at a time: what comes later is for `watch_leash`.
        byte = os.read(0, 1)
        if not byte:
            leave()
        line += byte
    return json.loads(line)


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


def leave() -> None:
    """End this process at once, and remove its temporary files.

    It serves where Blender may be half initialised.
    """
    _temporary.close()
    os._exit(ExitCode.INTERRUPTED)
