# SPDX-License-Identifier: GPL-3.0-or-later
"""The result of a cost measurement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .measure import Measurement
from .verify import Verification


@dataclass(frozen=True)
class Cost:
    """The result of a cost measurement.

    `measurement` has error and seconds of every strategy at every number of samples. `verification` is the test of a forecast, where
    one was asked for and made. `figures` is the dictionary that is written to cost.json.
    """

    measurement: Measurement
    verification: Verification | None
    figures: dict[str, Any]
