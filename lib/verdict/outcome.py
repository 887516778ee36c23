# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of a verdict."""

from __future__ import annotations

from enum import Enum

from ..exit_codes import ExitCode


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
    def exit_code(self) -> ExitCode:
        """The exit code of a comparison that ends so."""
        return ExitCode[self.name]
