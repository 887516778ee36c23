# SPDX-License-Identifier: GPL-3.0-or-later
"""Other processes: how to start another `etalon`, how to talk to one, and how to end it."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any, Protocol

LEASH = "ETALON_LEASH"
"""The variable of the environment that tells another `etalon` to end when its standard input does."""
AHEAD = "ahead"
"""The value of LEASH with which another `etalon` loads Blender, and then runs its command for each line of words that it reads."""
FORKS = "forks"
"""The value of LEASH with which another `etalon` loads no Blender, and forks such processes on request."""
ANSWER = "ETALON_ANSWER"
"""The variable with the word that begins the line in which such an `etalon` says how a command has ended."""
OURS = "etalon: "
"""What Étalon says on standard error begins so."""


class Process(Protocol):
    """What a batch uses of a process: a subprocess.Popen, or a ForkedProcess."""

    @property
    def pid(self) -> int:
        """Its number, which is that of its process group, too."""
        ...

    @property
    def stdin(self) -> IO[str] | None:
        """What it reads, or None."""

    @property
    def stderr(self) -> IO[str] | None:
        """Where it writes errors, or None."""

    def poll(self) -> int | None:
        """Its exit code, or None while it runs."""

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end; returns its exit code."""
        ...

    def kill(self) -> None:
        """End it at once."""


def find_blender() -> str | None:
    """The Blender program that this process is.

    None where it is Python, with Blender as a module or without.
    """
    bpy = sys.modules.get("bpy")
    # Where a script has set the module's empty path to "", Blender has made the working directory of it.
    return bpy.app.binary_path if bpy is not None and Path(bpy.app.binary_path).is_file() else None


def etalon_command() -> list[str]:
    """The command that starts another `etalon`.

    It goes through the Blender program if this process is one, else through Python.
    """
    blender = find_blender()
    return [blender, "--background", "--command", "etalon"] if blender else [sys.executable, "-m", "etalon"]


def start(
    command: list[str],
    temporary: Path | None = None,
    leash: bool = False,
    ahead: bool = False,
    variables: Mapping[str, str] | None = None,
    **pipes: Any,
) -> subprocess.Popen[str]:
    """Start `command` in a process group of its own.

    A Ctrl-C on the terminal then reaches only this process. The temporary files of the new process go to the folder
    `temporary`, so that they go with that folder even where it is ended at once. With a `leash`, which another `etalon`
    heeds, it ends when this process does, even where this one is killed. One that is started `ahead` waits for its words, as
    AHEAD says. Its environment is this one's with `variables`.
    """
    # BLAS's own threads would wait for those that render: Étalon's products of matrices have three rows.
    environment = {"OPENBLAS_NUM_THREADS": "1", **os.environ, **(variables or {})}
    if temporary is not None:
        environment |= dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(temporary))
    if leash:
        environment[LEASH] = AHEAD if ahead else "1"
        pipes["stdin"] = subprocess.PIPE
    if sys.platform == "win32":
        flags = subprocess.CREATE_NEW_PROCESS_GROUP
        return subprocess.Popen(command, text=True, env=environment, creationflags=flags, **pipes)
    return subprocess.Popen(command, text=True, env=environment, start_new_session=True, **pipes)


def send(process: Process, line: str) -> None:
    """Write `line` to the process's standard input at once.

    Raises OSError if nobody reads it any more. Python ignores SIGPIPE and gets that error; inside Blender the signal
    would end Blender. Nothing stays in a buffer that could be written later, without this guard.
    """
    if process.stdin is None:
        raise ValueError("the process was started without a pipe to its standard input")
    if sys.platform == "win32":
        os.write(process.stdin.fileno(), line.encode())
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGPIPE})
    try:
        os.write(process.stdin.fileno(), line.encode())
    finally:
        if signal.SIGPIPE in signal.sigpending():
            signal.sigwait({signal.SIGPIPE})
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def own_errors(errors: str) -> list[str]:
    """What `etalon` said on standard error, a text a line; Blender may write there too, even as the process ends."""
    lines = [line.strip() for line in errors.replace("\r", "\n").split("\n")]
    return [line.removeprefix(OURS) for line in lines if line.startswith(OURS)]


def own_mistake(errors: str) -> str:
    """The error in Étalon itself that a process told of, '' without one.

    It is Python's last line, which stands before Étalon's own; Blender may write after both.
    """
    lines = [line.strip() for line in errors.replace("\r", "\n").split("\n") if line.strip()]
    told = [k for k, line in enumerate(lines) if line.startswith(OURS)]
    return lines[told[-1] - 1] if told and told[-1] > 0 else ""


def last_lines(text: str, most: int = 3) -> str:
    """The last lines of what a process wrote, `most` of those that are not empty, as one line."""
    lines = [line.strip() for line in text.replace("\r", "\n").split("\n")]
    return "; ".join([line for line in lines if line][-most:])


def end(process: Process) -> None:
    """End a process and its children at once, and wait until they have ended."""
    if process.poll() is None:
        if sys.platform == "win32":
            process.kill()
        else:
            # It may end between the question and the answer.
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
    process.wait()
