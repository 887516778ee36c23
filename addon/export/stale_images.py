# SPDX-License-Identifier: GPL-3.0-or-later
"""Images whose files changed after Blender read them.

Cycles reads the file, so Blender has to read it again.
"""

from __future__ import annotations

import os

import bpy

# By an image's session_uid: modification time, change time and size of its file when it was last read again; None where it was not there.
_read: dict[int, tuple[int, int, int] | None] = {}


def reload_stale_images() -> None:
    """Have Blender read again the images that may differ from their files.

    Images that are unsaved or packed stay. Blender does not say when it read a file, so each is read again once, and
    later only where its file has changed.
    """
    for image in bpy.data.images:
        if image.source != "FILE" or image.packed_file is not None or image.is_dirty or not image.has_data:
            continue
        stamp = _stamp(bpy.path.abspath(image.filepath, library=image.library))
        if image.session_uid not in _read or _read[image.session_uid] != stamp:
            image.reload()
            _read[image.session_uid] = stamp


def _stamp(path: str) -> tuple[int, int, int] | None:
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_ctime_ns, found.st_size
