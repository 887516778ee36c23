# SPDX-License-Identifier: GPL-3.0-or-later
"""Every effect that can be simulated, its stage, and the question that decides on it.

A new effect is one name in names.py and one row here.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..scene.expressions import (
    AmbientOcclusion,
    Attribute,
    Bevel,
    Bump,
    Checker,
    EnvironmentTexture,
    ImageTexture,
    NormalMap,
    PixelWidth,
)
from ..scene.lights import AreaLight, PointLight, SphereLight, SpotLight, SunLight
from ..scene.materials import (
    Anisotropic,
    Diffuse,
    Glass,
    Glossy,
    Metallic,
    Refraction,
    Sheen,
    Specular,
    Subsurface,
    Toon,
    Translucent,
    Velvet,
)
from ..textures.patterns import PATTERNS
from . import masks, surface, transport, volumes
from .facts import is_smooth, is_zero
from .names import Effect, Stage
from .surface import Question, closure, distribution, is_rough, socket
from .transport import light


@dataclass(frozen=True)
class Entry:
    """One effect: its stage, and the question that decides whether it is needed.

    `stage` is the stage of the integrator that does most of its work.
    """

    effect: Effect
    stage: Stage
    is_needed: Question


EFFECTS: tuple[Entry, ...] = (
    # The camera.
    Entry(Effect.DEPTH_OF_FIELD, Stage.CAMERA, transport.lens),
    Entry(Effect.MOTION_BLUR, Stage.CAMERA, transport.motion),
    Entry(Effect.HIDDEN_OBJECTS, Stage.INTERSECT, masks.hidden_objects),
    Entry(Effect.SHADOW_CATCHERS, Stage.INTERSECT, masks.shadow_catchers),
    Entry(Effect.RAY_KINDS, Stage.INTERSECT, masks.ray_kinds),
    Entry(Effect.RAY_FLAGS, Stage.SURFACE, masks.ray_flags),
    Entry(Effect.RAY_COUNTS, Stage.SURFACE, masks.ray_counts),
    # Surfaces: normals, materials, lobes.
    Entry(Effect.SMOOTH_NORMALS, Stage.SURFACE, surface.smooth_normals),
    Entry(Effect.SEVERAL_MATERIALS, Stage.SURFACE, surface.several_materials),
    Entry(Effect.SEVERAL_LOBES, Stage.SHADE, surface.several_lobes),
    Entry(Effect.LAMBERT, Stage.SHADE, closure(Diffuse, lambda c: not is_rough(c))),
    Entry(Effect.OREN_NAYAR, Stage.SHADE, closure(Diffuse, is_rough)),
    Entry(Effect.MIRRORS, Stage.SHADE, closure((Glossy, Metallic, Specular), is_smooth)),
    Entry(Effect.BECKMANN, Stage.SHADE, distribution("BECKMANN")),
    Entry(Effect.GGX, Stage.SHADE, distribution("GGX", "MULTI_GGX")),
    Entry(Effect.MULTIPLE_SCATTERING, Stage.SHADE, distribution("MULTI_GGX")),
    Entry(Effect.ASHIKHMIN_SHIRLEY, Stage.SHADE, distribution("ASHIKHMIN_SHIRLEY")),
    Entry(Effect.OTHER_MODELS, Stage.SHADE, closure(Glossy, surface.is_replaced)),
    Entry(Effect.ANISOTROPY, Stage.SHADE, closure(Anisotropic, lambda c: c.is_anisotropic)),
    Entry(Effect.FRESNEL, Stage.SHADE, surface.fresnel),
    Entry(Effect.METALS, Stage.SHADE, closure(Metallic)),
    Entry(Effect.GLOSSY_LAYERS, Stage.SHADE, closure(Specular)),
    Entry(Effect.GLASS, Stage.SHADE, closure(Glass)),
    Entry(Effect.REFRACTION, Stage.SHADE, closure(Refraction)),
    Entry(Effect.ROUGH_INTERFACES, Stage.SHADE, closure((Glass, Refraction), is_rough)),
    Entry(Effect.DISPERSION, Stage.SHADE, closure(Glass, lambda c: not is_zero(c.dispersion))),
    Entry(Effect.TRANSLUCENCY, Stage.SHADE, closure(Translucent)),
    Entry(Effect.SUBSURFACE, Stage.SUBSURFACE, closure(Subsurface)),
    Entry(Effect.THIN_FILMS, Stage.SHADE, closure((Metallic, Specular, Glass), surface.has_film)),
    Entry(Effect.SHEEN, Stage.SHADE, closure(Sheen)),
    Entry(Effect.VELVET, Stage.SHADE, closure(Velvet)),
    Entry(Effect.TOON, Stage.SHADE, closure(Toon)),
    Entry(Effect.TRANSPARENT_SURFACES, Stage.PASS_THROUGH, transport.transparency),
    Entry(Effect.VOLUMES, Stage.VOLUMES, volumes.volumes),
    Entry(Effect.VOLUME_SCATTERING, Stage.VOLUMES, volumes.scattering),
    Entry(Effect.EMISSION, Stage.EMISSION, transport.emission),
    # Nodes that sockets read.
    Entry(Effect.IMAGE_TEXTURES, Stage.SHADE, socket((ImageTexture, EnvironmentTexture), "no socket reads an image")),
    Entry(Effect.PROCEDURAL_TEXTURES, Stage.SHADE, socket((Checker, *PATTERNS), "no socket reads a pattern")),
    Entry(Effect.NORMAL_MAPS, Stage.SHADE, socket((NormalMap,), "no normal is mapped")),
    Entry(Effect.BUMPS, Stage.SHADE, socket((Bump,), "no bump is linked")),
    Entry(Effect.BEVELS, Stage.SHADE, socket((Bevel,), "no bevel is linked")),
    Entry(Effect.MESH_ATTRIBUTES, Stage.SHADE, socket((Attribute,), "no socket reads an attribute")),
    Entry(Effect.AMBIENT_OCCLUSION, Stage.SHADE, socket((AmbientOcclusion,), "no socket reads ambient occlusion")),
    Entry(Effect.PIXEL_WIDTHS, Stage.SHADE, socket((PixelWidth,), "no socket reads the width of pixels")),
    # What shines.
    Entry(Effect.POINT_LIGHTS, Stage.LIGHTS, light((PointLight, SpotLight), lambda x: not getattr(x, "radius", 0))),
    Entry(Effect.SPHERE_LIGHTS, Stage.LIGHTS, light((SphereLight, SpotLight), lambda x: x.radius > 0)),
    Entry(Effect.SUN_LIGHTS, Stage.LIGHTS, light(SunLight)),
    Entry(Effect.AREA_LIGHTS, Stage.LIGHTS, light(AreaLight)),
    Entry(Effect.MESH_LIGHTS, Stage.LIGHTS, transport.mesh_lights),
    Entry(Effect.CONSTANT_WORLD, Stage.EMISSION, transport.constant_world),
    Entry(Effect.ENVIRONMENT_WORLD, Stage.EMISSION, transport.environment_world),
    Entry(Effect.ENVIRONMENT_TABLE, Stage.LIGHTS, transport.environment_table),
    # How light gets about.
    Entry(Effect.LIGHT_SAMPLING, Stage.LIGHTS, transport.light_sampling),
    Entry(Effect.LIGHT_SELECTION, Stage.LIGHTS, transport.light_selection),
    Entry(Effect.MULTIPLE_IMPORTANCE_SAMPLING, Stage.SHADE, transport.multiple_importance_sampling),
    Entry(Effect.SHADOW_RAYS, Stage.SHADOW_RAYS, transport.shadow_rays),
    Entry(Effect.SHADOWS_APART, Stage.SHADOW_RAYS, masks.shadows_apart),
    Entry(Effect.LIGHTS_WITHOUT_SHADOWS, Stage.SHADOW_RAYS, masks.lights_without_shadows),
    Entry(Effect.LIGHT_BOUNCES, Stage.LIGHTS, masks.light_bounces),
    Entry(Effect.LINKED_LIGHTS, Stage.LIGHTS, masks.linked_lights),
    Entry(Effect.LINKED_SHADOWS, Stage.SHADOW_RAYS, masks.linked_shadows),
    Entry(Effect.SCATTERED_RAYS, Stage.ADVANCE, transport.scattered_rays),
    Entry(Effect.LAST_RAYS, Stage.INTERSECT, transport.last_rays),
    Entry(Effect.LAST_HITS, Stage.INTERSECT, transport.last_hits),
    Entry(Effect.SECOND_HITS, Stage.INTERSECT, transport.second_hits),
    Entry(Effect.INDIRECT_LIGHT, Stage.INTERSECT, transport.indirect_light),
    Entry(Effect.RUSSIAN_ROULETTE, Stage.ADVANCE, transport.roulette),
)
