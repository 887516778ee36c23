# SPDX-License-Identifier: GPL-3.0-or-later
"""A thread for work beside a window that stays alive, and the wish that it ends."""

from __future__ import annotations

import threading


class Background:
    """Work in a thread; the main thread makes, reads and ends it."""

    _thread: threading.Thread

    def __init__(self) -> None:
        self._cancel = threading.Event()

    @property
    def done(self) -> bool:
        """Whether the thread has ended."""
        return not self._thread.is_alive()

    @property
    def is_cancelled(self) -> bool:
        """Whether its end was requested."""
        return self._cancel.is_set()

    def wait(self) -> None:
        """Wait until the thread has ended."""
        self._thread.join()
