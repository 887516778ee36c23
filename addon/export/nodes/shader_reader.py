# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a shader tree: Mix and Add, and what stands below them, become a flat list of weighted lobes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace

import bpy

from ....lib.scene import expressions as ex
from ....lib.scene import materials as mt
from ....lib.textures.fold import Folder
from .tree import Scope, TreeReader, remedy_for_unread, valid_link


@dataclass
class ShaderReader:
    """Reads shader sockets into lobes.

    Values are read by `values` and folded by one `folder`, so that what is shared stays shared. `readers` has the function for each type of
    shader node, by Blender's identifier; a type that is not in it is refused.
    """

    values: TreeReader
    folder: Folder
    readers: Mapping[str, ReadShader]

    def lobes(self, socket: bpy.types.NodeSocket, scope: Scope, weight: ex.Expression = ex.ONE) -> list[mt.Lobe]:
        """The lobes that reach the shader input `socket`, each weighed by `weight`; no weight, no lobes."""
        if weight == ex.ZERO:
            return []
        source = self.values.trace(socket, scope)
        if not source.linked:
            return []
        node = source.socket.node
        if source.socket.type != "SHADER":
            return [self.lobe(_glow(self.values, source), weight)]
        reader = self.readers.get(node.bl_idname)
        if reader is None:
            home = "world" if self.values.is_world else "surface"
            remedy = remedy_for_unread(node, "replace it by a supported shader")
            self.values.refuse(node, source.scope, f" on a {home}", remedy)
            return []
        self.values.check(node, source.scope)
        return reader(self, node, source.scope, weight)

    def lobe(self, closure: mt.Closure, weight: ex.Expression) -> mt.Lobe:
        """`closure`, its sockets folded, with its weight."""
        sockets = {field.name: getattr(closure, field.name) for field in fields(closure)}
        folded = {name: self.folder(v) for name, v in sockets.items() if isinstance(v, ex.Expression)}
        return mt.Lobe(replace(closure, **folded), weight)

    def read(self, node: bpy.types.Node, name: str, scope: Scope) -> ex.Expression:
        """The folded content of the node's socket called `name`."""
        return self.folder(self.values.read(node.inputs[name], scope))

    def normal(self, node: bpy.types.Node, scope: Scope, name: str = "Normal") -> ex.Expression | None:
        """What is linked to the node's normal, else the surface's; None for the shading normal."""
        return self.read(node, name, scope) if valid_link(node.inputs[name]) else self.values.surface_normal

    def tangent(self, node: bpy.types.Node, scope: Scope) -> mt.Tangent:
        """Where the node's socket Tangent points."""
        source = self.values.trace(node.inputs["Tangent"], scope)
        if not source.linked:
            return mt.Tangent()
        tangent = source.socket.node
        if tangent.bl_idname != "ShaderNodeTangent":
            self.values.refuse(node, scope, ", socket 'Tangent' (linked),", "link a Tangent node to it, or nothing")
            return mt.Tangent()
        self.values.check(tangent, source.scope)
        if tangent.direction_type == "RADIAL":
            return mt.Tangent("RADIAL", axis=tangent.axis)
        return mt.Tangent("UV", uv_map=tangent.uv_map)


ReadShader = Callable[[ShaderReader, bpy.types.Node, Scope, ex.Expression], list[mt.Lobe]]
"""Reads one type of shader node into lobes, each weighed by the last argument."""


def _glow(values: TreeReader, source: object) -> mt.Emission:
    """A colour linked to a shader socket shines, as in Cycles."""
    return mt.Emission(values.content(source, "RGBA"), ex.ONE)
