# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of volume shaders: constant coefficients of what fills a closed mesh, or the world (Cycles, kernel/svm/closure.h)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import bpy

from ....lib.scene import expressions as ex
from ....lib.scene import materials as mt
from ....lib.scene.volumes import NOTHING, Color, Volume
from ....lib.textures.fold import is_constant
from .shader_reader import ReadShader, ShaderReader
from .tree import Scope

_REMEDY = "unlink it: only volumes that are the same everywhere are simulated"


@dataclass(frozen=True)
class VolumeClosure(mt.Closure):
    """What one shader adds to a volume."""

    volume: Volume


def read_volume(reader: ShaderReader, socket: bpy.types.NodeSocket, scope: Scope) -> Volume | None:
    """What the shaders that reach `socket` make together; None where none does. What is not constant is refused."""
    source = reader.values.trace(socket, scope)
    if not source.linked:
        return None
    absorption, attributes = NOTHING, []
    for lobe in reader.lobes(socket, scope):
        if isinstance(lobe.closure, mt.Emission):
            reader.values.refuse(source.socket.node, source.scope, ", emission of a volume,", "unlink it")
            continue
        weight = lobe.weight.value if is_constant(lobe.weight) else None
        if weight is None:
            what = ", through which a heterogeneous volume is mixed,"
            reader.values.refuse(source.socket.node, source.scope, what, "use a constant factor")
            continue
        absorption = tuple(a + weight * b for a, b in zip(absorption, lobe.closure.volume.absorption, strict=True))
        attributes += lobe.closure.volume.attributes
    return Volume(absorption, attributes=tuple(sorted(set(attributes))))


def _number(reader: ShaderReader, node: bpy.types.Node, name: str, scope: Scope) -> float:
    """The constant value of a socket; 0 where it is refused."""
    value = reader.read(node, name, scope)
    if is_constant(value):
        return float(value.value)
    reader.values.refuse(node, scope, f", socket '{name}' (a heterogeneous volume),", _REMEDY)
    return 0.0


def _color(reader: ShaderReader, node: bpy.types.Node, name: str, scope: Scope) -> Color:
    """The constant colour of a socket; black where it is refused, as one below 0 or above 1 is."""
    value = reader.read(node, name, scope)
    if not is_constant(value):
        reader.values.refuse(node, scope, f", socket '{name}' (a heterogeneous volume),", _REMEDY)
        return NOTHING
    if min(value.value) < 0.0 or max(value.value) > 1.0:
        reader.values.refuse(node, scope, f", socket '{name}', a colour outside 0 to 1,", "choose another")
        return NOTHING
    return value.value


def _absorption(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    """What the colour lacks of white is absorbed."""
    density = max(_number(reader, node, "Density", scope), 0.0)
    color = _color(reader, node, "Color", scope)
    return [reader.lobe(VolumeClosure(Volume(tuple((1.0 - c) * density for c in color))), weight)]


def _principled(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    """What the colour lacks of white is absorbed, as far as the root of the absorption colour lacks white."""
    density = max(_number(reader, node, "Density", scope), 0.0)
    color, kept = (_color(reader, node, name, scope) for name in ("Color", "Absorption Color"))
    if density * max(color) > 0.0:
        reader.values.refuse(node, scope, ", socket 'Color' (scattering),", "choose black, which only absorbs")
    for name in ("Emission Strength", "Blackbody Intensity"):
        if _number(reader, node, name, scope) > 0.0:
            reader.values.refuse(node, scope, f", socket '{name}' (emission of a volume),", "set it to 0")
    absorption = tuple(density * (1.0 - c) * (1.0 - a**0.5) for c, a in zip(color, kept, strict=True))
    names = [node.inputs[f"{name} Attribute"].default_value for name in ("Density", "Color")] if density else []
    return [reader.lobe(VolumeClosure(Volume(absorption, attributes=tuple(filter(None, names)))), weight)]


VOLUME_SHADERS: Mapping[str, ReadShader] = {
    "ShaderNodeVolumeAbsorption": _absorption,
    "ShaderNodeVolumePrincipled": _principled,
}
"""Node type by Blender's identifier -> reader."""
