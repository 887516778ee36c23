# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of images that have several, and the frames of movies.

This file finds which one the scene's frame shows, and reads it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy

from ....lib.textures.tiles import tile_corner


@dataclass(frozen=True)
class Still:
    """One file at `path`, of several, or one frame of the movie that is there."""

    path: str
    frame: int | None = None


def frame_of_user(user: bpy.types.ImageUser, scene_frame: int) -> int:
    """The number of the file of a sequence, or of the frame of a movie, that `scene_frame` shows.

    A sequence's first frame shows file 1 plus the offset, its last stays; a cyclic one starts again. Without a duration it is 0,
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
def read_still(still: Still, image: bpy.types.Image) -> Iterator[bpy.types.Image | None]:
    """Yield one file or frame with the settings of `image`; None where it cannot be read.

    Nothing is left in Blender's data afterwards.
    """
    read = _load_file(still.path, image) if still.frame is None else image.copy()
    if read is None:
        yield None
        return
    try:
        readable = still.frame is None or _decode(read, still.frame)
        if readable and read.type in ("IMAGE", "UV_TEST"):
            readable = bool(read.size[0] and read.size[1])
        yield read if readable else None
    finally:
        bpy.data.images.remove(read)


def _load_file(path: str, image: bpy.types.Image) -> bpy.types.Image | None:
    try:
        read = bpy.data.images.load(path)
    except RuntimeError:
        return None
    if image.colorspace_settings.name:
        read.colorspace_settings.name = image.colorspace_settings.name
    read.alpha_mode = image.alpha_mode
    return read


def _decode(movie: bpy.types.Image, frame: int) -> bool:
    """Whether Blender can decode `frame`, from 1, which is then in the pixels of `movie`.

    A frame beyond the ends is the first or the last. Scaling to the same size is how a script asks for a frame.
    """
    width, height = movie.size
    try:
        movie.scale(max(width, 1), max(height, 1), frame=frame)
    except RuntimeError:
        return False
    return True
