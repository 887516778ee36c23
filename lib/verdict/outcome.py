# SPDX-License-Identifier: GPL-3.0-or-later
"""The words of a verdict."""

from __future__ import annotations

from enum import Enum

from ..exit_codes import ExitCode


class Outcome(Enum):
    """What is claimed of a region or an image.

    EXPLAINED: it differs from the reference, and agrees with it once named departures are switched on there.
    """

    EQUIVALENT = "EQUIVALENT"
    DIFFERENT = "DIFFERENT"
    UNDECIDED = "UNDECIDED"
    EXPLAINED = "EXPLAINED"

    @property
    def exit_code(self) -> ExitCode:
        """The exit code of a comparison that ends so."""
        return ExitCode[self.name]
