# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement that only bumps (the material's setting Bump Only).

It turns the normal of the whole surface.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ....lib.errors import Refusal
from ....lib.scene import expressions as ex
from ....lib.scene.materials import WeightedClosure
from ....lib.textures.fold import Folder, walk
from .tree import Scope, TreeReader, valid_link


def read_bump(values: TreeReader, socket: bpy.types.NodeSocket, scope: Scope) -> ex.Expression | None:
    """Read the normal that a Displacement node linked to `socket` gives.

    None where something else is linked. Height above the middle, times the scale, is a length along the normal in the
    object's space or in the world's.
    """
    source = values.trace(socket, scope)
    node = source.socket.node
    if not source.linked or node.bl_idname != "ShaderNodeDisplacement" or valid_link(node.inputs["Normal"]):
        return None
    values.check(node, source.scope)
    height, middle, scale = (values.read(node.inputs[name], source.scope) for name in ("Height", "Midlevel", "Scale"))
    raised = ex.Math("MULTIPLY", ex.Math("SUBTRACT", height, middle, ex.ZERO), scale, ex.ZERO)
    if node.space == "OBJECT":
        raised = ex.Math("MULTIPLY", raised, ex.NormalScale(), ex.ZERO)
    return Folder()(ex.Bump(raised, ex.ONE, ex.ONE))


def refuse_beside_bump(owner: str, lobes: list[WeightedClosure]) -> Iterator[Refusal]:
    """What reads the shading normal itself, which a displacement's bump takes the place of."""
    sockets = [v for lobe in lobes for v in (lobe.weight, *vars(lobe.closure).values()) if isinstance(v, ex.Expression)]
    found = {_reads_normal(node) for socket in sockets for node in walk(socket)}
    for what in sorted(found - {""}):
        yield Refusal(owner, f"{what} beside a displacement", "unlink Displacement, or use a Bump node")


def _reads_normal(node: ex.Expression) -> str:
    if isinstance(node, ex.Coordinates) and node.kind in ("NORMAL", "SHADING_NORMAL"):
        return "a normal as coordinates"
    if isinstance(node, ex.NormalMap) and node.space != "TANGENT":
        return "a Normal Map that is not in tangent space"
    if isinstance(node, ex.Bevel):
        return "a Bevel node"
    return ""
