# SPDX-License-Identifier: GPL-3.0-or-later
"""Which unsupported materials can only send on light that they receive."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .tree import valid_link

# Shader nodes that neither emit nor add up lobes to more than the light they receive.
_PASSIVE = frozenset(
    f"ShaderNode{name}"
    for name in (
        *(
            "BsdfAnisotropic",
            "BsdfDiffuse",
            "BsdfGlass",
            "BsdfGlossy",
            "BsdfHair",
            "BsdfHairPrincipled",
            "BsdfMetallic",
        ),
        *(
            "BsdfPrincipled",
            "BsdfRefraction",
            "BsdfSheen",
            "BsdfToon",
            "BsdfTranslucent",
            "BsdfTransparent",
            "BsdfVelvet",
        ),
        *("Group", "MixShader", "SubsurfaceScattering", "VolumeAbsorption", "VolumeScatter"),
    )
) | {"NodeGroupInput", "NodeReroute"}


def is_passive(material: bpy.types.Material, is_placed: bool = False) -> bool:
    """Whether a material only sends on light that it receives.

    It does so from faces where the mesh has them, or where its displacement moves them if that `is_placed` by the export, too.
    Linked colours are taken to be at most 1. Nodes of unknown kinds may do anything.
    """
    if material.node_tree is None:
        return False
    output = material.node_tree.get_output_node("CYCLES")
    displacement = None if output is None else output.inputs.get("Displacement")
    is_moved = displacement is not None and valid_link(displacement) and material.displacement_method != "BUMP"
    if is_moved and not is_placed:
        return False
    return all(_sends_on(node) for node in _nodes(material.node_tree))


def _nodes(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    """The nodes of a tree and of its groups."""
    for node in tree.nodes:
        yield node
        if getattr(node, "node_tree", None) is not None:
            yield from _nodes(node.node_tree)


def _sends_on(node: bpy.types.Node) -> bool:
    if node.bl_idname == "NodeUndefined" or node.bl_idname == "ShaderNodeScript":
        return False
    if not any(output.type == "SHADER" for output in node.outputs):
        return True
    return node.bl_idname in _PASSIVE and not any(_may_brighten(socket) for socket in node.inputs)


def _may_brighten(socket: bpy.types.NodeSocket) -> bool:
    """Whether an input makes a node emit, or reflect more than it receives."""
    if socket.name == "Emission Strength":
        return valid_link(socket) or socket.default_value != 0.0
    return socket.type == "RGBA" and not socket.name.startswith("Emission") and max(socket.default_value[:3]) > 1.0
