# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the running Blender's definitions of colour spaces are."""

from __future__ import annotations

from pathlib import Path

import bpy


def color_configuration() -> Path:
    """The OpenColorIO configuration of the Blender that runs."""
    return Path(bpy.utils.system_resource("DATAFILES", path="colormanagement")) / "config.ocio"
