# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of images that have several.

This file finds which one a frame shows, and reads one of them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import bpy

from ....lib.textures.tiles import tile_corner


def frame_of_user(user: bpy.types.ImageUser, scene_frame: int) -> int:
    """The number of the file that a sequence shows at `scene_frame`.

    The sequence's first frame shows file 1 plus the offset, its last stays; a cyclic one starts again. Without a duration it is 0,
    whatever the offset.
    """
    length = user.frame_duration
    if length == 0:
        return 0
    frame = scene_frame - user.frame_start + 1
    frame = (frame - 1) % length + 1 if user.use_cyclic else min(max(frame, 0), length)
    return frame + user.frame_offset


def numbered_path(path: str, number: int) -> str:
    """`path` with the last digits of its name, before its suffix, replaced by `number`.

    The number keeps as many places.
    """
    folder, name = Path(path).parent, Path(path)
    found = re.fullmatch(r"(.*?)(\d+)(\D*)", name.stem, re.DOTALL)
    head, digits, tail = found.groups() if found else (name.stem, "", "")
    return str(folder / f"{head}{max(number, 0):0{len(digits)}d}{tail}{name.suffix}")


def tile_path(pattern: str, number: int) -> str | None:
    """The file of a tile; None where the pattern has no place for its number."""
    column, row = tile_corner(number)
    path = pattern.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{column + 1}_v{row + 1}")
    return None if path == pattern else path


def path_of_image(image: bpy.types.Image) -> str:
    """The image's absolute path.

    An image of several files has the one, or the pattern, that it was given.
    """
    return bpy.path.abspath(image.filepath, library=image.library)


@contextmanager
def read_file(path: str, image: bpy.types.Image) -> Iterator[bpy.types.Image | None]:
    """Yield one file with the settings of `image`; None where it cannot be read.

    Nothing is left in Blender's data afterwards.
    """
    try:
        still = bpy.data.images.load(path)
    except RuntimeError:
        yield None
        return
    try:
        if image.colorspace_settings.name:
            still.colorspace_settings.name = image.colorspace_settings.name
        still.alpha_mode = image.alpha_mode
        readable = still.type not in ("IMAGE", "UV_TEST") or (still.size[0] and still.size[1])
        yield still if readable else None
    finally:
        bpy.data.images.remove(still)
