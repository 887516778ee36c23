# SPDX-License-Identifier: GPL-3.0-or-later
"""What a batch reads from a scene beside its plan.

These are frames, cameras, view layers, and the files that decide how the scene looks.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import bpy

_NUMBER = re.compile(r"<UDIM>|<UVTILE>|\d+(?=\D*$)")


def read_facts() -> dict[str, Any]:
    """Facts on the open scene.

    They are its first and last frame, the names of cameras and view layers, and the paths of `external_files`.
    """
    scene = bpy.context.scene
    return {
        "frames": [scene.frame_start, scene.frame_end],
        "cameras": sorted(thing.name for thing in scene.objects if thing.type == "CAMERA"),
        "view_layers": [layer.name for layer in scene.view_layers],
        "files": external_files(),
    }


def external_files() -> list[str]:
    """The absolute paths of all files that the open file refers to.

    They are libraries, images and fonts; of sequences and tiled images every file.
    """
    found = {Path(path) for path in bpy.utils.blend_paths(absolute=True)}
    for image in bpy.data.images:
        if image.source in ("SEQUENCE", "TILED") and image.packed_file is None:
            path = Path(bpy.path.abspath(image.filepath, library=image.library))
            pattern = re.compile(_NUMBER.sub(r"\\d+", re.escape(path.name).replace(re.escape("<UDIM>"), "<UDIM>")))
            if path.parent.is_dir():
                found |= {one for one in path.parent.iterdir() if pattern.fullmatch(one.name)}
    return sorted(str(path.resolve()) for path in found)
