# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the whole process that make tiles fast.

They concern the allocator of the C library, and how Python's threads take turns.
They are for processes of Étalon's own: the command `etalon`, also within `blender --command`, the second Blender, the
children of a batch. Each calls `tune_process` when it starts. Nobody else does: in the Blender that a user works in,
and in a script that imports the package, both stay as they are.
"""

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

# Seconds after which a thread that wants the interpreter gets it. Between two array operations a thread needs it for microseconds; with
# Python's own 5 ms it may wait for many of the other's. In two threads glossy_spheres takes 2 % less, veach_plates 3, cornell_glossy 7.
SWITCH_INTERVAL = 5e-5


class _State:
    """Whether this process was tuned."""

    tuned = False


def tune_process() -> None:
    """Set this process up for tracing tiles.

    Call it once, at the start of a process that does nothing else.
    Threads hand the interpreter on after `SWITCH_INTERVAL`. glibc keeps a tile's arrays when they are freed, and gives
    an image's back: by itself it returns arrays of some 100 kB to the system at every free and has their pages faulted
    in again at the next use, which costs kernels up to a factor of two; or, once it has seen large ones freed, keeps
    those too. Elsewhere the heap stays as it is.
    """
    sys.setswitchinterval(SWITCH_INTERVAL)
    mallopt = _glibc("mallopt")
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _KEPT)
        mallopt(_M_TRIM_THRESHOLD, _SPARE)
        mallopt(_M_ARENA_MAX, _ARENAS)
    _State.tuned = True


def give_back_memory() -> None:
    """Return to the system what glibc kept of the tiles' arrays in a tuned process.

    This is about 100 MB a thread. Call it before another program's part begins.
    """
    trim = _glibc("malloc_trim") if _State.tuned else None
    if trim is not None:
        trim(0)


def _glibc(name: str) -> Callable[..., int] | None:
    """A function that only glibc has."""
    return getattr(ctypes.CDLL(None), name, None) if sys.platform == "linux" else None
