# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of shader nodes, one function each.

Two tables list them for surfaces and for worlds.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import bpy

from ....lib.scene import expressions as ex
from ....lib.scene import materials as mt
from ....lib.textures.fold import Folder, is_constant
from .principled import read_principled
from .shader_reader import ReadParts, ReadShader, ShaderReader
from .subsurface import make_subsurface, parts_of, read_method
from .tree import Scope, TreeReader
from .volumes import VOLUME_SHADERS

# Cycles' own bounds: below them it takes a lobe for isotropic, and an interface for smooth (alpha_x alpha_y <= 2e-10).
_LEAST_ANISOTROPY = 1e-4
_SMOOTH_ROUGHNESS = 2e-10**0.25

_DISTRIBUTIONS = ("BECKMANN", "GGX", "MULTI_GGX", "ASHIKHMIN_SHIRLEY")


def _diffuse(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    color, roughness = reader.read(node, "Color", scope), reader.read(node, "Roughness", scope)
    closure = mt.Diffuse(color, roughness, reader.normal(node, scope))
    return [reader.lobe(closure, weight)]


def _glossy(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    if node.distribution not in _DISTRIBUTIONS:
        what = f", distribution {node.distribution.replace('_', ' ').title()},"
        reader.values.refuse(node, scope, what, "choose another")
    anisotropy = reader.read(node, "Anisotropy", scope)
    closure = mt.Glossy(
        node.distribution, reader.read(node, "Color", scope), reader.read(node, "Roughness", scope), anisotropy
    )
    closure = replace(closure, normal=reader.normal(node, scope))
    if is_constant(anisotropy) and abs(anisotropy.value) <= _LEAST_ANISOTROPY:
        closure = replace(closure, anisotropy=ex.ZERO)
    else:
        closure = replace(closure, rotation=reader.read(node, "Rotation", scope), tangent=reader.tangent(node, scope))
    return [reader.lobe(closure, weight)]


def _metallic(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    conductor = node.fresnel_type == "PHYSICAL_CONDUCTOR"
    closure = mt.Metallic(
        node.distribution,
        "CONDUCTOR" if conductor else "F82",
        reader.read(node, "IOR" if conductor else "Base Color", scope),
        reader.read(node, "Extinction" if conductor else "Edge Tint", scope),
        reader.read(node, "Roughness", scope),
        normal=reader.normal(node, scope),
        **reader.film(node, scope),
    )
    anisotropy = reader.folder(
        ex.Math("ADD", reader.values.read(node.inputs["Anisotropy"], scope), ex.ZERO, ex.ZERO, clamp=True)
    )
    if anisotropy != ex.ZERO:
        rotation = reader.read(node, "Rotation", scope)
        closure = replace(closure, anisotropy=anisotropy, rotation=rotation, tangent=reader.tangent(node, scope))
    return [reader.lobe(closure, weight)]


def _translucent(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    return [reader.lobe(mt.Translucent(reader.read(node, "Color", scope), reader.normal(node, scope)), weight)]


def _sheen(reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression) -> list[mt.WeightedClosure]:
    kind = mt.Velvet if node.distribution == "ASHIKHMIN" else mt.Sheen
    color, roughness = (reader.read(node, name, scope) for name in ("Color", "Roughness"))
    return [reader.lobe(kind(color, roughness, reader.normal(node, scope)), weight)]


def _toon(reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression) -> list[mt.WeightedClosure]:
    kind = mt.GlossyToon if node.component == "GLOSSY" else mt.Toon
    sockets = (reader.read(node, name, scope) for name in ("Color", "Size", "Smooth"))
    return [reader.lobe(kind(*sockets, reader.normal(node, scope)), weight)]


def _subsurface(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    method = read_method(node, "falloff")
    color, radius, scale = (reader.read(node, name, scope) for name in ("Color", "Radius", "Scale"))
    anisotropy, ior, alpha = ex.ZERO, ex.ONE, ex.ONE
    if not method.is_disk:  # Blender 4.5 has no such sockets then
        anisotropy, ior = (reader.read(node, name, scope) for name in ("Anisotropy", "IOR"))
        alpha = ex.ONE if method.is_skin else reader.read(node, "Roughness", scope)  # it is not squared
    closure = make_subsurface(method, color, radius, scale, anisotropy, ior, alpha, reader.normal(node, scope))
    return [
        reader.lobe(part, reader.folder(ex.Math("MULTIPLY", weight, share, ex.ZERO)))
        for part, share in parts_of(closure)
    ]


def _emission(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    closure = mt.Emission(reader.read(node, "Color", scope), reader.read(node, "Strength", scope))
    return [reader.lobe(closure, weight)]


def _holdout(_: ShaderReader, __: bpy.types.Node, ___: Scope, ____: ex.Expression) -> list[mt.WeightedClosure]:
    """No lobe: on an opaque film a holdout takes what arrives and sends nothing on."""
    return []


def _transparent(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    return [reader.lobe(mt.Transparent(reader.read(node, "Color", scope)), weight)]


def _glass(reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression) -> list[mt.WeightedClosure]:
    color, ior, roughness = (reader.read(node, name, scope) for name in ("Color", "IOR", "Roughness"))
    normal, film = reader.normal(node, scope), reader.film(node, scope)
    if _is_smooth(roughness):
        return [reader.lobe(mt.Glass(color, ior, normal=normal, **film), weight)]
    glass = mt.Glass(color, ior, roughness, node.distribution, normal=normal, **film)
    if "Anisotropy" in node.inputs:  # Blender 5.3 and later
        anisotropy = reader.read(node, "Anisotropy", scope)
        if not (is_constant(anisotropy) and abs(anisotropy.value) <= _LEAST_ANISOTROPY):
            rotation = reader.read(node, "Rotation", scope)
            glass = replace(glass, anisotropy=anisotropy, rotation=rotation, tangent=reader.tangent(node, scope))
    if node.distribution != "MULTI_GGX":
        return [reader.lobe(glass, weight)]
    if not is_constant(ior):
        reader.values.refuse(node, scope, ", socket 'IOR' (textured),", "unlink IOR, or choose GGX")
        glass = replace(glass, ior=ex.ONE)
    return [reader.lobe(replace(glass, color=ex.WHITE, reflection=color, transmission=color), weight)]


def _refraction(
    reader: ShaderReader, node: bpy.types.Node, scope: Scope, weight: ex.Expression
) -> list[mt.WeightedClosure]:
    color, ior, roughness = (reader.read(node, name, scope) for name in ("Color", "IOR", "Roughness"))
    normal = reader.normal(node, scope)
    if _is_smooth(roughness):
        return [reader.lobe(mt.Refraction(color, ior, normal=normal), weight)]
    return [reader.lobe(mt.Refraction(color, ior, roughness, node.distribution, normal), weight)]


def _is_smooth(roughness: ex.Expression) -> bool:
    """Whether Cycles takes the interface for smooth."""
    return is_constant(roughness) and roughness.value <= _SMOOTH_ROUGHNESS


def _mix(reader: ShaderReader, node: bpy.types.Node, scope: Scope) -> list[tuple[bpy.types.NodeSocket, ex.Expression]]:
    factor_socket, first, second = node.inputs
    factor = ex.Math("ADD", reader.values.read(factor_socket, scope), ex.ZERO, ex.ZERO, clamp=True)
    rest = ex.Math("SUBTRACT", ex.ONE, factor, ex.ZERO)
    return [(first, reader.folder(rest)), (second, reader.folder(factor))]


def _add(_: ShaderReader, node: bpy.types.Node, __: Scope) -> list[tuple[bpy.types.NodeSocket, ex.Expression]]:
    return [(socket, ex.ONE) for socket in node.inputs]


_COMBINERS: Mapping[str, ReadParts] = {"ShaderNodeMixShader": _mix, "ShaderNodeAddShader": _add}
_WORLD_SHADERS: Mapping[str, ReadShader] = {
    "ShaderNodeBackground": _emission,
    "ShaderNodeEmission": _emission,
}
_SURFACE_SHADERS: Mapping[str, ReadShader] = {
    "ShaderNodeBsdfDiffuse": _diffuse,
    "ShaderNodeBsdfAnisotropic": _glossy,
    "ShaderNodeBsdfGlossy": _glossy,
    "ShaderNodeEmission": _emission,
    "ShaderNodeHoldout": _holdout,
    "ShaderNodeBsdfTransparent": _transparent,
    "ShaderNodeBsdfTranslucent": _translucent,
    "ShaderNodeBsdfSheen": _sheen,
    "ShaderNodeBsdfToon": _toon,
    "ShaderNodeSubsurfaceScattering": _subsurface,
    "ShaderNodeBsdfGlass": _glass,
    "ShaderNodeBsdfRefraction": _refraction,
    "ShaderNodeBsdfMetallic": _metallic,
    "ShaderNodeBsdfPrincipled": read_principled,
}


def make_shader_reader(values: TreeReader) -> ShaderReader:
    """Make the reader of the shaders that Cycles knows.

    It takes its values from `values`, the tree of a surface or a world.
    """
    if values.is_world:
        return ShaderReader(values, Folder(), _WORLD_SHADERS, _COMBINERS, "on a world")
    return ShaderReader(values, Folder(), _SURFACE_SHADERS, _COMBINERS, "on a surface")


def make_volume_reader(values: TreeReader) -> ShaderReader:
    """The reader of the shaders that Cycles knows in volumes."""
    return ShaderReader(values, Folder(), VOLUME_SHADERS, _COMBINERS, "in a volume")
