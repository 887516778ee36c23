# SPDX-License-Identifier: GPL-3.0-or-later
"""One comparison in a process of its own: running it, and what its end means."""

from __future__ import annotations

import subprocess
from pathlib import Path

from ..comparison.run import Stop
from ..errors import EtalonError
from ..exit_codes import ExitCode
from ..files.atomic import clear_unfinished
from ..report.read import read_verdict
from ..verdict.outcome import Outcome
from .process import end, start

VERDICTS: dict[int, str] = {outcome.exit_code: outcome.value for outcome in Outcome}
_OURS = "etalon: "


def run_comparison(command: list[str], folder: Path) -> tuple[str, int, str]:
    """Run an `etalon compare` that writes to `folder`, in a process of its own.

    Returns its status, 'finished', 'refused' or 'failed', its exit code, and the reason where it is not finished.
    """
    code, words = _run(command, folder)
    status, message = _judge(code, words, folder / "verdict.json")
    return status, code, message


def _judge(code: int, words: str, verdict: Path) -> tuple[str, str]:
    """The status of a comparison that ended with `code`, and the reason where it is not finished.

    A crash may end with any code; what counts as a verdict has been written as one, and not because the process was ended.
    """
    if code == ExitCode.BAD_INPUT:
        return "refused", words
    if code not in VERDICTS or not verdict.is_file():
        return "failed", words
    try:
        figures = read_verdict(verdict)
    except EtalonError as error:
        return "failed", str(error)
    if figures.get("stopped") == Stop.CANCELLED.value:
        return "failed", "it was ended by another process; run the batch again"
    return "finished", ""


def _run(command: list[str], folder: Path) -> tuple[int, str]:
    """Run `command`, which writes to `folder`; return its exit code and its reason."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "encoding": "utf-8", "errors": "replace"}
    process = start(command, leash=True, **pipes)
    try:
        _, errors = _communicate(process)
    except BaseException:
        end(process)
        raise
    finally:
        clear_unfinished(folder)
    return process.returncode, _reason(process.returncode, errors)


def _communicate(process: subprocess.Popen[str]) -> tuple[str, str]:
    """What the process prints; its standard input, which is its leash, stays open until it has ended."""
    leash, process.stdin = process.stdin, None
    try:
        return process.communicate()
    finally:
        if leash is not None:
            leash.close()


def _reason(code: int, errors: str) -> str:
    """Why a process ended: the first error that it names and how many more, or its last words."""
    lines = [line.strip() for line in errors.replace("\r", "\n").splitlines() if line.strip()]
    ours = [line.removeprefix(_OURS) for line in lines if line.startswith(_OURS)]
    if code == ExitCode.BAD_INPUT and ours:
        return ours[0] + (f" (and {len(ours) - 1} more)" if len(ours) > 1 else "")
    if code < 0:
        return f"it was ended by signal {-code}"
    return lines[-1].removeprefix(_OURS) if lines else f"the process ended with code {code}"
