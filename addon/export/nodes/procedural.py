# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of procedural texture nodes: node type -> expression."""

from __future__ import annotations

import bpy

from ....lib.scene import expressions as ex
from ....lib.scene import procedural as pr
from .textures import refuse_mapping
from .tree import Scope, TreeReader


class _Sockets:
    """The sockets of one texture node by name; the default vector is the generated coordinate."""

    def __init__(self, reader: TreeReader, node: bpy.types.Node, scope: Scope) -> None:
        refuse_mapping(reader, node, scope)
        self._reader, self._node, self._scope = reader, node, scope

    @property
    def vector(self) -> ex.Expression:
        socket = self._node.inputs.get("Vector")
        if socket is None or not socket.enabled:
            return ex.BLACK
        return self._reader.read_or(socket, self._scope, ex.Coordinates("GENERATED"))

    def __call__(self, name: str, absent: ex.Expression = ex.ZERO) -> ex.Expression:
        """The content of a socket, or `absent` where Blender hides it or has none of the name."""
        socket = self._node.inputs.get(name)
        return absent if socket is None or not socket.enabled else self._reader.read(socket, self._scope)


def _dimensions(text: str) -> int:
    return int(text[0])


def _noise(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    read = _Sockets(reader, node, scope)
    return pr.Noise(
        read.vector,
        *(read(name) for name in ("W", "Scale", "Detail", "Roughness", "Lacunarity", "Offset", "Gain", "Distortion")),
        dimensions=_dimensions(node.noise_dimensions),
        kind=node.noise_type,
        normalize=node.normalize,
        output="COLOR" if output == "Color" else "FACTOR",
    )


def _white_noise(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    vector, w = node.inputs.get("Vector"), node.inputs.get("W")
    return pr.WhiteNoise(
        reader.read_or(vector, scope, ex.Coordinates("GENERATED"))
        if vector is not None and vector.enabled
        else ex.BLACK,
        reader.read(w, scope) if w is not None and w.enabled else ex.ZERO,
        dimensions=_dimensions(node.noise_dimensions),
        output="COLOR" if output == "Color" else "FACTOR",
    )


def _as_output(value: ex.Expression, output: str) -> ex.Expression:
    """A grey texture has the same content at both outputs."""
    return ex.ValueToColor(value) if output == "Color" else value


def _gradient(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    return _as_output(pr.Gradient(_Sockets(reader, node, scope).vector, node.gradient_type), output)


def _wave(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    read = _Sockets(reader, node, scope)
    names = ("Scale", "Distortion", "Detail", "Detail Scale", "Detail Roughness", "Phase Offset")
    wave = pr.Wave(
        read.vector,
        *(read(name) for name in names),
        kind=node.wave_type,
        direction=node.bands_direction if node.wave_type == "BANDS" else node.rings_direction,
        profile=node.wave_profile,
    )
    return _as_output(wave, output)


def _magic(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    read = _Sockets(reader, node, scope)
    color = pr.Magic(read.vector, read("Scale"), read("Distortion"), node.turbulence_depth)
    return color if output == "Color" else ex.VectorToValue(color)


def _brick(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    read = _Sockets(reader, node, scope)
    names = ("Color1", "Color2", "Mortar", "Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")
    return pr.Brick(
        read.vector,
        *(read(name) for name in names),
        offset=node.offset,
        offset_frequency=node.offset_frequency,
        squash=node.squash,
        squash_frequency=node.squash_frequency,
        output="COLOR" if output == "Color" else "FACTOR",
    )


def _voronoi(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    read = _Sockets(reader, node, scope)
    names = ("W", "Scale", "Detail", "Roughness", "Lacunarity", "Smoothness", "Exponent", "Randomness")
    return pr.Voronoi(
        read.vector,
        *(read(name) for name in names),
        dimensions=_dimensions(node.voronoi_dimensions),
        feature=node.feature,
        metric=node.distance,
        normalize=node.normalize,
        output=output.upper(),
        hashing="PCG" if bpy.app.version >= (5, 0, 0) else "LOOKUP3",
    )


PROCEDURAL = {
    "ShaderNodeTexNoise": _noise,
    "ShaderNodeTexWhiteNoise": _white_noise,
    "ShaderNodeTexGradient": _gradient,
    "ShaderNodeTexWave": _wave,
    "ShaderNodeTexMagic": _magic,
    "ShaderNodeTexBrick": _brick,
    "ShaderNodeTexVoronoi": _voronoi,
}
"""Node type by Blender's identifier -> reader."""
