# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own messages kept off the terminal."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout


def _flush_c_stdout() -> None:
    """Write out what C code has left in its buffer.

    Blender prints through C's stdout, not through Python's.
    """
    library = ctypes.cdll.ucrtbase if sys.platform == "win32" else ctypes.CDLL(None)
    library.fflush(None)


@contextmanager
def quiet() -> Iterator[None]:
    """Discard everything that is written to standard output.

    Blender reports every step of a render there.
    """
    sys.stdout.flush()
    _flush_c_stdout()
    kept = os.dup(1)
    with open(os.devnull, "w", encoding="utf-8") as nowhere, redirect_stdout(nowhere):
        os.dup2(nowhere.fileno(), 1)
        try:
            yield
        finally:
            _flush_c_stdout()
            os.dup2(kept, 1)
            os.close(kept)
