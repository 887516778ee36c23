# SPDX-License-Identifier: GPL-3.0-or-later
"""What only a process of Étalon's own does to itself: it ends with the process that started it, and tidies its temporary files."""

from __future__ import annotations

import atexit
import os
import sys
import tempfile
import threading
from contextlib import ExitStack

from ...lib.batch.process import LEASH
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


def gather_temporary_files() -> None:
    """Have this process's temporary files, and those of the Blender that it is about to load, in one folder.

    It goes when the process ends. Where that is killed, the next one removes it.
    """
    if "bpy" in sys.modules:  # which has chosen its folder
        return
    folder = str(_temporary.enter_context(temporary_folder()))
    os.environ |= dict.fromkeys(("TMPDIR", "TEMP", "TMP"), folder)
    tempfile.tempdir = None
    atexit.register(_temporary.close)


def leave() -> None:
    """End this process at once, less its temporary files; for a moment at which Blender may be half initialised."""
    _temporary.close()
    os._exit(ExitCode.INTERRUPTED)
