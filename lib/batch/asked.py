# SPDX-License-Identifier: GPL-3.0-or-later
"""The answers of `etalon plan` on a scene.

It runs in a process of its own: a scene that crashes Blender is an answer like others.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

from ..exit_codes import ExitCode
from ..progress import NO_PROGRESS, Progress
from .process import end, etalon_command, own_errors, own_mistake, start

# A scene that takes longer than so many seconds to load and export is given up.
PATIENCE = 600.0
# Seconds between two questions whether it is to end.
_INTERVAL = 0.2


@dataclass(frozen=True)
class Answer:
    """An answer of `etalon plan --json`.

    It has the exit code, what was `found`, or the `error` where no JSON was printed.
    """

    code: int
    found: dict[str, Any] | None
    error: str = ""


def ask_plan(
    target: str, options: Sequence[str], progress: Progress = NO_PROGRESS, patience: float = PATIENCE
) -> Answer:
    """Have `etalon plan` read the scene `target`, a path or a reference scene.

    It may take at most `patience` seconds, and ends with this process. Raises Cancelled when asked to stop.
    """
    progress.check()
    command = [*etalon_command(), "plan", target, "--json", *options]
    with (
        start(command, leash=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process,
        ThreadPoolExecutor(2) as readers,
    ):
        try:
            pipes = (pipe for pipe in (process.stdout, process.stderr) if pipe is not None)
            out, err = (readers.submit(pipe.read) for pipe in pipes)
            latest = time.monotonic() + patience
            while process.poll() is None and time.monotonic() < latest:
                progress.check()
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(_INTERVAL)
            late = process.poll() is None
        finally:
            end(process)
    if late:
        return Answer(process.returncode, None, f"took longer than {patience:.0f} s")
    return _read(process.returncode, out.result(), err.result())


def _read(code: int, out: str, err: str) -> Answer:
    """The answer of a process that ended with `code` and wrote these texts."""
    try:
        return Answer(code, json.loads(out))
    except ValueError:
        pass
    if code == ExitCode.BAD_INPUT:
        said = (own_errors(err) or ["refused without a word"])[-1]
    elif code == ExitCode.INTERNAL_ERROR:
        said = f"an error in etalon itself ({own_mistake(err)}); please report what `etalon plan` prints for this file alone"
    else:
        said = f"Blender ended with code {code} while it read the file"
    return Answer(code, None, said)
