# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a region lies in the scene: the objects that show it, and its part of the frame."""

from __future__ import annotations

import bpy

from ...lib.report.ranking import RankedRegion


def material_of(region: RankedRegion) -> str:
    """The name of the material that a region of the kind 'material' or 'facing' shows."""
    return region.name.rpartition(", ")[0] if region.kind == "facing" else region.name


def objects_with(view_layer: bpy.types.ViewLayer, kind: str, name: str) -> list[bpy.types.Object]:
    """The object of that name, or the objects with the material of that name.

    Empty for other kinds.
    """
    if kind == "object":
        return [thing for thing in view_layer.objects if thing.name == name]
    if kind != "material":
        return []
    return [o for o in view_layer.objects if any(s.material and s.material.name == name for s in o.material_slots)]


def select_only(context: bpy.types.Context, found: list[bpy.types.Object]) -> None:
    """Select these objects and no others, in Object Mode; the first becomes the active one."""
    if context.mode != "OBJECT":
        return
    for thing in context.view_layer.objects:
        thing.select_set(thing in found)
    context.view_layer.objects.active = found[0]


def select_objects(context: bpy.types.Context, region: RankedRegion) -> str:
    """Select the objects of a region.

    Returns the region's name where it has objects but they are all deleted.
    """
    if region.kind not in ("object", "material", "facing"):
        return ""
    kind, name = ("object", region.name) if region.kind == "object" else ("material", material_of(region))
    found = objects_with(context.view_layer, kind, name)
    if found:
        select_only(context, found)
    return "" if found else name


def set_border(scene: bpy.types.Scene, compared: tuple[float, float, float, float], region: RankedRegion) -> None:
    """Set the render region of `scene` to a region.

    The region is a part of the frame that was `compared`: left, bottom, right, top.
    """
    left, top, right, bottom = region.box
    x, y, width, height = compared[0], compared[1], compared[2] - compared[0], compared[3] - compared[1]
    render = scene.render
    render.use_border = region.kind != "image" or compared != (0.0, 0.0, 1.0, 1.0)
    render.border_min_x, render.border_max_x = x + width * left, x + width * right
    render.border_min_y, render.border_max_y = y + height * (1.0 - bottom), y + height * (1.0 - top)
