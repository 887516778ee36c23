# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of nodes that make values and colours: node type -> expression."""

from __future__ import annotations

import bpy

from ....lib.scene import expressions as ex
from ....lib.scene.rays import COUNTS, FLAGS
from ....lib.textures.fold import fold
from .converters import CONVERTERS
from .procedural import PROCEDURAL
from .sky import read_sky
from .textures import TEXTURES
from .tree import Scope, TreeReader, valid_link

_CONTENT_BY_TYPE = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color"}


def _rgb(_: TreeReader, node: bpy.types.Node, __: str, ___: Scope) -> ex.Expression:
    r, g, b, _alpha = node.outputs[0].default_value
    return ex.Constant((r, g, b))


def _value(_: TreeReader, node: bpy.types.Node, __: str, ___: Scope) -> ex.Expression:
    return ex.Constant(node.outputs[0].default_value)


def _math(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    a, b, c = (reader.read(socket, scope) if socket.enabled else ex.ZERO for socket in node.inputs)
    return ex.Math(node.operation, a, b, c, clamp=node.use_clamp)


def _mix(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    suffix = _CONTENT_BY_TYPE.get(node.data_type)
    if suffix is None:
        reader.refuse(node, scope, f", data type {node.data_type.lower()},", "mix values, vectors or colours")
        return ex.BLACK
    non_uniform = suffix == "Vector" and node.factor_mode == "NON_UNIFORM"
    sockets = {socket.identifier: socket for socket in node.inputs}
    is_color = suffix == "Color"
    return ex.Mix(
        reader.read(sockets["Factor_Vector" if non_uniform else "Factor_Float"], scope),
        reader.read(sockets[f"A_{suffix}"], scope),
        reader.read(sockets[f"B_{suffix}"], scope),
        blend=node.blend_type if is_color else "MIX",
        clamp_factor=node.clamp_factor,
        clamp_result=is_color and node.clamp_result,
    )


def _mix_rgb(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    factor, a, b = (reader.read(socket, scope) for socket in node.inputs)
    return ex.Mix(factor, a, b, blend=node.blend_type, clamp_factor=True, clamp_result=node.use_clamp)


def _color_ramp(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    ramp = node.color_ramp
    stops = sorted(ramp.elements, key=lambda stop: stop.position)
    return ex.ColorRamp(
        reader.read(node.inputs[0], scope),
        positions=tuple(stop.position for stop in stops),
        colors=tuple(tuple(stop.color) for stop in stops),
        interpolation=ramp.interpolation,
        mode=ramp.color_mode,
        hue=ramp.hue_interpolation,
        output=output.upper(),
    )


def _fresnel(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    return ex.FresnelFactor(reader.read(node.inputs["IOR"], scope), _normal(reader, node, scope))


def _layer_weight(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    blend = reader.read(node.inputs["Blend"], scope)
    return ex.LayerWeight(blend, output=output.upper(), normal=_normal(reader, node, scope))


def _light_falloff(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    """The strength times a power of the ray's length, faded out over the root of Smooth where the ray is short."""
    strength = reader.read(node.inputs["Strength"], scope)
    smooth = fold(reader.read(node.inputs["Smooth"], scope))
    if output == "Quadratic" and smooth == ex.ZERO:
        return strength
    if reader.is_world:
        reader.refuse(node, scope, f", output '{output}', with its smoothness,", "use Quadratic, and a Smooth of 0")
        return strength
    length = ex.RayCount("RAY_LENGTH")
    square = ex.Math("MULTIPLY", length, length, ex.ZERO)
    factor = {"Quadratic": ex.ONE, "Linear": length, "Constant": square}[output]
    fading = ex.Math("ADD", square, ex.Math("MAXIMUM", smooth, ex.ZERO, ex.ZERO), ex.ZERO)
    share = ex.Math("DIVIDE", square, fading, ex.ZERO)
    return ex.Math("MULTIPLY", strength, ex.Math("MULTIPLY", factor, share, ex.ZERO), ex.ZERO)


def _light_path(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    if output == "Portal Depth":
        return ex.ZERO  # the node that makes it is refused
    count = output.upper().replace(" ", "_")
    if count in COUNTS and not reader.is_world:
        return ex.RayCount(count)
    flag = output.removeprefix("Is ").removesuffix(" Ray").upper()
    if flag not in FLAGS:
        reader.refuse(node, scope, f", output '{output}',", "use another output, or none")
        return ex.ZERO
    return ex.RayFlag(flag)


def _ambient_occlusion(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    color = reader.read(node.inputs["Color"], scope) if output == "Color" else None
    if reader.is_world:
        return ex.ONE if color is None else color  # nothing is near a world
    distance = fold(reader.read(node.inputs["Distance"], scope))
    if distance == ex.ZERO:
        distance = ex.Constant(reader.images.occlusion_distance)
    share = ex.AmbientOcclusion(distance, _normal(reader, node, scope), node.inside, node.only_local, node.samples)
    return share if color is None else ex.Mix(ex.ONE, ex.ValueToColor(share), color, blend="MULTIPLY")


def _bevel(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    if reader.is_world:
        reader.refuse(node, scope, " in a world", "unlink it")
    radius = reader.read(node.inputs["Radius"], scope)
    return ex.Bevel(radius, node.samples, _normal(reader, node, scope))


def _normal(reader: TreeReader, node: bpy.types.Node, scope: Scope) -> ex.Expression | None:
    if reader.is_world:
        reader.refuse(node, scope, " in a world", "unlink it")
    return reader.read(node.inputs["Normal"], scope) if valid_link(node.inputs["Normal"]) else reader.surface_normal


VALUES = {
    **TEXTURES,
    **PROCEDURAL,
    **CONVERTERS,
    "ShaderNodeAmbientOcclusion": _ambient_occlusion,
    "ShaderNodeBevel": _bevel,
    "ShaderNodeRGB": _rgb,
    "ShaderNodeValue": _value,
    "ShaderNodeMath": _math,
    "ShaderNodeMix": _mix,
    "ShaderNodeMixRGB": _mix_rgb,
    "ShaderNodeValToRGB": _color_ramp,
    "ShaderNodeFresnel": _fresnel,
    "ShaderNodeLightFalloff": _light_falloff,
    "ShaderNodeLayerWeight": _layer_weight,
    "ShaderNodeLightPath": _light_path,
    "ShaderNodeTexSky": read_sky,
}
"""Node type by Blender's identifier -> reader."""
