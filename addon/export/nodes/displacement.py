# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement: a bump of the whole surface, or a move of the vertices.

The material's setting is Bump Only, Displacement Only, or Displacement and Bump.
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ....lib.errors import Refusal
from ....lib.scene import expressions as ex
from ....lib.scene.converters import VectorMath
from ....lib.scene.materials import Displacement, WeightedClosure
from ....lib.textures.fold import Folder, walk
from .tree import Scope, Source, TreeReader, valid_link

# What has no value at a vertex, or not the same one in Cycles: there is no ray, no pixel and no face there.
_NOT_AT_VERTICES = {
    ex.NormalMap: "a Normal Map node",
    ex.Bump: "a Bump node",
    ex.Bevel: "a Bevel node",
    ex.AmbientOcclusion: "an Ambient Occlusion node",
    ex.Wireframe: "a Wireframe node",
    ex.RayFlag: "a Light Path node",
    ex.RayCount: "a Light Path node",
    ex.FresnelFactor: "a Fresnel node",
    ex.LayerWeight: "a Layer Weight node",
    ex.Tile: "a tiled image",
}
# Cycles takes their slopes along other directions than those of the height (docs/findings/displacement_and_bump.md).
_MISJUDGED = ("OBJECT", "POSITION", "NORMAL", "SHADING_NORMAL", "TRUE_NORMAL")


def read_bump(values: TreeReader, socket: bpy.types.NodeSocket, scope: Scope) -> ex.Expression | None:
    """Read the normal that a Displacement node linked to `socket` gives.

    None where something else is linked. Height above the middle, times the scale, is a length along the normal in the
    object's space or in the world's.
    """
    source = values.trace(socket, scope)
    if not _is_along_normal(source):
        return None
    raised = _read_length(values, source)
    if source.socket.node.space == "OBJECT":
        raised = ex.Math("MULTIPLY", raised, ex.NormalScale(), ex.ZERO)
    return Folder()(ex.Bump(raised, ex.ONE, ex.ONE))


def read_displacement(
    values: TreeReader, socket: bpy.types.NodeSocket, scope: Scope, bumps: bool
) -> Displacement | None:
    """Read how a Displacement or Vector Displacement node moves vertices.

    It is linked to `socket`, and only moves, or `bumps`, too. None where something else is linked, or something is refused.
    """
    source, refused = values.trace(socket, scope), len(values.refusals)
    node = source.socket.node
    if _is_along_normal(source):
        found = Displacement(Folder()(_read_length(values, source)), node.space, bumps=bumps)
    elif source.linked and node.bl_idname == "ShaderNodeVectorDisplacement":
        if bumps:
            values.refuse(node, source.scope, " with Displacement and Bump", "choose Displacement Only")
        found = Displacement(Folder()(_read_vector(values, source)), node.space, is_vector=True)
    else:
        return None
    for what in sorted({_has_no_value(part) for part in walk(found.offset)} - {""}):
        values.refusals.append(Refusal(values.owner, f"{what} in a displacement", "bake it to an image, or unlink it"))
    if bumps and any(isinstance(part, ex.Coordinates) and part.kind in _MISJUDGED for part in walk(found.offset)):
        what = "Displacement and Bump by coordinates other than UV and Generated"
        values.refusals.append(Refusal(values.owner, what, "use these, or choose Displacement Only"))
    return found if len(values.refusals) == refused else None


def _is_along_normal(source: Source) -> bool:
    """Whether a Displacement node along the surface's own normal is linked."""
    node = source.socket.node
    return source.linked and node.bl_idname == "ShaderNodeDisplacement" and not valid_link(node.inputs["Normal"])


def _read_length(values: TreeReader, source: Source) -> ex.Expression:
    """Read the length along the normal that a Displacement node gives, in its own space."""
    node = source.socket.node
    values.check(node, source.scope)
    height, middle, scale = (values.read(node.inputs[name], source.scope) for name in ("Height", "Midlevel", "Scale"))
    return ex.Math("MULTIPLY", ex.Math("SUBTRACT", height, middle, ex.ZERO), scale, ex.ZERO)


def _read_vector(values: TreeReader, source: Source) -> ex.Expression:
    """Read the vector that a Vector Displacement node gives, in its own space."""
    node = source.socket.node
    values.check(node, source.scope)
    vector, middle, scale = (values.read(node.inputs[name], source.scope) for name in ("Vector", "Midlevel", "Scale"))
    above = VectorMath("SUBTRACT", vector, ex.ValueToColor(middle), ex.BLACK, ex.ONE)
    return VectorMath("SCALE", above, ex.BLACK, ex.BLACK, scale)


def _has_no_value(part: ex.Expression) -> str:
    if isinstance(part, ex.Coordinates) and part.kind == "INCOMING":
        return "Incoming of a Geometry node"
    return _NOT_AT_VERTICES.get(type(part), "")


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
