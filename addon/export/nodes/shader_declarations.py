# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of shaders and outputs that the readers know: one row per node type.

Nodes that only these read are here too.
"""

from __future__ import annotations

from collections.abc import Mapping

from .declared import Declaration

# Inputs of phase functions that are refused.
_PHASES = ("HENYEY_GREENSTEIN", "FOURNIER_FORAND", "DRAINE", "RAYLEIGH", "MIE")
_OTHER_PHASES = ("IOR", "Backscatter", "Alpha", "Diameter")

SHADER_DECLARATIONS: Mapping[str, Declaration] = {
    "ShaderNodeAddShader": Declaration(reads=("Shader", "Shader_001")),
    "ShaderNodeBackground": Declaration(reads=("Color", "Strength")),
    "ShaderNodeBsdfAnisotropic": Declaration(
        reads=("Color", "Roughness", "Anisotropy", "Rotation", "Normal", "Tangent"),
        properties={"distribution": ("BECKMANN", "GGX", "ASHIKHMIN_SHIRLEY", "MULTI_GGX")},
    ),
    "ShaderNodeBsdfDiffuse": Declaration(reads=("Color", "Roughness", "Normal")),
    "ShaderNodeBsdfGlass": Declaration(
        reads=(
            "Color",
            "Roughness",
            "IOR",
            "Normal",
            "Anisotropy",
            "Rotation",
            "Tangent",
            "Thin Film Thickness",
            "Thin Film IOR",
        ),
        properties={"distribution": ("BECKMANN", "GGX", "MULTI_GGX")},
    ),
    "ShaderNodeBsdfGlossy": Declaration(
        reads=("Color", "Roughness", "Anisotropy", "Rotation", "Normal", "Tangent"),
        properties={"distribution": ("BECKMANN", "GGX", "ASHIKHMIN_SHIRLEY", "MULTI_GGX")},
    ),
    "ShaderNodeBsdfMetallic": Declaration(
        reads=(
            "Base Color",
            "Edge Tint",
            "IOR",
            "Extinction",
            "Thin Film Thickness",
            "Thin Film IOR",
            "Roughness",
            "Anisotropy",
            "Rotation",
            "Normal",
            "Tangent",
        ),
        properties={"distribution": ("BECKMANN", "GGX", "MULTI_GGX"), "fresnel_type": ("PHYSICAL_CONDUCTOR", "F82")},
    ),
    "ShaderNodeBsdfPrincipled": Declaration(
        reads=(
            "Base Color",
            "Metallic",
            "Roughness",
            "IOR",
            "Alpha",
            "Normal",
            "Diffuse Roughness",
            "Specular IOR Level",
            "Specular Tint",
            "Anisotropic",
            "Anisotropic Rotation",
            "Tangent",
            "Transmission Weight",
            "Transmission Dispersion Scale",
            "Transmission Dispersion Abbe Number",
            "Coat Weight",
            "Coat Roughness",
            "Coat IOR",
            "Coat Tint",
            "Coat Normal",
            "Thin Film Thickness",
            "Thin Film IOR",
            "Sheen Weight",
            "Sheen Roughness",
            "Sheen Tint",
            "Emission Color",
            "Emission Strength",
            "Subsurface Weight",
            "Subsurface Radius",
            "Subsurface Scale",
            "Subsurface IOR",
            "Subsurface Anisotropy",
        ),
        neutral={
            "Thin Wall": 0.0,
        },
        properties={
            "distribution": ("GGX", "MULTI_GGX"),
            "subsurface_method": ("BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN", "RANDOM_WALK_LEGACY"),
        },
    ),
    "ShaderNodeBsdfRefraction": Declaration(
        reads=("Color", "Roughness", "IOR", "Normal"), properties={"distribution": ("BECKMANN", "GGX")}
    ),
    "ShaderNodeBsdfSheen": Declaration(
        reads=("Color", "Roughness", "Normal"), properties={"distribution": ("ASHIKHMIN", "MICROFIBER")}
    ),
    "ShaderNodeBsdfToon": Declaration(
        reads=("Color", "Size", "Smooth", "Normal"), properties={"component": ("DIFFUSE", "GLOSSY")}
    ),
    "ShaderNodeBsdfTranslucent": Declaration(reads=("Color", "Normal")),
    "ShaderNodeBsdfTransparent": Declaration(reads=("Color",)),
    "ShaderNodeDisplacement": Declaration(
        reads=("Height", "Midlevel", "Scale", "Normal"), properties={"space": ("OBJECT", "WORLD")}
    ),
    "ShaderNodeEmission": Declaration(reads=("Color", "Strength")),
    "ShaderNodeHoldout": Declaration(),
    "ShaderNodeMixShader": Declaration(reads=("Fac", "Shader", "Shader_001")),
    "ShaderNodeOutputLight": Declaration(reads=("Surface",), properties={"target": None, "is_active_output": None}),
    "ShaderNodeOutputMaterial": Declaration(
        reads=("Surface", "Volume", "Displacement"),
        idle=("Thickness",),
        properties={"target": None, "is_active_output": None},
    ),
    "ShaderNodeOutputWorld": Declaration(
        reads=("Surface", "Volume"), properties={"target": None, "is_active_output": None}
    ),
    "ShaderNodeSubsurfaceScattering": Declaration(
        reads=("Color", "Scale", "Radius", "IOR", "Roughness", "Anisotropy", "Normal"),
        properties={"falloff": ("BURLEY", "RANDOM_WALK", "RANDOM_WALK_SKIN", "RANDOM_WALK_LEGACY")},
    ),
    "ShaderNodeTangent": Declaration(
        properties={"direction_type": ("RADIAL", "UV_MAP"), "axis": ("X", "Y", "Z"), "uv_map": None}
    ),
    "ShaderNodeVectorDisplacement": Declaration(
        reads=("Vector", "Midlevel", "Scale"), properties={"space": ("OBJECT", "TANGENT", "WORLD")}
    ),
    "ShaderNodeVolumeAbsorption": Declaration(reads=("Color", "Density")),
    "ShaderNodeVolumeCoefficients": Declaration(
        reads=("Absorption Coefficients", "Scatter Coefficients", "Emission Coefficients", "Anisotropy"),
        idle=_OTHER_PHASES,
        properties={"phase": _PHASES},
    ),
    "ShaderNodeVolumePrincipled": Declaration(
        reads=(
            "Color",
            "Color Attribute",
            "Density",
            "Density Attribute",
            "Anisotropy",
            "Absorption Color",
            "Emission Strength",
            "Emission Color",
            "Blackbody Intensity",
        ),
        idle=("Blackbody Tint", "Temperature", "Temperature Attribute"),
    ),
    "ShaderNodeVolumeScatter": Declaration(
        reads=("Color", "Density", "Anisotropy"),
        idle=_OTHER_PHASES,
        properties={"phase": _PHASES},
    ),
}
"""Node type by Blender's identifier -> what its reader knows of it."""
