# SPDX-License-Identifier: GPL-3.0-or-later
"""The answers of `etalon plan` on a scene.

It runs in a process of its own: a scene that crashes Blender is an answer like others.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..exit_codes import ExitCode
from .process import end, etalon_command, own_errors, start

# A scene that takes longer than so many seconds to load and export is given up.
PATIENCE = 600.0


@dataclass(frozen=True)
class Answer:
    """An answer of `etalon plan --json`.

    It has the exit code, what was `found`, or the `error` where no JSON was printed.
    """

    code: int
    found: dict[str, Any] | None
    error: str = ""


def ask_plan(target: str, options: Sequence[str], patience: float = PATIENCE) -> Answer:
    """Have `etalon plan` read the scene `target`, a path or a reference scene.

    It may take at most `patience` seconds.
    """
    command = [*etalon_command(), "plan", target, "--json", *options]
    process = start(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        out, err = process.communicate(timeout=patience)
    except subprocess.TimeoutExpired:
        end(process)
        return Answer(process.returncode, None, f"took longer than {patience:.0f} s")
    finally:
        end(process)
    try:
        return Answer(process.returncode, json.loads(out))
    except ValueError:
        pass
    if process.returncode == ExitCode.BAD_INPUT:
        said = (own_errors(err) or ["refused without a word"])[-1]
    else:
        said = f"Blender ended with code {process.returncode} while it read the file"
    return Answer(process.returncode, None, said)
