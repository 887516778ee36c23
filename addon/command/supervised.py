# SPDX-License-Identifier: GPL-3.0-or-later
"""`etalon` as a process that watches another one.

A crash of Blender or Cycles is one line and exit code 2. The work runs in a child. Its exit code, Ctrl-C and orders to
end pass through, and it ends with this process. On Windows, in Blender and under another `etalon` the command runs in
this process.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Sequence

from ...lib.batch.process import LEASH, etalon_command, start
from ...lib.exit_codes import ExitCode
from ...lib.settings.common import Target
from ..host.own_process import leave
from . import cli
from .table import COMMANDS

_PASSED_ON = ("SIGINT", "SIGTERM", "SIGHUP")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command, in a child where it loads a scene, and return its exit code."""
    words = list(sys.argv[1:] if argv is None else argv)
    alone = sys.platform == "win32" or "bpy" in sys.modules or LEASH in os.environ
    if alone or not _loads_scene(words):
        code = cli.main(words)
        if argv is None:
            # Blender and Python would take 0.3 s of the processor to free what they hold, and Blender would print behind an answer in JSON.
            leave(code)
        return code
    return supervise([*etalon_command(), *words])


def _loads_scene(words: list[str]) -> bool:
    """Whether the command that the words call takes a scene."""
    scenes = {command.name for command in COMMANDS if Target in command.settings}
    return next((word for word in words if not word.startswith("-")), None) in scenes


def supervise(command: list[str]) -> int:
    """Run `command` and return its exit code.

    Where a signal ended it, write one line and return BAD_INPUT.
    """
    process = start(command, leash=True)

    def pass_on(number: int, _frame: object) -> None:
        process.send_signal(number)

    before = {number: signal.signal(number, pass_on) for number in (getattr(signal, name) for name in _PASSED_ON)}
    try:
        code = process.wait()
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)
        if process.stdin is not None:
            process.stdin.close()
    return code if code >= 0 else _report_death(-code, process)


def _report_death(number: int, process: subprocess.Popen[str]) -> int:
    """Say which signal ended the child; returns the exit code."""
    name = signal.Signals(number).name if number in set(signal.Signals) else f"signal {number}"
    if name in _PASSED_ON:
        return ExitCode.INTERRUPTED
    if name == "SIGKILL":
        what = f"process {process.pid} was killed ({name}), as systems do when memory runs out; lower the resolution"
    else:
        what = f"Blender or Cycles crashed ({name}); open the file in Blender and render it there to see whether it crashes too"
    print(f"etalon: {what}", file=sys.stderr)
    return ExitCode.BAD_INPUT
