# SPDX-License-Identifier: GPL-3.0-or-later
"""The names of the effects, and of the stages of the integrator in which their work is done."""

from __future__ import annotations

from enum import StrEnum


class Effect(StrEnum):
    """Something that a scene may need simulated; catalogue.py says when."""

    DEPTH_OF_FIELD = "depth of field"
    HIDDEN_OBJECTS = "hidden objects"
    RAY_KINDS = "ray kinds"
    RAY_FLAGS = "ray flags"

    SMOOTH_NORMALS = "smooth normals"
    SEVERAL_MATERIALS = "several materials"
    SEVERAL_LOBES = "several lobes"
    LAMBERT = "Lambert"
    OREN_NAYAR = "Oren-Nayar"
    MIRRORS = "mirrors"
    BECKMANN = "Beckmann"
    GGX = "GGX"
    MULTIPLE_SCATTERING = "multiple scattering"
    ASHIKHMIN_SHIRLEY = "Ashikhmin-Shirley"
    ANISOTROPY = "anisotropy"
    FRESNEL = "Fresnel"
    METALS = "metals"
    GLOSSY_LAYERS = "glossy layers"
    GLASS = "glass"
    REFRACTION = "refraction"
    ROUGH_INTERFACES = "rough interfaces"
    DISPERSION = "dispersion"
    TRANSLUCENCY = "translucency"
    THIN_FILMS = "thin films"
    SHEEN = "sheen"
    VELVET = "velvet"
    TOON = "toon"
    TRANSPARENT_SURFACES = "transparent surfaces"
    VOLUMES = "volumes"
    EMISSION = "emission"

    IMAGE_TEXTURES = "image textures"
    PROCEDURAL_TEXTURES = "procedural textures"
    NORMAL_MAPS = "normal maps"
    BUMPS = "bumps"
    MESH_ATTRIBUTES = "mesh attributes"

    POINT_LIGHTS = "point lights"
    SPHERE_LIGHTS = "sphere lights"
    SUN_LIGHTS = "sun lights"
    AREA_LIGHTS = "area lights"
    MESH_LIGHTS = "mesh lights"
    CONSTANT_WORLD = "constant world"
    ENVIRONMENT_WORLD = "environment world"
    ENVIRONMENT_TABLE = "environment table"

    LIGHT_SAMPLING = "light sampling"
    LIGHT_SELECTION = "light selection"
    MULTIPLE_IMPORTANCE_SAMPLING = "multiple importance sampling"
    SHADOW_RAYS = "shadow rays"
    SHADOWS_APART = "shadows apart"
    LIGHTS_WITHOUT_SHADOWS = "lights without shadows"
    LIGHT_BOUNCES = "light bounces"
    LINKED_LIGHTS = "linked lights"
    LINKED_SHADOWS = "linked shadows"
    SCATTERED_RAYS = "scattered rays"
    LAST_RAYS = "last rays"
    LAST_HITS = "last hits"
    SECOND_HITS = "second hits"
    INDIRECT_LIGHT = "indirect light"
    RUSSIAN_ROULETTE = "Russian roulette"


class Stage(StrEnum):
    """A part of the wavefront loop with a clock of its own, in the loop's order."""

    CAMERA = "camera"
    INTERSECT = "intersect"
    VOLUMES = "volumes"
    EMISSION = "emission"
    SURFACE = "surface"
    PASS_THROUGH = "pass through"
    LIGHTS = "lights"
    SHADE = "shade"
    SHADOW_RAYS = "shadow rays"
    FILM = "film"
    ADVANCE = "advance"
