# SPDX-License-Identifier: GPL-3.0-or-later
"""One comparison in another process: running it, and what its end means."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from ..comparison.run import Stop
from ..errors import EtalonError
from ..exit_codes import ExitCode
from ..files.atomic import clear_unfinished, replace_file
from ..memory import resident_memory
from ..pages.formats import format_duration, format_gigabytes
from ..report.read import read_verdict
from ..verdict.outcome import Outcome
from .comparer import Comparer
from .process import OURS, Process, last_lines, own_errors, own_mistake

VERDICTS: dict[int, str] = {outcome.exit_code: outcome.value for outcome in Outcome}


# So often a process is looked at, in seconds.
_LOOK = 0.25
FINISHED, REFUSED, FAILED, ENDED = "finished", "refused", "failed", "ended"
CRASH = "crash.txt"
"""The file, in the folder of a comparison that met an error in Étalon itself, with all that its process said."""


@dataclass(frozen=True)
class Limits:
    """Limits of one comparison.

    `seconds` and `memory` in bytes (None: no limit) are what it may take; `is_ending` says whether it is to end.
    """

    seconds: float | None = None
    memory: int | None = None
    is_ending: Callable[[], bool] = bool


NO_LIMITS = Limits()


def run_comparison(
    begin: Callable[[], Comparer],
    folder: Path,
    limits: Limits = NO_LIMITS,
    release: Callable[[Comparer], None] = Comparer.end,
) -> tuple[str, int, str]:
    """Run an `etalon compare` that writes to `folder`, in the process that `begin` starts.

    `release` gets the process where it has given a verdict. Returns its status, FINISHED, REFUSED, FAILED or ENDED from
    outside, its exit code, and the reason where it is not finished. One that crashed is run once more; then what it said is kept.
    """
    for _ in range(2):
        comparer = begin()
        code, errors, over = _run(comparer, folder, limits)
        if over:
            return (ENDED if limits.is_ending() else FAILED), code, over
        status, message = _judge(code, _reason(code, errors), folder / "verdict.json")
        if status == FINISHED:
            release(comparer)
            (folder / CRASH).unlink(missing_ok=True)
            break
        # Also one that was told to end, and has written what it had.
        comparer.dismiss()
        if status != FAILED:
            break
    if status == FAILED and code == ExitCode.INTERNAL_ERROR:
        # A disk that is full is no reason to end the batch.
        with suppress(EtalonError, OSError), replace_file(folder / CRASH) as beside:
            beside.write_text(errors, encoding="utf-8")
    return status, code, message


def _judge(code: int, words: str, verdict: Path) -> tuple[str, str]:
    """The status of a comparison that ended with `code`, and why it is not finished.

    The reason is empty where it is finished. A crash may end with any code. A verdict counts only where its file was
    written, and not because the process was ended.
    """
    if code == ExitCode.BAD_INPUT:
        return REFUSED, words
    if code not in VERDICTS or not verdict.is_file():
        return FAILED, words
    try:
        figures = read_verdict(verdict)
    except EtalonError as error:
        return FAILED, str(error)
    if figures.get("stopped") == Stop.CANCELLED.value:
        return ENDED, "it was ended by another process; run the batch again"
    return FINISHED, ""


def _run(comparer: Comparer, folder: Path, limits: Limits) -> tuple[int, str, str]:
    """Wait for a comparison that writes to `folder`; return what `_wait` does."""
    try:
        return _wait(comparer, limits)
    except BaseException:
        comparer.end()
        raise
    finally:
        clear_unfinished(folder)


def _wait(comparer: Comparer, limits: Limits) -> tuple[int, str, str]:
    """Wait for the comparison; return its exit code, its errors, and which limit ended it, or ''."""
    begin, over = time.monotonic(), ""
    while (ended := comparer.wait(_LOOK)) is None:
        over = over or _is_over(comparer.process, limits, time.monotonic() - begin)
        if over:
            comparer.end()
    return *ended, over


def _is_over(process: Process, limits: Limits, seconds: float) -> str:
    """Which limit a process has reached, or ''."""
    if limits.is_ending():
        return "it was ended with the command"
    if limits.seconds is not None and seconds > limits.seconds:
        return (
            f"it took longer than {format_duration(limits.seconds)}; raise 'time' in [limits], or lower the resolution"
        )
    used = None if limits.memory is None else resident_memory(process.pid)
    if limits.memory is not None and used is not None and used > limits.memory:
        return f"it took more than {format_gigabytes(limits.memory)} of memory; raise 'memory' in [limits], or lower the resolution"
    return ""


def _reason(code: int, errors: str) -> str:
    """Why a process ended: the first error that it names and how many more, or its last words."""
    ours = own_errors(errors)
    if code == ExitCode.BAD_INPUT and ours:
        return ours[0] + (f" (and {len(ours) - 1} more)" if len(ours) > 1 else "")
    if code < 0:
        said = last_lines(errors)
        return f"it was ended by signal {-code}" + (f" ({said})" if said else "")
    if code == ExitCode.INTERNAL_ERROR:
        return f"an error in etalon itself ({own_mistake(errors)}); please report it with the file {CRASH} in the folder of this comparison"
    return last_lines(errors, 1).removeprefix(OURS) or f"the process ended with code {code}"
