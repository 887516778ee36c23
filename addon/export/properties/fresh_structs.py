# SPDX-License-Identifier: GPL-3.0-or-later
"""The contents of fresh structs of the kinds that the export reads.

Blender itself fills them: RNA's own defaults are wrong for many of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

_NAME = ".etalon"
_DEEPEST = 3
"""Structs inside structs that are looked at; those of Blender's settings are less deep."""

# Group -> the collection of bpy.data that makes it, what `new` takes besides the name, and the path to the struct. For groups
# that are not here RNA's defaults have to do.
_LIGHTS = ("POINT", "SUN", "SPOT", "AREA")
_MAKERS: dict[str, tuple[str, tuple[tuple[Any, ...], ...], str]] = {
    "scene": ("scenes", ((),), ""),
    "render": ("scenes", ((),), "render"),
    "cycles": ("scenes", ((),), "cycles"),
    "view_layer": ("scenes", ((),), "view_layers[0]"),
    "view_layer.cycles": ("scenes", ((),), "view_layers[0].cycles"),
    "object": ("objects", ((None,),), ""),
    "object.cycles": ("objects", ((None,),), "cycles"),
    "mesh": ("meshes", ((),), ""),
    "light": ("lights", tuple((kind,) for kind in _LIGHTS), ""),
    "light.cycles": ("lights", (("POINT",),), "cycles"),
    "camera": ("cameras", ((),), ""),
    "camera.dof": ("cameras", ((),), "dof"),
    "world": ("worlds", ((),), ""),
    "world.cycles": ("worlds", ((),), "cycles"),
    "world.cycles_visibility": ("worlds", ((),), "cycles_visibility"),
    "material": ("materials", ((),), ""),
    "material.cycles": ("materials", ((),), "cycles"),
    "image": ("images", ((1, 1),), ""),
}


def make_structs() -> Iterator[tuple[str, Any]]:
    """Yield each group with a fresh struct of it.

    The datablock around the struct is removed again. Not to be called while a render runs.
    """
    for group, (collection, variants, path) in _MAKERS.items():
        made = getattr(bpy.data, collection)
        for arguments in variants:
            datablock = made.new(_NAME, *arguments)
            try:
                yield group, datablock.path_resolve(path) if path else datablock
            finally:
                # Blender 4.3 without a window crashes in `scenes.remove`.
                bpy.data.batch_remove((datablock,))


def content_of(owner: Any, name: str, depth: int = _DEEPEST) -> Any:
    """The content of a property, made comparable.

    It is the length of a collection, the name of a datablock, and of a struct all that can be set.
    """
    kind, value = owner.bl_rna.properties[name], getattr(owner, name)
    if kind.type == "COLLECTION":
        return len(value)
    if kind.type == "POINTER":
        if value is None or isinstance(value, bpy.types.ID):
            return None if value is None else value.name_full
        return _content_inside(value, depth - 1)
    if getattr(kind, "is_array", False):
        return tuple(map(tuple, value)) if kind.array_dimensions[1] else tuple(value)
    return tuple(sorted(value)) if isinstance(value, set) else value


def _content_inside(struct: Any, depth: int) -> tuple[tuple[str, Any], ...]:
    names = [one.identifier for one in struct.bl_rna.properties if not one.is_readonly or one.type == "POINTER"]
    return tuple((n, content_of(struct, n, depth)) for n in names if n != "rna_type") if depth > 0 else ()
