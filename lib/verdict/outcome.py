# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of a verdict."""

from __future__ import annotations

from enum import Enum


class Outcome(Enum):
    """What is claimed of a region or an image.

    EXPLAINED: it differs from the reference, and named departures are sufficient to explain that (causes.py): with them switched on
    the reference agrees, and their share of the difference is near 1. Others may be sufficient, too.
    """

    EQUIVALENT = "EQUIVALENT"
    DIFFERENT = "DIFFERENT"
    UNDECIDED = "UNDECIDED"
    EXPLAINED = "EXPLAINED"

    @property
    def exit_code(self) -> int:
        """0 EQUIVALENT, 1 DIFFERENT, 3 UNDECIDED, 4 EXPLAINED; 2 is left to errors."""
        return {Outcome.EQUIVALENT: 0, Outcome.DIFFERENT: 1, Outcome.UNDECIDED: 3, Outcome.EXPLAINED: 4}[self]
