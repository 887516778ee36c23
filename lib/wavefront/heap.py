# SPDX-License-Identifier: GPL-3.0-or-later
"""What the C library's allocator keeps and what it gives back."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable

# malloc.h of glibc.
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD, _M_ARENA_MAX = -1, -3, -8
# A tile's arrays are smaller, an image's are larger.
_KEPT = 8 << 20
# What two threads' tiles need. A heap of a thread's own ends at 64 MB, which one tile passes: all threads share one.
_SPARE = 192 << 20
_ARENAS = 1


def settle_heap() -> None:
    """Teach glibc to keep a tile's arrays when they are freed, and to give an image's back; elsewhere it does nothing.

    By itself it hands arrays of some 100 kB back to the system at every free and has their pages faulted in again at the next use,
    which costs kernels a factor of two; or, once it has seen large ones freed, keeps those too.
    """
    mallopt = _glibc("mallopt")
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _KEPT)
        mallopt(_M_TRIM_THRESHOLD, _SPARE)
        mallopt(_M_ARENA_MAX, _ARENAS)


def give_back() -> None:
    """Have glibc return what it kept of the tiles' arrays, 100 MB a thread, before another program's part begins; some milliseconds."""
    trim = _glibc("malloc_trim")
    if trim is not None:
        trim(0)


def _glibc(name: str) -> Callable[..., int] | None:
    """A function that only glibc has."""
    return getattr(ctypes.CDLL(None), name, None) if sys.platform == "linux" else None
