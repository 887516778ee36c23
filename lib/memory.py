# SPDX-License-Identifier: GPL-3.0-or-later
"""The memory of this machine."""

from __future__ import annotations

import os
from pathlib import Path

# Where Linux says how much a container may use (control groups, version 2 and 1).
_LIMITS = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))


def usable_memory() -> int | None:
    """The bytes of memory that this process may use, a container's limit included.

    None where the system does not say.
    """
    try:
        machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):  # Windows has no sysconf
        return None
    return min([machine, *(limit for limit in map(_read_limit, _LIMITS) if limit is not None)])


def resident_memory(process: int) -> int | None:
    """The bytes of memory that a process has in use.

    None where the system is not Linux or does not say, or where the process has ended.
    """
    try:
        pages = Path(f"/proc/{process}/statm").read_text().split()[1]
    except (OSError, IndexError):
        return None
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def _read_limit(path: Path) -> int | None:
    try:
        text = path.read_text().strip()
    except OSError:
        return None
    return int(text) if text.isdigit() else None
