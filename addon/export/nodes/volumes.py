# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of volume shaders: constant coefficients of a medium.

The medium fills a closed mesh or the world (Cycles, kernel/svm/closure.h).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import bpy

from ....lib.scene import expressions as ex
from ....lib.scene import materials as mt
from ....lib.scene.volumes import MOST_ANISOTROPY, NOTHING, Color, Phase, Volume
from ....lib.textures.fold import is_constant
from .shader_reader import ReadShader, ShaderReader
from .tree import Scope

_PHASE = "HENYEY_GREENSTEIN"
_REMEDY = "unlink it: only volumes that are the same everywhere are simulated"


@dataclass(frozen=True)
class VolumeClosure(mt.Closure):
    """What one shader adds to a volume."""

    volume: Volume


def read_volume(reader: ShaderReader, socket: bpy.types.NodeSocket, scope: Scope) -> Volume | None:
    """Read the volume that the shaders that reach `socket` make together.

    None where there are none. What is not constant is refused.
    """
    source = reader.values.trace(socket, scope)
    if not source.linked:
        return None
    total = Volume()
    for lobe in reader.lobes(socket, scope):
        closure = lobe.closure
        if isinstance(closure, mt.Emission):  # a colour linked to the socket of a shader
            closure = VolumeClosure(Volume(emission=closure.color.value)) if is_constant(closure.color) else None
        if closure is None or not is_constant(lobe.weight):
            what = ", through which a heterogeneous volume is mixed,"
            reader.values.refuse(source.socket.node, source.scope, what, "use constant colours and factors")
            continue
        total = _sum(total, _scaled(closure.volume, float(lobe.weight.value)))
    return total


def _scaled(volume: Volume, factor: float) -> Volume:
    phases = [replace(phase, scattering=_times(phase.scattering, factor)) for phase in volume.phases]
    return replace(
        volume,
        absorption=_times(volume.absorption, factor),
        phases=tuple(phases),
        emission=_times(volume.emission, factor),
    )


def _times(color: Color, factor: float) -> Color:
    return tuple(c * factor for c in color)


def _sum(a: Volume, b: Volume) -> Volume:
    absorption, emission = (
        tuple(map(sum, zip(getattr(a, name), getattr(b, name), strict=True))) for name in ("absorption", "emission")
    )
    phases = tuple(phase for phase in (*a.phases, *b.phases) if any(phase.scattering))
    return Volume(absorption, phases, emission, tuple(sorted({*a.attributes, *b.attributes})))


def _number(reader: ShaderReader, node: bpy.types.Node, name: str, scope: Scope) -> float:
    """The constant value of a socket; 0 where it is refused."""
    value = reader.read(node, name, scope)
    if is_constant(value):
        return float(value.value)
    reader.values.refuse(node, scope, f", socket '{name}' (a heterogeneous volume),", _REMEDY)
    return 0.0


def _density(reader: ShaderReader, node: bpy.types.Node, scope: Scope, name: str = "Density") -> float:
    """The constant value of a socket, at least 0, as in Cycles."""
    return max(_number(reader, node, name, scope), 0.0)


def _color(reader: ShaderReader, node: bpy.types.Node, name: str, scope: Scope, most: float = math.inf) -> Color:
    """The constant colour of a socket.

    Black where it is refused, as a colour below 0 or above `most` is.
    """
    value = reader.read(node, name, scope)
    if not is_constant(value):
        reader.values.refuse(node, scope, f", socket '{name}' (a heterogeneous volume),", _REMEDY)
        return NOTHING
    if min(value.value) < 0.0 or max(value.value) > most:
        bounds = "below 0" if math.isinf(most) else f"outside 0 to {most:g}"
        reader.values.refuse(node, scope, f", socket '{name}', a colour {bounds},", "choose another")
        return NOTHING
    return value.value


def _phases(reader: ShaderReader, node: bpy.types.Node, scope: Scope, scattering: Color) -> tuple[Phase, ...]:
    if getattr(node, "phase", _PHASE) != _PHASE:
        what = f", phase function {node.phase.replace('_', ' ').title()},"
        reader.values.refuse(node, scope, what, "choose Henyey-Greenstein")
        return ()
    g = _number(reader, node, "Anisotropy", scope)
    return (Phase(scattering, max(-MOST_ANISOTROPY, min(MOST_ANISOTROPY, g))),)


def _absorption(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    """What the colour lacks of white is absorbed."""
    density, color = _density(reader, node, scope), _color(reader, node, "Color", scope, most=1.0)
    return [reader.lobe(VolumeClosure(Volume(tuple((1.0 - c) * density for c in color))), weight)]


def _scatter(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    """The colour is scattered; nothing is absorbed."""
    scattering = _times(_color(reader, node, "Color", scope), _density(reader, node, scope))
    return [reader.lobe(VolumeClosure(Volume(phases=_phases(reader, node, scope, scattering))), weight)]


def _coefficients(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    """As they are."""
    absorption, scattering, emission = (
        _color(reader, node, f"{name} Coefficients", scope) for name in ("Absorption", "Scatter", "Emission")
    )
    volume = Volume(absorption, _phases(reader, node, scope, scattering), emission)
    return [reader.lobe(VolumeClosure(volume), weight)]


def _emission(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    """Radiance for each metre."""
    strength = _number(reader, node, "Strength", scope)
    if strength < 0.0:
        reader.values.refuse(node, scope, ", socket 'Strength', below 0 in a volume,", "choose another")
    emission = _times(_color(reader, node, "Color", scope), max(strength, 0.0))
    return [reader.lobe(VolumeClosure(Volume(emission=emission)), weight)]


def _principled(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    """The media of a Principled Volume.

    The colour is scattered. What it lacks of white is absorbed, as far as the root of the absorption colour lacks
    white.
    """
    density = _density(reader, node, scope)
    color, kept, glow = (_color(reader, node, f"{name}Color", scope) for name in ("", "Absorption ", "Emission "))
    if _number(reader, node, "Blackbody Intensity", scope) > 0.0:
        reader.values.refuse(node, scope, ", socket 'Blackbody Intensity',", "set it to 0")
    absorption = tuple(density * max(1.0 - c, 0.0) * max(1.0 - a**0.5, 0.0) for c, a in zip(color, kept, strict=True))
    phases = _phases(reader, node, scope, _times(color, density))
    emission = _times(glow, _density(reader, node, scope, "Emission Strength"))
    names = [node.inputs[f"{name} Attribute"].default_value for name in ("Density", "Color")] if density else []
    volume = Volume(absorption, phases, emission, tuple(filter(None, names)))
    return [reader.lobe(VolumeClosure(volume), weight)]


VOLUME_SHADERS: Mapping[str, ReadShader] = {
    "ShaderNodeEmission": _emission,
    "ShaderNodeVolumeAbsorption": _absorption,
    "ShaderNodeVolumeCoefficients": _coefficients,
    "ShaderNodeVolumePrincipled": _principled,
    "ShaderNodeVolumeScatter": _scatter,
}
"""Node type by Blender's identifier -> reader."""
