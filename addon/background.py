# SPDX-License-Identifier: GPL-3.0-or-later
"""Work beside a window that stays alive.

This is a copy of the open file, a thread, and the wish that it ends.
"""

from __future__ import annotations

import threading
from pathlib import Path

import bpy


def save_copy(path: Path) -> None:
    """Save a copy of the open file as `path`, without a preview picture.

    Drawing the preview can take longer than writing the file.
    """
    preferences = bpy.context.preferences
    is_dirty, kind = preferences.is_dirty, preferences.filepaths.file_preview_type
    preferences.filepaths.file_preview_type = "NONE"
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, check_existing=False)
    finally:
        preferences.filepaths.file_preview_type = kind
        preferences.is_dirty = is_dirty


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
