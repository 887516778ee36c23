# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading a shader tree into a flat list of weighted lobes.

Mix and Add nodes, and the shaders below them, are resolved.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace

import bpy

from ....lib.blender_versions import Versions
from ....lib.microfacets.thin_film import LEAST_THICKNESS
from ....lib.scene import expressions as ex
from ....lib.scene import materials as mt
from ....lib.textures.fold import Folder, is_constant
from .tree import Scope, Source, TreeReader, remedy_for_unread, valid_link

# Before, films lie on dielectrics alone, and their colours come from another fit.
_FILMS = Versions("5.0")
Key = tuple
"""Identifies an output of a node in its scope."""


@dataclass(frozen=True)
class _Shader:
    """A shader node's output, and the shaders that it combines.

    `parts` are the keys of these, each with its factor; None for a node that is a shader itself.
    """

    source: Source
    parts: tuple[tuple[Key, ex.Expression], ...] | None


@dataclass
class ShaderReader:
    """Reads shader sockets into lobes.

    Values are read by `values` and folded by one `folder`, so that what is shared stays shared. `readers` has the function for each type of
    shader node, by Blender's identifier, and `combiners` those that pass others on; a type that is in neither is refused; `home` says where.
    """

    values: TreeReader
    folder: Folder
    readers: Mapping[str, ReadShader]
    combiners: Mapping[str, ReadParts]
    home: str

    def lobes(self, socket: bpy.types.NodeSocket, scope: Scope) -> list[mt.WeightedClosure]:
        """The lobes that reach the shader input `socket`.

        A shader that is in use several times is read once, with the sum of its weights, as in Cycles: the time is linear in the number
        of nodes.
        """
        root = self.values.trace(socket, scope)
        if not root.linked:
            return []
        shaders, finished = self._collect(root)
        weights: dict[Key, ex.Expression] = dict.fromkeys(shaders, ex.ZERO)
        weights[_key(root)] = ex.ONE
        for key in reversed(finished):  # a shader comes before all that it takes from
            for part, factor in shaders[key].parts or ():
                share = self.folder(ex.Math("MULTIPLY", weights[key], factor, ex.ZERO))
                weights[part] = self.folder(ex.Math("ADD", weights[part], share, ex.ZERO))
        own = ((shader.source, weights[key]) for key, shader in shaders.items() if shader.parts is None)
        return [lobe for source, weight in own for lobe in self._own_lobes(source, weight)]

    def _collect(self, root: Source) -> tuple[dict[Key, _Shader], list[Key]]:
        """Collect all shaders that `root` is made of, in the order in which they are met.

        Also returns their keys, each after all shaders that it takes from.
        """
        shaders: dict[Key, _Shader] = {}
        finished: list[Key] = []
        pending: list[tuple[Source, bool]] = [(root, False)]
        while pending:
            source, done = pending.pop()
            key = _key(source)
            if done:
                finished.append(key)
            elif key not in shaders:
                sources, factors = self._parts(source)
                parts = None if sources is None else tuple(zip(map(_key, sources), factors, strict=True))
                shaders[key] = _Shader(source, parts)
                pending.append((source, True))
                pending.extend((part, False) for part in reversed(sources or ()))
        return shaders, finished

    def _parts(self, source: Source) -> tuple[list[Source] | None, list[ex.Expression]]:
        """The shaders that a Mix or Add node combines, and their factors.

        A shader whose factor is zero is left out. None for a node that is a shader itself.
        """
        combine = self.combiners.get(source.socket.node.bl_idname)
        if combine is None:
            return None, []
        self.values.check(source.socket.node, source.scope)
        sources, factors = [], []
        for socket, factor in combine(self, source.socket.node, source.scope):
            part = self.values.trace(socket, source.scope) if factor != ex.ZERO else None
            if part is not None and part.linked:
                sources.append(part)
                factors.append(factor)
        return sources, factors

    def _own_lobes(self, source: Source, weight: ex.Expression) -> list[mt.WeightedClosure]:
        """The lobes of one shader, each weighed by `weight`."""
        node = source.socket.node
        if source.socket.type != "SHADER":
            return [self.lobe(_glow(self.values, source), weight)]
        reader = self.readers.get(node.bl_idname)
        if reader is None:
            remedy = remedy_for_unread(node, "replace it by a supported shader")
            self.values.refuse(node, source.scope, f" {self.home}", remedy)
            return []
        self.values.check(node, source.scope)
        return reader(self, node, source.scope, weight)

    def lobe(self, closure: mt.Closure, weight: ex.Expression) -> mt.WeightedClosure:
        """`closure`, its sockets folded, with its weight."""
        sockets = {field.name: getattr(closure, field.name) for field in fields(closure)}
        folded = {name: self.folder(v) for name, v in sockets.items() if isinstance(v, ex.Expression)}
        return mt.WeightedClosure(replace(closure, **folded), weight)

    def read(self, node: bpy.types.Node, name: str, scope: Scope) -> ex.Expression:
        """The folded content of the node's socket called `name`."""
        return self.folder(self.values.read(node.inputs[name], scope))

    def normal(self, node: bpy.types.Node, scope: Scope, name: str = "Normal") -> ex.Expression | None:
        """What is linked to the node's normal, else the surface's; None for the shading normal."""
        return self.read(node, name, scope) if valid_link(node.inputs[name]) else self.values.surface_normal

    def film(self, node: bpy.types.Node, scope: Scope) -> dict[str, ex.Expression]:
        """Thickness and index of the node's thin film, by the fields of a closure.

        Empty where there is no film.
        """
        if "Thin Film Thickness" not in node.inputs:
            return {}
        thickness = self.read(node, "Thin Film Thickness", scope)
        if is_constant(thickness) and thickness.value <= LEAST_THICKNESS:
            return {}
        if bpy.app.version[:2] not in _FILMS:
            what = f", socket 'Thin Film Thickness' in Blender before {_FILMS.first},"
            self.values.refuse(node, scope, what, "set it to 0, or use a newer Blender")
            return {}
        return {"film_thickness": thickness, "film_ior": self.read(node, "Thin Film IOR", scope)}

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


ReadShader = Callable[[ShaderReader, bpy.types.Node, Scope, ex.Expression], list[mt.WeightedClosure]]
"""Reads one type of shader node into lobes, each weighed by the last argument."""


ReadParts = Callable[[ShaderReader, bpy.types.Node, Scope], list[tuple[bpy.types.NodeSocket, ex.Expression]]]
"""The shader inputs of a node that passes others on, each with its folded factor."""


def _key(source: Source) -> Key:
    return (*source.scope.path, source.socket.node.as_pointer(), source.socket.identifier)


def _glow(values: TreeReader, source: Source) -> mt.Emission:
    """A colour linked to a shader socket shines, as in Cycles."""
    return mt.Emission(values.content(source, "RGBA"), ex.ONE)
