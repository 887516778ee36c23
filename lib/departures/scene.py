# SPDX-License-Identifier: GPL-3.0-or-later
"""Departures that are a change of the scene.

The integrator is the same. It is given what Cycles reads in place of what the user set.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence, Set
from dataclasses import replace
from functools import partial

import numpy as np

from ..microfacets.cycles_tables import Tables, cycles_tables
from ..scene.converters import Curve, Curves
from ..scene.expressions import ColorRamp, Expression
from ..scene.layers import BeneathLayer
from ..scene.lights import AreaLight, Light
from ..scene.materials import Material
from ..scene.scene import Scene
from ..textures.curves import curve_of_channel
from ..textures.fold import inputs
from ..textures.ramp import color_ramp

_CELLS = 256
# Spreads (radians) up to which Cycles takes the first term of the series; it compares in single precision.
NARROW = float(np.float32(0.1))


def departed(scene: Scene, departures: Set[str]) -> Scene:
    """Return `scene` after the named departures.

    Names that change no scene are passed over.

    Where Blender's releases depart in several forms, that of `scene.blender` is taken; of the newest one without it.
    """
    changes = [change for name, change in _NODES.items() if name in departures]
    if "layer albedo table" in departures:
        changes.append(partial(tabulated_layer, tables=cycles_tables(scene.blender)))
    if changes:
        changed = _Rewriter(changes)
        materials = tuple(_with_sockets(material, changed) for material in scene.materials)
        scene = replace(scene, materials=materials, world=replace(scene.world, radiance=changed(scene.world.radiance)))
    if "narrow spread" in departures:
        scene = replace(scene, lights=tuple(_narrowed(light) for light in scene.lights))
    return scene


def tabulated_ramp(ramp: ColorRamp) -> ColorRamp:
    """Return `ramp` as Cycles tabulates it, at 257 evenly spaced factors.

    It is linear between the factors, and constant where `ramp` is.
    """
    node = np.linspace(0.0, 1.0, _CELLS + 1)
    color = color_ramp(replace(ramp, output="COLOR"), node)
    alpha = color_ramp(replace(ramp, output="ALPHA"), node)
    constant = ramp.mode == "RGB" and ramp.interpolation == "CONSTANT"
    return replace(
        ramp,
        positions=tuple(node.tolist()),
        colors=tuple(map(tuple, np.vstack([color, alpha]).T.tolist())),
        interpolation="CONSTANT" if constant else "LINEAR",
        mode="RGB",
    )


def tabulated_curves(node: Curves) -> Curves:
    """Return the curves as one table of 257 entries a channel.

    Beyond its ends it goes on from the last two entries, or stays constant.
    """
    ends = [end for one in (*node.channels, node.combined) if one is not None for end in (one.low, one.high)]
    low, high = min(ends), max(ends)
    x = np.linspace(low, high, _CELLS + 1)
    cell = (high - low) / _CELLS

    def tabulated(channel: int) -> Curve:
        table = curve_of_channel(node, channel, x)
        first, last = (np.diff(table)[[0, -1]] / cell * node.extends).tolist()
        table = tuple(table.tolist())
        return Curve(low, high, table, (table[0], first), (table[-1], last))

    return replace(node, channels=tuple(map(tabulated, range(len(node.channels)))), combined=None)


def tabulated_layer(node: Expression, tables: Tables) -> Expression:
    """A layer with its albedo from Cycles' tables; other nodes as they are."""
    return replace(node, tables=tables.nodes) if isinstance(node, BeneathLayer) else node


def lossless_coat(node: Expression) -> Expression:
    """Return a coat without loss; other nodes stay as they are.

    The coat takes from the layer below what its facets hand to each other.
    """
    return replace(node, lossless=True) if isinstance(node, BeneathLayer) and node.coat else node


_NODES: dict[str, Callable[[Expression], Expression]] = {
    "colour-ramp table": lambda node: tabulated_ramp(node) if isinstance(node, ColorRamp) else node,
    "curve table": lambda node: tabulated_curves(node) if isinstance(node, Curves) else node,
    "lossless coat albedo": lossless_coat,
    "thin film series": lambda node: replace(node, film_by_table=True) if isinstance(node, BeneathLayer) else node,
}


def narrow_factor(spread: float) -> float:
    """Return the factor by which Cycles' normalisation multiplies the radiance.

    It is (3 / h^3) (tan h - h), h = `spread` / 2 in (0, 0.05].
    """
    h = 0.5 * spread
    return 3.0 * (math.tan(h) - h) / h**3 if h > 1e-3 else 1.0 + 0.4 * h * h


def _narrowed(light: Light) -> Light:
    if not isinstance(light, AreaLight) or not 0.0 < light.spread <= NARROW:
        return light
    factor = narrow_factor(light.spread)
    return replace(light, radiance=tuple(c * factor for c in light.radiance))


def _with_sockets(material: Material, changed: Callable[[Expression], Expression]) -> Material:
    lobes = []
    for lobe in material.lobes:
        sockets = {k: changed(v) for k, v in vars(lobe.closure).items() if isinstance(v, Expression)}
        lobes.append(replace(lobe, closure=replace(lobe.closure, **sockets), weight=changed(lobe.weight)))
    return replace(material, lobes=tuple(lobes))


class _Rewriter:
    """Applies `changes` to every node of an expression, inputs first.

    Nodes that several expressions share stay shared.
    """

    def __init__(self, changes: Sequence[Callable[[Expression], Expression]]) -> None:
        self._changes = changes
        self._done: dict[int, tuple[Expression, Expression]] = {}

    def __call__(self, expression: Expression) -> Expression:
        """The expression after the change."""
        if id(expression) not in self._done:
            old = inputs(expression)
            new = {name: self(value) for name, value in old.items()}
            same = all(new[name] is old[name] for name in old)
            node = expression if same else replace(expression, **new)
            for change in self._changes:
                node = change(node)
            self._done[id(expression)] = expression, node
        return self._done[id(expression)][1]
