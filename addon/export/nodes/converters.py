# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of Converter and Color nodes: node type -> expression."""

from __future__ import annotations

import bpy
import numpy as np

from ....lib.scene import converters as cv
from ....lib.scene import expressions as ex
from ....lib.textures.fold import fold
from .tree import Scope, TreeReader

_COMPONENTS = {"X": 0, "Y": 1, "Z": 2, "Red": 0, "Green": 1, "Blue": 2, "R": 0, "G": 1, "B": 2, "H": 0, "S": 1, "V": 2}
_VALUES = ("DOT_PRODUCT", "DISTANCE", "LENGTH")
_AXES = {"X_AXIS": (1.0, 0.0, 0.0), "Y_AXIS": (0.0, 1.0, 0.0), "Z_AXIS": (0.0, 0.0, 1.0)}
_CELLS = 256
"""Of the table that Blender makes of a curve, from the least to the largest of its points and of the clipping range."""


def _separate(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    return cv.Component(reader.read(node.inputs[0], scope), _COMPONENTS[output])


def _combine(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    return cv.Combine(*(reader.read(socket, scope) for socket in node.inputs))


def _separate_color(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    color = reader.read(node.inputs[0], scope)
    return cv.Component(
        color if node.mode == "RGB" else cv.ColorModel(color, f"RGB_TO_{node.mode}"), _COMPONENTS[output]
    )


def _combine_color(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    color = cv.Combine(*(reader.read(socket, scope) for socket in node.inputs))
    return color if node.mode == "RGB" else cv.ColorModel(color, f"{node.mode}_TO_RGB")


def _map_range(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    vectors = node.data_type == "FLOAT_VECTOR"
    names = ("From_Min", "From_Max", "To_Min", "To_Max", "Steps")
    wanted = (
        ["Vector", *(f"{n}_FLOAT3" for n in names)] if vectors else ["Value", *(n.replace("_", " ") for n in names)]
    )
    sockets = {socket.identifier: socket for socket in node.inputs}
    parts = (reader.read(sockets[name], scope) for name in wanted)
    return cv.MapRange(*parts, interpolation=node.interpolation_type, clamp=node.clamp)


def _clamp(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    value, low, high = (reader.read(socket, scope) for socket in node.inputs)
    if node.clamp_type == "RANGE":
        low, high = ex.Math("MINIMUM", low, high, ex.ZERO), ex.Math("MAXIMUM", low, high, ex.ZERO)
    return ex.Math("MINIMUM", ex.Math("MAXIMUM", value, low, ex.ZERO), high, ex.ZERO)


def _vector_math(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    gives_value = node.operation in _VALUES
    if gives_value != (output == "Value"):
        reader.refuse(node, scope, f", output '{output}', which is off in this operation,", "unlink it")
        return ex.ZERO if output == "Value" else ex.BLACK
    sockets = {socket.identifier: socket for socket in node.inputs}
    a, b, c = (
        reader.read(sockets[name], scope) if sockets[name].enabled else ex.BLACK
        for name in ("Vector", "Vector_001", "Vector_002")
    )
    scale = reader.read(sockets["Scale"], scope) if sockets["Scale"].enabled else ex.ZERO
    return cv.VectorMath(node.operation, a, b, c, scale)


def _constant_normal(reader: TreeReader, node: bpy.types.Node, output: str, scope: Scope) -> ex.Expression:
    """The Normal node: the direction of the ball that it shows, and the cosine between that and its input."""
    direction = np.array(node.outputs["Normal"].default_value, np.float64)
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        reader.refuse(node, scope, ", whose direction has no length,", "turn its ball")
        return ex.ZERO if output == "Dot" else ex.BLACK
    x, y, z = (direction / length).tolist()
    normal = ex.Constant((x, y, z))
    if output == "Normal":
        return normal
    other = reader.read(node.inputs["Normal"], scope)
    if fold(other) == ex.BLACK:
        reader.refuse(node, scope, ", whose input has no length,", "set a direction as its Normal")
        return ex.ZERO
    return cv.CosineBetween(normal, other)


def _vector_rotate(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    vector, center = (reader.read(node.inputs[name], scope) for name in ("Vector", "Center"))
    if node.rotation_type == "EULER_XYZ":
        if node.invert:
            reader.refuse(node, scope, ", option 'Invert' of Euler angles,", "turn by an axis and an angle")
        off = cv.VectorMath("SUBTRACT", vector, center, ex.BLACK, ex.ZERO)
        turned = ex.Mapping(off, ex.BLACK, reader.read(node.inputs["Rotation"], scope), ex.WHITE)
        return cv.VectorMath("ADD", turned, center, ex.BLACK, ex.ZERO)
    axis = reader.read(node.inputs["Axis"], scope) if node.rotation_type == "AXIS_ANGLE" else None
    angle = reader.read(node.inputs["Angle"], scope)
    if node.invert:
        angle = ex.Math("MULTIPLY", angle, ex.Constant(-1.0), ex.ZERO)
    return cv.VectorRotate(vector, center, axis or ex.Constant(_AXES[node.rotation_type]), angle)


def _hue_saturation(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    return cv.HueSaturation(*(reader.read(socket, scope) for socket in node.inputs))


def _bright_contrast(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    return cv.BrightContrast(*(reader.read(socket, scope) for socket in node.inputs))


def _gamma(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    return ex.Gamma(*(reader.read(socket, scope) for socket in node.inputs))


def _invert(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    factor, color = (reader.read(socket, scope) for socket in node.inputs)
    negative = ex.Mix(ex.ONE, ex.WHITE, color, blend="SUBTRACT")
    return ex.Mix(factor, color, negative, clamp_factor=False)


def _rgb_to_bw(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    return ex.ColorToValue(reader.read(node.inputs[0], scope))


def _blackbody(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    return cv.Blackbody(reader.read(node.inputs[0], scope))


def _curves(reader: TreeReader, node: bpy.types.Node, _: str, scope: Scope) -> ex.Expression:
    """RGB Curves (the fourth curve comes before the three), Vector Curves and Float Curve."""
    mapping = node.mapping
    mapping.update()
    factor, content = (reader.read(socket, scope) for socket in node.inputs)
    curves = [_curve(mapping, one) for one in mapping.curves]
    combined = curves[3] if node.bl_idname == "ShaderNodeRGBCurve" else None
    return cv.Curves(factor, content, tuple(curves[:3]), combined, mapping.extend == "EXTRAPOLATED")


def _curve(mapping: bpy.types.CurveMapping, one: bpy.types.CurveMap) -> cv.Curve:
    """Tabulate a curve by Blender's own evaluation.

    It is linear between the nodes of its table and beyond its ends.
    """
    ends = [point.location[0] for point in one.points]
    low, high = min(mapping.clip_min_x, *ends), max(mapping.clip_max_x, *ends)
    table = tuple(mapping.evaluate(one, low + (high - low) * k / _CELLS) for k in range(_CELLS + 1))
    below, above = (
        [mapping.evaluate(one, x) for x in two] for two in ((low - 1.0, low - 2.0), (high + 1.0, high + 2.0))
    )
    falls, rises = below[0] - below[1], above[1] - above[0]
    return cv.Curve(low, high, table, (below[0] + falls, falls), (above[0] - rises, rises))


CONVERTERS = {
    "ShaderNodeSeparateXYZ": _separate,
    "ShaderNodeSeparateRGB": _separate,
    "ShaderNodeSeparateColor": _separate_color,
    "ShaderNodeCombineXYZ": _combine,
    "ShaderNodeCombineRGB": _combine,
    "ShaderNodeCombineColor": _combine_color,
    "ShaderNodeMapRange": _map_range,
    "ShaderNodeClamp": _clamp,
    "ShaderNodeVectorMath": _vector_math,
    "ShaderNodeNormal": _constant_normal,
    "ShaderNodeVectorRotate": _vector_rotate,
    "ShaderNodeHueSaturation": _hue_saturation,
    "ShaderNodeBrightContrast": _bright_contrast,
    "ShaderNodeGamma": _gamma,
    "ShaderNodeInvert": _invert,
    "ShaderNodeRGBToBW": _rgb_to_bw,
    "ShaderNodeBlackbody": _blackbody,
    "ShaderNodeRGBCurve": _curves,
    "ShaderNodeVectorCurve": _curves,
    "ShaderNodeFloatCurve": _curves,
}
"""Node type by Blender's identifier -> reader."""
