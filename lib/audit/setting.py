# SPDX-License-Identifier: GPL-3.0-or-later
"""A departure from the neutral state that is to be measured."""

from __future__ import annotations

from dataclasses import dataclass

FILE, FACTORY = "file", "factory"


@dataclass(frozen=True)
class Setting:
    """One setting, or several `together`, away from their neutral values.

    `key` is unique and fit for a file name, `value` and `neutral` are what a user reads, `statement` says what it does to the image.
    `origin` is 'file' for the user's own value and 'factory' for the one that Blender starts with. `needs` is the number of samples a
    pixel that measuring it takes; `missing` says why it was not measured, or ''.
    """

    key: str
    label: str
    value: str
    neutral: str
    statement: str
    origin: str = FILE
    together: bool = False
    needs: int = 1
    missing: str = ""
