# SPDX-License-Identifier: GPL-3.0-or-later
"""Folding: what is the same at every point becomes one constant before rendering starts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, replace
from functools import cache
from typing import NoReturn, TypeGuard

import numpy as np

from ..scene import expressions as ex
from ..scene.materials import Material, WeightedClosure
from ..scene.scene import Scene
from .context import WithoutSurface
from .converters import CONVERTERS
from .evaluate import evaluate
from .images import ImageSet
from .patterns import PATTERNS

_POINTWISE = (
    ex.Mapping,
    ex.Checker,
    ex.Tile,
    ex.Math,
    ex.Mix,
    ex.ColorRamp,
    ex.Gamma,
    ex.ColorToValue,
    ex.VectorToValue,
    ex.ValueToColor,
    *CONVERTERS,
    *PATTERNS,
)
"""Nodes whose result depends on nothing but their inputs."""


class _NoPoint(WithoutSurface):
    """The context of a constant: it has no point."""

    size, flags, tally = 1, 0, None
    cos_wo = np.ones(1)
    backfacing = np.zeros(1, bool)

    def coordinates(self, kind: str, uv_map: str) -> NoReturn:
        raise AssertionError(f"a constant asked for {kind} {uv_map}")


def inputs(expression: ex.Expression) -> dict[str, ex.Expression]:
    """The expressions that feed a node, by field name."""
    named = ((name, getattr(expression, name)) for name in _field_names(type(expression)))
    return {name: value for name, value in named if isinstance(value, ex.Expression)}


@cache
def _field_names(kind: type[ex.Expression]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind))


def walk(expression: ex.Expression) -> Iterator[ex.Expression]:
    """The node and every node that feeds it, each object once."""
    seen: set[int] = set()
    pending = [expression]
    while pending:
        node = pending.pop()
        if id(node) not in seen:
            seen.add(id(node))
            yield node
            pending.extend(inputs(node).values())


def is_constant(expression: ex.Expression) -> TypeGuard[ex.Constant]:
    """Return whether the expression is a constant without folding.

    Fold first to find expressions that come down to a constant.
    """
    return isinstance(expression, ex.Constant)


class Folder:
    """Folds expressions.

    Nodes shared between several expressions stay shared, so that they are still evaluated once.
    """

    def __init__(self) -> None:
        self._done: dict[int, tuple[ex.Expression, ex.Expression]] = {}

    def __call__(self, expression: ex.Expression) -> ex.Expression:
        """Return an expression that equals the given one at every point.

        Constant parts are computed, and neutral nodes are removed.
        """
        if id(expression) not in self._done:
            old = inputs(expression)
            new = {name: self(value) for name, value in old.items()}
            changed = any(new[name] is not old[name] for name in old)
            node = replace(expression, **new) if changed else expression
            self._done[id(expression)] = (expression, _simplify(node))
        return self._done[id(expression)][1]


def fold(expression: ex.Expression) -> ex.Expression:
    """`expression` with constant parts computed and neutral nodes gone."""
    return Folder()(expression)


def fold_scene(scene: Scene) -> Scene:
    """Return `scene` with all sockets of its materials and its world folded.

    Lights, meshes and images stay the same objects.

    Nodes that several sockets of a material share stay shared.
    """
    world = replace(scene.world, radiance=fold(scene.world.radiance))
    return replace(scene, materials=tuple(_folded(material) for material in scene.materials), world=world)


def _folded(material: Material) -> Material:
    fold_shared = Folder()

    def folded(lobe: WeightedClosure) -> WeightedClosure:
        sockets = {k: fold_shared(v) for k, v in vars(lobe.closure).items() if isinstance(v, ex.Expression)}
        return WeightedClosure(replace(lobe.closure, **sockets), fold_shared(lobe.weight))

    return replace(material, lobes=tuple(folded(lobe) for lobe in material.lobes))


def _simplify(node: ex.Expression) -> ex.Expression:
    parts = inputs(node).values()
    if isinstance(node, _POINTWISE) and all(is_constant(part) for part in parts):
        return _constant(evaluate(node, _NoPoint(), ImageSet(())))
    if isinstance(node, ex.Math) and not node.clamp:
        return _simplify_math(node)
    if isinstance(node, ex.Mix) and not node.clamp_result:
        return _simplify_mix(node)
    return node


def _simplify_mix(node: ex.Mix) -> ex.Expression:
    if node.blend == "MIX" and node.factor == ex.ZERO:
        return node.a
    if node.blend == "MIX" and node.factor == ex.ONE:
        return node.b
    if node.blend == "MULTIPLY" and node.factor == ex.ONE and node.b == ex.WHITE:
        return node.a
    return node


def _simplify_math(node: ex.Math) -> ex.Expression:
    for one, other in ((node.a, node.b), (node.b, node.a)):
        if node.operation == "MULTIPLY" and one == ex.ZERO:
            return ex.ZERO
        if node.operation == "MULTIPLY" and one == ex.ONE:
            return other
        if node.operation == "ADD" and one == ex.ZERO:
            return other
    return node


def _constant(value: np.ndarray) -> ex.Constant:
    flat = value.ravel().tolist()
    return ex.Constant(tuple(flat) if value.ndim == 2 else flat[0])
