# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages where no scene is named, or there is none of that name.

This module does not load Blender.
"""

from __future__ import annotations

import difflib
import sys
from pathlib import Path

from ...lib.errors import EtalonError, unknown
from ...lib.settings.common import REFERENCE_SCENES, Target


def require_scene(command: str, target: Target) -> None:
    """Raise EtalonError where no scene is named and no file is open.

    A file is open where this runs inside of Blender. The message lists the reference scenes.
    """
    if target.scene is None and not _is_file_open():
        names = ", ".join(REFERENCE_SCENES)
        raise EtalonError(f"name a scene: etalon {command} FILE.blend, or a reference scene: {names}")


def describe_unknown(name: str) -> str:
    """The message for a `name` that is no reference scene and does not end in .blend.

    It suggests the nearest name.

    >>> describe_unknown("glossy_sphere")
    "unknown reference scene 'glossy_sphere'; did you mean 'glossy_spheres'?"
    """
    if Path(f"{name}.blend").is_file():
        return f"unknown reference scene '{name}'; did you mean the file '{name}.blend'?"
    message = unknown("reference scene", name, REFERENCE_SCENES)
    return message if message.endswith("?") else f"{message}; the name of a file ends in .blend"


def describe_missing(path: Path) -> str:
    """What is wrong with a file that is not there, with the nearest name in its folder."""
    folder = path.parent
    there = [found.name for found in folder.iterdir() if found.suffix == path.suffix] if folder.is_dir() else []
    near = difflib.get_close_matches(path.name, there, n=1)
    return f"{path}: no such file; " + (f"did you mean '{folder / near[0]}'?" if near else "check the path")


def _is_file_open() -> bool:
    """Whether Blender runs in this process and has a file open, other than the factory scene."""
    blender = sys.modules.get("bpy")
    return blender is not None and bool(blender.data.filepath)
