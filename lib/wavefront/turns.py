# SPDX-License-Identifier: GPL-3.0-or-later
"""How Python's threads take turns while tiles are traced."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

# Seconds after which a thread that wants the interpreter gets it. Between two array operations a thread needs it for microseconds; with
# Python's own 5 ms it may wait for many of the other's. In two threads glossy_spheres takes 2 % less, veach_plates 3, cornell_glossy 7.
INTERVAL = 5e-5


@contextmanager
def short_turns() -> Iterator[None]:
    """Let threads hand the interpreter on after `INTERVAL`; what was set before comes back."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(INTERVAL)
    try:
        yield
    finally:
        sys.setswitchinterval(before + 5e-7)  # Python cuts it off to whole microseconds
