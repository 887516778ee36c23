# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks a node tree as Cycles does.

Links are followed through reroutes, muted nodes and groups, and Blender's silent conversions are written out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import bpy

from ....lib.blender_versions import Versions
from ....lib.errors import Refusal
from ....lib.scene import expressions as ex
from ....lib.textures.fold import fold
from .declarations import DECLARATIONS
from .declared import changed_unknowns, unknown_values
from .images import ImageTable

_COLORS = ("RGBA", "VECTOR")
# Before Blender 5.0 sockets of groups and of muted nodes convert what passes them; since then they convert plain values only, and
# what a node gives is converted by the socket that uses it.
_CONVERTS_ALL = bpy.app.version < (5, 0, 0)
# An input at the end of muted nodes and reroutes that lead nowhere keeps its own value; in 4.5 it is 0, and 5.0 and 5.1 are not measured.
_KEEPS_OWN_VALUE = Versions("5.2")
# Nodes that may feed one another: readers and evaluators call each other that deep, and Python's limit is 1000 calls.
_DEEPEST = 100


@dataclass(frozen=True)
class Scope:
    """Where a node lives: in the tree itself, or inside a group node.

    `group` is that group node, which lives in `parent`; in the tree itself there is no `group`.
    """

    group: bpy.types.Node | None = None
    parent: Scope | None = None

    @property
    def path(self) -> tuple[int, ...]:
        """Identifies the scope: one tree may be in use by many group nodes."""
        if self.group is None or self.parent is None:
            return ()
        return (*self.parent.path, self.group.as_pointer())


@dataclass(frozen=True)
class Source:
    """Where a socket's content comes from.

    It is an output of a real node, or (`linked` False) the default of an input. `passed` are the types of the group and
    muted sockets on the way, outermost first, each of which may convert.
    """

    socket: bpy.types.NodeSocket
    scope: Scope
    linked: bool
    passed: tuple[str, ...]


def valid_link(socket: bpy.types.NodeSocket) -> bpy.types.NodeLink | None:
    """The link into `socket` that counts, if any."""
    for link in socket.links:
        if link.is_valid and not link.is_muted and link.from_socket.enabled and link.to_socket.enabled:
            return link
    return None


@dataclass
class TreeReader:
    """Reads the values of one node tree into expressions.

    A dictionary maps each node type to its reader. What cannot be read is appended to `refusals` by name, and a
    stand-in is returned so that reading goes on to find the rest.
    """

    owner: str
    is_world: bool
    images: ImageTable
    refusals: list[Refusal]
    readers: dict[str, Callable[[TreeReader, bpy.types.Node, str, Scope], ex.Expression]]
    pass_index: int = 0
    """The material's own."""
    surface_normal: ex.Expression | None = None
    """What takes the place of the shading normal, where a displacement bumps it."""
    alpha_expected: dict[tuple, tuple[bpy.types.Node, Scope]] = field(default_factory=dict)
    """Image nodes whose colour was read on the ground that their alpha is in use too."""
    alpha_read: set[tuple] = field(default_factory=set)
    _known: dict[tuple, ex.Expression] = field(default_factory=dict)
    _checked: set[tuple] = field(default_factory=set)
    _depth: int = 0

    def refuse(self, node: bpy.types.Node, scope: Scope, what: str, remedy: str) -> None:
        """Record that `what` of `node` is not simulated."""
        inside = f"group '{scope.group.name}', " if scope.group else ""
        refusal = Refusal(self.owner, f"{inside}node '{node.name}' ({node.bl_label}){what}", remedy)
        if refusal not in self.refusals:
            self.refusals.append(refusal)

    def check(self, node: bpy.types.Node, scope: Scope) -> None:
        """Refuse the undeclared parts of `node` that are not as Blender makes them.

        This is done once per node.
        """
        key = (*scope.path, node.as_pointer())
        if key in self._checked:
            return
        self._checked.add(key)
        declaration = DECLARATIONS[node.bl_idname]
        for socket in node.inputs:
            if not socket.enabled or not hasattr(socket, "default_value"):
                continue
            if socket.identifier in declaration.neutral:
                self._check_neutral(node, socket, declaration.neutral[socket.identifier], scope)
            elif socket.identifier not in declaration.sockets and valid_link(socket):
                self.refuse_linked(node, scope, socket.name)
        for what, remedy in (*changed_unknowns(node, declaration), *unknown_values(node, declaration)):
            self.refuse(node, scope, what, remedy)

    def _check_neutral(self, node: bpy.types.Node, socket: bpy.types.NodeSocket, neutral: float, scope: Scope) -> None:
        """Refuse an input that is not simulated, unless its content is `neutral` everywhere.

        The input may be linked.
        """
        if valid_link(socket):
            changed = socket.type != "VALUE" or fold(self.read(socket, scope)) != ex.Constant(neutral)
        else:
            changed = socket.default_value != neutral
        if changed:
            remedy = "switch it off" if socket.type == "BOOLEAN" else f"set it to {neutral:g}"
            self.refuse(node, scope, f", socket '{socket.name}',", remedy)

    def trace(self, socket: bpy.types.NodeSocket, scope: Scope) -> Source:
        """Follow links from the input `socket` to where its content comes from.

        An input at the end of muted nodes and reroutes that pass nothing on keeps its own value, as in Cycles.
        """
        passed: list[str] = []
        own = Source(socket, scope, False, ())
        while True:
            link = valid_link(socket)
            if link is None:
                return Source(socket, scope, False, tuple(passed))
            output, node = link.from_socket, link.from_node
            if node.mute or node.bl_idname == "NodeReroute":
                passed.append(output.type)
                inner = next((i.from_socket for i in node.internal_links if i.to_socket == output), None)
                if inner is None or valid_link(inner) is None:
                    ends_at_once = inner is None and socket == own.socket
                    if not ends_at_once and bpy.app.version not in _KEEPS_OWN_VALUE:
                        self.refuse(node, scope, ", which passes nothing on,", "delete it")
                    return own
                socket = inner
            elif node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None:
                passed.append(output.type)
                socket = _group_result(node.node_tree, output.identifier)
                scope = Scope(node, scope)
                if socket is None:
                    self.refuse(
                        node, scope, f", output '{output.name}', to which the group leads nothing,", "unlink it"
                    )
                    return Source(link.to_socket, scope, False, tuple(passed))
                own = Source(socket, scope, False, tuple(passed))
            elif node.bl_idname == "NodeGroupInput" and scope.group is not None and scope.parent is not None:
                passed.append(output.type)
                socket = next(s for s in scope.group.inputs if s.identifier == output.identifier)
                scope = scope.parent
                own = Source(socket, scope, False, tuple(passed))
            else:
                return Source(output, scope, True, tuple(passed))

    def read(self, socket: bpy.types.NodeSocket, scope: Scope) -> ex.Expression:
        """The content of the input `socket`: a value or a colour, as the socket's type says."""
        return self.content(self.trace(socket, scope), socket.type)

    def content(self, source: Source, kind: str) -> ex.Expression:
        """The content of a traced `source`, converted to a socket of type `kind`."""
        at = source.socket.type
        expression = self._output(source) if source.linked else self._default(source)
        passed = source.passed if _CONVERTS_ALL or not source.linked else ()
        for step in (*reversed(passed), kind):
            expression, at = self._convert(expression, at, step, source), step
        return expression

    def read_or(self, socket: bpy.types.NodeSocket, scope: Scope, default: ex.Expression) -> ex.Expression:
        """The content of `socket`, or `default` where nothing is linked (texture coordinates)."""
        return self.read(socket, scope) if valid_link(socket) else default

    def refuse_linked(self, node: bpy.types.Node, scope: Scope, *names: str) -> None:
        """Refuse each of the sockets called `names` that is linked."""
        for name in names:
            socket = node.inputs.get(name)
            if socket is not None and valid_link(socket):
                self.refuse(node, scope, f", socket '{name}' (linked),", f"unlink {name}")

    def _output(self, source: Source) -> ex.Expression:
        node, socket = source.socket.node, source.socket
        key = (*source.scope.path, node.as_pointer(), socket.identifier)
        if key not in self._known:
            reader = self.readers.get(node.bl_idname)
            if reader is None:
                self.refuse(
                    node,
                    source.scope,
                    "",
                    remedy_for_unread(node, "replace it by a supported node or bake it to an image"),
                )
                return _stand_in(socket.type)
            if self._depth == _DEEPEST:
                what = f", behind a chain of {_DEEPEST} nodes,"
                self.refuse(node, source.scope, what, "shorten the chain, or bake it to an image")
                return _stand_in(socket.type)
            self.check(node, source.scope)
            self._depth += 1
            self._known[key] = reader(self, node, socket.identifier, source.scope)
            self._depth -= 1
        return self._known[key]

    def _default(self, source: Source) -> ex.Expression:
        socket = source.socket
        if socket.type == "VALUE":
            return ex.Constant(float(socket.default_value))
        if socket.type in _COLORS:
            x, y, z = list(socket.default_value)[:3]
            return ex.Constant((float(x), float(y), float(z)))
        self.refuse(
            socket.node, source.scope, f", socket '{socket.name}' of type {socket.type.lower()},", "do without it"
        )
        return ex.ZERO

    def _convert(self, expression: ex.Expression, have: str, want: str, source: Source) -> ex.Expression:
        """Blender's silent conversion between socket types."""
        if have == want or (have in _COLORS and want in _COLORS):
            return expression
        if have == "VALUE" and want in _COLORS:
            return ex.ValueToColor(expression)
        if have == "RGBA" and want == "VALUE":
            return ex.ColorToValue(expression)
        if have == "VECTOR" and want == "VALUE":
            return ex.VectorToValue(expression)
        what = f", socket '{source.socket.name}', whose {have.lower()} feeds a {want.lower()},"
        self.refuse(source.socket.node, source.scope, what, "unlink it")
        return _stand_in(want)


def remedy_for_unread(node: bpy.types.Node, remedy: str) -> str:
    """The remedy for a node that has no reader.

    A type that this Blender lacks comes from another release.
    """
    if node.bl_idname != "NodeUndefined":
        return remedy
    return f"this Blender ({bpy.app.version_string}) lacks its type; use the version that made it, or delete it"


def _stand_in(kind: str) -> ex.Expression:
    return ex.BLACK if kind in _COLORS else ex.ZERO


def _group_result(tree: bpy.types.NodeTree, identifier: str) -> bpy.types.NodeSocket | None:
    """The input of the group's output node that carries the output `identifier`.

    The active output node of the group counts.
    """
    for node in tree.nodes:
        if node.bl_idname == "NodeGroupOutput" and node.is_active_output:
            return next((s for s in node.inputs if s.identifier == identifier), None)
    return None
