# SPDX-License-Identifier: GPL-3.0-or-later
"""A small scene in which an unexplained difference can still be seen.

It has one object, one light and one block of pixels.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import bpy

from ...lib.comparison.compare import Comparison
from ...lib.files.atomic import replace_file
from ...lib.report.words import furthest, unexplained

# So many parts of the scene are tried; each takes a comparison of its own.
TRIES = 4

Box = tuple[int, int, int, int]
Shows = Callable[[bpy.types.Scene], bool]


def where(comparison: Comparison) -> Box | None:
    """The block with the largest difference that no departure explains.

    It is first column, first row, last column, last row; None if all is explained. Pixels are those of the images that
    were compared, which may have fewer of them than the scene asks for.
    """
    left = set(unexplained(comparison))
    blocks = [k for k in comparison.regions.indices("block") if k in left]
    if not blocks:
        return tuple(int(edge) for edge in comparison.regions.boxes[furthest(comparison)[0]]) if left else None
    gap = abs(comparison.verdict.difference[blocks]).max(axis=1)
    return tuple(int(edge) for edge in comparison.regions.boxes[blocks[int(gap.argmax())]])


def seen(comparison: Comparison, box: Box) -> list[str]:
    """Names of the objects in the box, the one that covers most of it first."""
    regions = comparison.regions
    columns = range(box[0], box[2] + 1)
    pixels = [row * regions.shape[1] + column for row in range(box[1], box[3] + 1) for column in columns]
    objects = regions.indices("object")
    cover = {regions.names[k]: float(regions.weights[[k]][:, pixels].sum()) for k in objects}
    return sorted((name for name, share in cover.items() if share > 0.0), key=cover.get, reverse=True)


def write_minimal(scene: bpy.types.Scene, box: Box, names: list[str], shows: Shows, path: Path) -> None:
    """Write the smallest part of `scene` in which `shows` sees the difference, cut to `box`.

    `names` are the objects in the box, the most important first. The user's own scene is not touched. Where no part
    shows the difference, the file holds the whole scene, cut to the box. Raises EtalonError where the file cannot be
    written.
    """
    part = scene.copy()
    try:
        part.name = f"{scene.name} unexplained"
        _cut(part, box)
        for items, world in _parts(scene, names):
            _fill(part, items, world)
            if shows(part):
                break
        else:
            _fill(part, list(scene.objects), scene.world)
        with replace_file(path) as beside:
            bpy.data.libraries.write(str(beside), {part}, path_remap="ABSOLUTE", fake_user=True)
    finally:
        bpy.data.scenes.remove(part)


def _parts(scene: bpy.types.Scene, names: list[str]) -> Iterator[tuple[list[bpy.types.Object], bpy.types.World | None]]:
    """Yield the objects and the world of each part.

    First come parts of one object with one light, or with the world; at last one object with all of them.
    """
    shown = [scene.objects[name] for name in names[:1] if name in scene.objects]
    if not shown:
        return
    lights = [item for item in scene.objects if item.type == "LIGHT" and not item.hide_render]
    found = [([*shown, light], None) for light in lights]
    if scene.world is not None:
        found.append((shown, scene.world))
    yield from found[: TRIES - 1]
    yield [*shown, *lights], scene.world


def _fill(part: bpy.types.Scene, items: list[bpy.types.Object], world: bpy.types.World | None) -> None:
    """Make `items`, the camera and `world` all that `part` holds."""
    collection = part.collection
    for child in list(collection.children):
        collection.children.unlink(child)
    for item in list(collection.objects):
        collection.objects.unlink(item)
    for item in {part.camera, *items}:
        collection.objects.link(item)
    part.world = world


def _cut(part: bpy.types.Scene, box: Box) -> None:
    """Have only the box rendered."""
    render = part.render
    size = [round(s * render.resolution_percentage / 100) for s in (render.resolution_x, render.resolution_y)]
    first = (0, 0)
    if render.use_border:  # the box is counted from the border's own corner
        first = (round(render.border_min_x * size[0]), size[1] - round(render.border_max_y * size[1]))
    left, right = (first[0] + edge for edge in (box[0], box[2] + 1))
    top, bottom = (first[1] + edge for edge in (box[1], box[3] + 1))
    render.use_border = render.use_crop_to_border = True
    # A quarter of a pixel more, since Blender multiplies in single precision and cuts off.
    render.border_min_x, render.border_max_x = ((edge + 0.25) / size[0] for edge in (left, right))
    render.border_min_y, render.border_max_y = ((size[1] - edge + 0.25) / size[1] for edge in (bottom, top))
