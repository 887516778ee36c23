# SPDX-License-Identifier: GPL-3.0-or-later
"""The exit codes of the command line, in one place."""

from __future__ import annotations

from enum import IntEnum


class ExitCode(IntEnum):
    """How a command ended.

    `etalon compare` ends with the code of its verdict, `etalon stability` with HELD or BROKEN, every other command with DONE. BAD_INPUT
    is also the code for a scene that is refused.
    """

    DONE = 0
    EQUIVALENT = 0
    HELD = 0
    DIFFERENT = 1
    BROKEN = 1
    BAD_INPUT = 2
    UNDECIDED = 3
    EXPLAINED = 4
    INTERNAL_ERROR = 70
    INTERRUPTED = 130


RESULTS = frozenset({ExitCode.DONE, ExitCode.DIFFERENT, ExitCode.UNDECIDED, ExitCode.EXPLAINED})
"""The codes with which a command has given its result."""
