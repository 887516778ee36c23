# SPDX-License-Identifier: GPL-3.0-or-later
"""Findings that only Blender's data show.

They are settings that the neutral state sets aside on both sides.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy
import numpy as np

from ...lib.plural import plural
from ...lib.scene.findings import Finding, list_names
from ...lib.scene.mesh import Mesh
from ..cycles.neutral import BUMP_FILTER_WIDTH
from .refusals import is_portal

# By release: the object's own properties, or those that Cycles adds to it. The first moves shadow rays, the others darken less near the edge.
_TERMINATOR = (
    "shadow_terminator_geometry_offset",
    "shadow_terminator_normal_offset",
    "shadow_terminator_shading_offset",
    "shadow_terminator_offset",
)

_MOST_FILES = 20


def find_set_aside(depsgraph: bpy.types.Depsgraph, mesh: Mesh, wants_blur: bool = False) -> tuple[Finding, ...]:
    """The settings of the scene's objects and lights that are compared in their neutral state.

    `wants_blur`: motion blur is to be compared, which the scene may have switched off.
    """
    # The object of an instance is a temporary copy, gone at the next step; its original stays.
    things = [
        instance.object.original if instance.is_instance else instance.object
        for instance in depsgraph.object_instances
        if instance.show_self
    ]
    found = (
        _motion_blur(depsgraph, wants_blur),
        _terminator(things, mesh),
        _soft_falloff(things),
        _light_sampling(things),
        _portals(things),
        _catchers(mesh),
        _bump_filter(depsgraph),
    )
    return tuple(finding for finding in found if finding is not None)


def find_lines(scene: bpy.types.Scene) -> tuple[Finding, ...]:
    """Whether Freestyle draws lines; the export has it off, so ask before."""
    if not (scene.render.use_freestyle and any(layer.use and layer.use_freestyle for layer in scene.view_layers)):
        return ()
    return (
        Finding(
            "Freestyle",
            "Freestyle is off on both sides.",
            "Its lines are drawn over the finished image.",
            "Switch Freestyle off to render what is compared.",
        ),
    )


def find_missing_images(missing: Sequence[str]) -> tuple[Finding, ...]:
    """The images that are missing, each a sentence without its full stop.

    Both sides show magenta in their place.
    """
    if not missing:
        return ()
    shown = "; ".join(missing[:_MOST_FILES]) + (
        f"; and {len(missing) - _MOST_FILES} more" if len(missing) > _MOST_FILES else ""
    )
    return (
        Finding(
            "missing textures",
            f"{plural(len(missing), 'image is', 'images are')} missing: {shown}.",
            "Both sides show magenta (1, 0, 1) there.",
            "Restore the files, or choose others.",
        ),
    )


def _motion_blur(depsgraph: bpy.types.Depsgraph, is_wanted: bool) -> Finding | None:
    is_on = depsgraph.scene_eval.render.use_motion_blur and depsgraph.view_layer_eval.use_motion_blur
    if is_on == is_wanted:
        return None
    if is_on:
        return Finding(
            "motion blur",
            "Motion blur is off on both sides.",
            "What moves is compared as it stands at this frame.",
            "Switch Motion Blur off to render what is compared, or compare with --motion-blur.",
        )
    return Finding(
        "motion blur",
        "The scene or its view layer has Motion Blur off, so --motion-blur changes nothing.",
        "What moves is compared as it stands at this frame.",
        "Switch Motion Blur on in the scene and its view layer, or leave --motion-blur out.",
    )


def _light_sampling(things: list[bpy.types.Object]) -> Finding | None:
    lights = [o for o in things if o.type == "LIGHT"]
    names = list(dict.fromkeys(o.name for o in lights if not o.data.cycles.use_multiple_importance_sampling))
    if not names:
        return None
    return Finding(
        "light sampling",
        f"Multiple importance sampling of {plural(len(names), 'light')} is on on both sides: {list_names(names)}.",
        "With it off, Cycles' reflected and refracted rays do not meet the light: mirrors do not show it, and noise differs.",
        "Switch Multiple Importance on in the light's settings to render what is compared.",
    )


def _portals(things: list[bpy.types.Object]) -> Finding | None:
    names = list(dict.fromkeys(o.name for o in things if o.type == "LIGHT" and is_portal(o.data)))
    if not names:
        return None
    return Finding(
        "light portals",
        f"{plural(len(names), 'area light is a portal', 'area lights are portals')}: {list_names(names)}.",
        "A portal gives no light. It changes the noise of Cycles' image, not its mean; the reference samples the world without it.",
        "Switch Portal off where the light should shine.",
    )


def _catchers(mesh: Mesh) -> Finding | None:
    names = list(dict.fromkeys(thing.name for thing in mesh.objects if thing.catches_shadows))
    if not names:
        return None
    are = "object is a shadow catcher" if len(names) == 1 else "objects are shadow catchers"
    return Finding(
        "shadow catchers",
        f"{len(names)} {are}: {list_names(names)}.",
        "Shown pixels of shadow catchers are set aside: both sides are black there. All else is compared, with the light and the shadows that"
        " come from the catchers, and with their mirror images.",
        "Switch Shadow Catcher off to compare the object itself.",
    )


def _terminator(things: list[bpy.types.Object], mesh: Mesh) -> Finding | None:
    smooth = {mesh.objects[k].name for k in np.unique(mesh.object_index[mesh.smooth])}
    names = list(dict.fromkeys(o.name for o in things if o.name in smooth and _moves_terminator(o)))
    if not names:
        return None
    return Finding(
        "shadow terminator offset",
        f"The shadow terminator offset of {plural(len(names), 'smooth object')} is off on both sides: {list_names(names)}.",
        "With it, Cycles' shadows on coarse smooth meshes are lighter, by 0.8 % on a sphere of 8 rings.",
        "Set the offsets to 0 to render what is compared.",
    )


def _moves_terminator(thing: bpy.types.Object) -> bool:
    return any(getattr(owner, name, 0.0) != 0.0 for owner in (thing, thing.cycles) for name in _TERMINATOR)


def _soft_falloff(things: list[bpy.types.Object]) -> Finding | None:
    lights = [o for o in things if o.type == "LIGHT" and o.data.type in ("POINT", "SPOT")]
    names = list(
        dict.fromkeys(
            o.name for o in lights if getattr(o.data, "use_soft_falloff", False) and o.data.shadow_soft_size > 0.0
        )
    )
    if not names:
        return None
    return Finding(
        "soft falloff",
        f"Soft falloff of {plural(len(names), 'light')} is off on both sides: {list_names(names)}.",
        "With it, a lamp is a disk turned to each point, and objects close to it are lit otherwise than compared here.",
        "Switch Soft Falloff off in the light's settings to render what is compared.",
    )


def _bump_filter(depsgraph: bpy.types.Depsgraph) -> Finding | None:
    shown = (instance.object for instance in depsgraph.object_instances if instance.show_self)
    materials = dict.fromkeys(slot.material for thing in shown for slot in thing.material_slots)
    names = [one.name for one in materials if one is not None and one.node_tree and any(_wide_bumps(one.node_tree))]
    if not names:
        return None
    return Finding(
        "bump filter width",
        f"The Filter Width of Bump nodes is {BUMP_FILTER_WIDTH:g} pixels on both sides, in {plural(len(names), 'material')}:"
        f" {list_names(names)}.",
        "A larger one smooths bumps that are smaller than a pixel. Blender gives 1 to files from before 4.5.",
        f"Set it to {BUMP_FILTER_WIDTH:g} to render what is compared.",
    )


def _wide_bumps(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    """Yield Bump nodes with another Filter Width than the neutral state.

    Those of the tree's groups count too, those that do nothing do not.
    """
    for node in tree.nodes:
        if node.mute:
            continue
        if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None:
            yield from _wide_bumps(node.node_tree)
        elif node.bl_idname == "ShaderNodeBump" and node.inputs["Height"].is_linked:
            width = node.inputs.get("Filter Width")
            if width is not None and width.default_value != BUMP_FILTER_WIDTH:
                yield node
