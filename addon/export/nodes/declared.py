# SPDX-License-Identifier: GPL-3.0-or-later
"""The check that no input and no property of a node is ignored.

What its reader does not declare must be as Blender makes it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import Any

import bpy

from ....lib.blender_versions import NEWEST_CHECKED, Versions, format_release

EVERY_RELEASE = Versions()
_NEVER_SHOWN = ("Weight",)  # of every shader; Blender itself sets it


@dataclass(frozen=True)
class Declaration:
    """The parts of a node type that its reader knows.

    `reads`: identifiers of the inputs that it reads or refuses itself. `neutral`: inputs that are not simulated, and the only
    content that is accepted (None: unlinked). `idle`: inputs that cannot change the image, because a neutral one switches
    them off or because Cycles ignores them. `properties`: those that it reads or refuses itself, with the enum values that it
    knows (None: no enum). `unused`: properties that Cycles ignores. `versions`: the releases that have the node type.
    """

    reads: tuple[str, ...] = ()
    neutral: Mapping[str, float | None] = field(default_factory=dict)
    idle: tuple[str, ...] = ()
    properties: Mapping[str, tuple[str, ...] | None] = field(default_factory=dict)
    unused: tuple[str, ...] = ()
    versions: Versions = EVERY_RELEASE

    @cached_property
    def sockets(self) -> frozenset[str]:
        """Identifiers of all inputs that are known."""
        return frozenset((*self.reads, *self.neutral, *self.idle, *_NEVER_SHOWN))


@dataclass(frozen=True)
class _Fresh:
    """Contents of a freshly made node: of its inputs by identifier and of its own properties."""

    inputs: dict[str, Any]
    properties: dict[str, Any]


_fresh: dict[str, _Fresh] = {}


@cache
def own_properties(kind: str) -> tuple[str, ...]:
    """The properties of the node class `kind` that not every shader node has."""
    common = bpy.types.ShaderNode.bl_rna.properties
    return tuple(p.identifier for p in getattr(bpy.types, kind).bl_rna.properties if p.identifier not in common)


def unknown_properties(kind: str, declaration: Declaration) -> tuple[str, ...]:
    """The properties of the node class `kind` that its declaration does not name."""
    return tuple(n for n in own_properties(kind) if n not in declaration.properties and n not in declaration.unused)


def remember_defaults(declarations: Mapping[str, Declaration]) -> None:
    """Learn what a fresh node holds, for each type in the file that has something undeclared.

    Makes and removes one node group, where there is such a type at all: none in a Blender that was checked. Call it
    before a render: while one runs, Blender cannot add data.
    """
    unknown = {
        node.bl_idname
        for tree in _trees()
        for node in tree.nodes
        if node.bl_idname in declarations and node.bl_idname not in _fresh and has_unknown(node, declarations)
    }
    if not unknown:
        return
    tree = bpy.data.node_groups.new(".etalon", "ShaderNodeTree")
    try:
        for kind in unknown:
            node = tree.nodes.new(kind)
            _fresh[kind] = _Fresh(
                {socket.identifier: _content(socket, "default_value") for socket in node.inputs},
                {name: _content(node, name) for name in unknown_properties(kind, declarations[kind])},
            )
    finally:
        bpy.data.node_groups.remove(tree)


def has_unknown(node: bpy.types.Node, declarations: Mapping[str, Declaration]) -> bool:
    """Whether the node has an input or a property that its declaration does not name."""
    declaration = declarations[node.bl_idname]
    return bool(unknown_properties(node.bl_idname, declaration)) or any(
        socket.identifier not in declaration.sockets for socket in node.inputs
    )


def changed_unknowns(node: bpy.types.Node, declaration: Declaration) -> Iterator[tuple[str, str]]:
    """Yield unknown inputs and properties that are not as Blender makes them.

    Each is (what, remedy). Inputs that are linked are not among them.
    """
    fresh = _fresh.get(node.bl_idname, _Fresh({}, {}))
    for socket in node.inputs:
        name = socket.identifier
        if socket.enabled and name not in declaration.sockets and hasattr(socket, "default_value"):
            yield from _changed(f", socket '{socket.name}',", _content(socket, "default_value"), fresh.inputs.get(name))
    for name in unknown_properties(node.bl_idname, declaration):
        yield from _changed(f", property '{name}',", _content(node, name), fresh.properties.get(name))


def unknown_values(node: bpy.types.Node, declaration: Declaration) -> Iterator[tuple[str, str]]:
    """Enum properties whose value the reader does not know, and the remedy."""
    for name, known in declaration.properties.items():
        value = getattr(node, name, None) if known is not None else None
        if value is not None and value not in known:
            newer = bpy.app.version[:2] > NEWEST_CHECKED
            hint = f", or use Blender {format_release(NEWEST_CHECKED)}" if newer else ""
            label = node.bl_rna.properties[name].name
            yield f", {label} {value.replace('_', ' ').title()},", f"choose another {label}{hint}"


def _changed(what: str, value: Any, default: Any) -> Iterator[tuple[str, str]]:
    if value != default:
        yield what, "set it back to its default" if default is None else f"set it back to {default}"


def _content(owner: Any, name: str) -> Any:
    """A property's value, comparable: arrays as tuples, data by its name."""
    value = getattr(owner, name, None)
    if isinstance(value, bpy.types.ID):
        return value.name_full
    if isinstance(value, bpy.types.bpy_struct):
        return type(value).__name__
    return value if value is None or isinstance(value, str | int | float) else tuple(value)


def _trees() -> Iterator[bpy.types.NodeTree]:
    data = bpy.data
    owners = (*data.materials, *data.worlds, *data.lights)
    yield from (owner.node_tree for owner in owners if owner.node_tree is not None)
    yield from (tree for tree in data.node_groups if tree.bl_idname == "ShaderNodeTree")
