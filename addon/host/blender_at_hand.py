# SPDX-License-Identifier: GPL-3.0-or-later
"""What the Blender that runs Étalon must be: not too old, and not older than the file."""

from __future__ import annotations

import bpy

from ...lib.blender_versions import OLDEST, format_release
from ...lib.errors import EtalonError


def require_supported_blender() -> None:
    """Raise EtalonError in a Blender that is older than the oldest supported one."""
    if bpy.app.version[:2] < OLDEST:
        here, oldest = bpy.app.version_string, format_release(OLDEST)
        raise EtalonError(f"Blender {here} is too old; Étalon needs Blender {oldest} or newer")


def require_readable_file() -> None:
    """Raise EtalonError where the open file was saved by a newer Blender.

    This Blender loses data of such a file in silence.
    """
    saved = tuple(bpy.data.version)
    if saved[:2] > bpy.app.version[:2]:
        name = bpy.path.basename(bpy.data.filepath) or "the open file"
        needed = format_release(saved)
        raise EtalonError(
            f"{name}: was saved by Blender {needed}, and this is {bpy.app.version_string}, which loses what is new in it; "
            f"open it with Blender {needed} or newer"
        )
