# SPDX-License-Identifier: GPL-3.0-or-later
"""Notices before the start of what would stop or change a comparison.

Settings are read when the panel is drawn. Node trees and objects are surveyed by a timer after a change, never while
drawing: by the types of nodes that count, which takes milliseconds. The export refuses more, such as values of sockets,
and names it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

import bpy

from ...lib.comparison.memory import lacking_memory
from ...lib.errors import Refusal
from ...lib.pages.formats import format_duration
from ..export.nodes.declarations import DECLARATIONS
from ..export.refusals import unsupported_kind
from ..host.frame import full_frame, rendered_region
from .errors import translate_error
from .properties import output_folder
from .text import translate
from .watching import redraw

DELAY = 0.5  # seconds after a change until the survey, so that a slider that is dragged is surveyed seldom
MOST = 6  # notices about materials and objects that are shown
_PASSED = {"NodeReroute", "ShaderNodeGroup", "NodeGroupInput", "NodeGroupOutput", "NodeFrame"}
_OUTPUTS = {"ShaderNodeOutputMaterial", "ShaderNodeOutputWorld"}
_OWNER = re.compile(r"(material|object|light|world) '(.*)'", re.DOTALL)


@dataclass(frozen=True)
class Notice:
    """A line for the panel.

    `kind` and `name` are what a button selects; `stops` says that nothing can be compared as it is.
    """

    text: str
    stops: bool = False
    kind: str = ""
    name: str = ""


def notices_of_settings(scene: bpy.types.Scene) -> list[Notice]:
    """What the scene's settings mean for a comparison; cheap enough for drawing."""
    found = []
    if scene.camera is None:
        found.append(Notice(translate("There is no camera: add one and make it active"), stops=True))
    if scene.render.engine != "CYCLES":
        found.append(Notice(translate("Another engine is chosen; Cycles' render is compared")))
    elif scene.cycles.device == "GPU":
        found.append(Notice(translate("Cycles is set to GPU; it is compared on the CPU")))
    has_blur = scene.render.use_motion_blur and any(one.use and one.use_motion_blur for one in scene.view_layers)
    if scene.etalon.motion_blur and not has_blur:
        found.append(Notice(translate("Motion blur is off in this scene or its view layer, so it is not compared")))
    if not bpy.data.filepath and scene.etalon.out.startswith("//"):
        found.append(Notice(translate("The file is not saved; results go to {folder}", folder=output_folder(scene))))
    return found


def describe_task(scene: bpy.types.Scene) -> str:
    """The size of what is compared, and the time that it takes at most."""
    *_, width, height = rendered_region(scene.render, *full_frame(scene.render))
    return translate(
        "{width} × {height} pixels, at most {time}",
        width=width,
        height=height,
        time=format_duration(round(scene.etalon.time)),
    )


def notice_of(refusal: Refusal) -> Notice:
    """A refusal of the export, with the thing that a button selects."""
    owner = _OWNER.fullmatch(refusal.owner)
    kind, name = owner.groups() if owner else ("", "")
    return Notice(translate_error(str(refusal)), stops=True, kind=kind, name=name)


_surveys: dict[int, list[Notice]] = {}
_changed = True


def notices_of_content(scene: bpy.types.Scene) -> list[Notice]:
    """What the last survey found in materials and objects.

    It asks for another survey where something has changed since.
    """
    if _changed or scene.session_uid not in _surveys:
        ask_for_survey()
    return _surveys.get(scene.session_uid, [])


def note_change() -> None:
    """Something in the file has changed."""
    global _changed
    _changed = True
    if _surveys:  # the panel is in use
        ask_for_survey()


def ask_for_survey() -> None:
    """Survey the scenes that are shown, a moment from now."""
    if not bpy.app.timers.is_registered(_survey):
        bpy.app.timers.register(_survey, first_interval=DELAY)


def forget_surveys() -> None:
    """Another file is open."""
    _surveys.clear()
    if bpy.app.timers.is_registered(_survey):
        bpy.app.timers.unregister(_survey)


def _survey() -> None:
    global _changed
    _changed = False
    windows = [window for manager in bpy.data.window_managers for window in manager.windows]
    found = {window.scene.session_uid: survey(window.scene) for window in windows}
    if found != _surveys:
        _surveys.clear()
        _surveys.update(found)
        redraw()


def survey(scene: bpy.types.Scene) -> list[Notice]:
    """List what in `scene` is not simulated.

    Only the types of objects and nodes are read.
    """
    found, materials = [], {}
    for thing in scene.objects:
        if thing.hide_render:
            continue
        kind = unsupported_kind(thing)
        if kind:
            found.append(_unsupported("object", thing.name, kind))
        materials |= {slot.material.name: slot.material for slot in thing.material_slots if slot.material}
    trees = [("material", name, material.node_tree) for name, material in sorted(materials.items())]
    if scene.world is not None:
        trees.append(("world", scene.world.name, scene.world.node_tree))
    for kind, name, tree in trees:
        unknown = sorted(_unknown_nodes(tree)) if tree is not None else []
        if unknown:
            found.append(_unsupported(kind, name, ", ".join(unknown)))
    *_, width, height = rendered_region(scene.render, *full_frame(scene.render))
    lacks = lacking_memory(width, height)
    return [*found, Notice(translate_error(lacks), stops=True)] if lacks else found


def _unsupported(kind: str, name: str, what: str) -> Notice:
    text = translate("'{name}': {what} is not simulated", name=name, what=translate(what))
    return Notice(text, stops=True, kind=kind, name=name)


def _unknown_nodes(tree: bpy.types.NodeTree) -> set[str]:
    """The names of nodes that the output of `tree` depends on and that no reader knows."""
    output = tree.get_output_node("CYCLES")
    if output is None:
        return set()
    return {node.bl_label for node in _upstream(tree, output) if node.bl_idname not in DECLARATIONS}


def _upstream(
    tree: bpy.types.NodeTree, output: bpy.types.Node, seen: frozenset[str] = frozenset()
) -> Iterator[bpy.types.Node]:
    """Yield the nodes that `output` depends on, those in groups included.

    Nodes that only pass values on are left out.
    """
    sources: dict[bpy.types.Node, list[bpy.types.Node]] = {}
    for link in tree.links:
        if link.is_valid and not link.is_muted:
            sources.setdefault(link.to_node, []).append(link.from_node)
    found, ahead = set(), [output]
    while ahead:
        node = ahead.pop()
        if node in found:
            continue
        found.add(node)
        ahead += sources.get(node, [])
        if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None and not node.mute:
            inner = node.node_tree
            ends = [one for one in inner.nodes if one.bl_idname == "NodeGroupOutput" and one.is_active_output]
            if ends and inner.name not in seen:
                yield from _upstream(inner, ends[0], seen | {inner.name})
        elif not node.mute and node.bl_idname not in _PASSED | _OUTPUTS:
            yield node
