# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue: every effect that can be simulated, the fact that calls for it, the stage it adds, and its neutral value."""

from __future__ import annotations

from dataclasses import dataclass

from ..scene.expressions import Attribute, Bump, Checker, ImageTexture, NormalMap
from ..scene.lights import AreaLight, PointLight, SphereLight, SpotLight, SunLight
from ..scene.materials import (
    Anisotropic,
    Diffuse,
    Glass,
    Glossy,
    Metallic,
    Refraction,
    Specular,
    Translucent,
)
from ..textures.patterns import PATTERNS
from . import surface, transport
from .facts import is_smooth, is_zero
from .surface import Question, closure, distribution, is_rough, socket
from .transport import light


@dataclass(frozen=True)
class Effect:
    """One effect: `group` and `name` for the user, `stage` the work it adds, `neutral` the value at which it does nothing.

    `called_for` is the question to the scene's facts.
    """

    group: str
    name: str
    stage: str
    neutral: str
    called_for: Question


_WEIGHT = "a lobe of weight 0"
_DARK = "a light without power"
_CONSTANT = "a constant"

EFFECTS: tuple[Effect, ...] = (
    Effect("camera", "depth of field", "samples the lens", "a lens of radius 0", transport.lens),
    Effect("camera", "hidden objects", "a tree of faces for the camera", "none hides", transport.hidden_objects),
    Effect("surface", "smooth normals", "mixes corner normals", "the face's normal", surface.smooth_normals),
    Effect("surface", "several materials", "sorts hits by material", "one material", surface.several_materials),
    Effect("surface", "several lobes", "picks one lobe, counts all", _WEIGHT, surface.several_lobes),
    Effect("surface", "Lambert", "samples the cosine", _WEIGHT, closure(Diffuse, lambda c: not is_rough(c))),
    Effect("surface", "Oren-Nayar", "adds the rough diffuse lobe", "roughness 0", closure(Diffuse, is_rough)),
    Effect("surface", "mirrors", "reflects", _WEIGHT, closure((Glossy, Metallic, Specular), is_smooth)),
    Effect("surface", "Beckmann", "samples Beckmann's slopes", _WEIGHT, distribution("BECKMANN")),
    Effect("surface", "GGX", "samples GGX's normals", _WEIGHT, distribution("GGX", "MULTI_GGX")),
    Effect("surface", "multiple scattering", "compensates lost energy", "a factor of 1", distribution("MULTI_GGX")),
    Effect("surface", "Ashikhmin-Shirley", "samples powers of a cosine", _WEIGHT, distribution("ASHIKHMIN_SHIRLEY")),
    Effect(
        "surface",
        "anisotropy",
        "turns the lobe to the tangent",
        "equal alphas",
        closure(Anisotropic, lambda c: c.is_anisotropic),
    ),
    Effect("surface", "Fresnel", "works out reflectances by angle", "a reflectance of 1", surface.fresnel),
    Effect("surface", "metals", "reflects by the F82 or the conductor's curve", _WEIGHT, closure(Metallic)),
    Effect(
        "surface",
        "glossy layers",
        "exact Fresnel at facets, and the rest for what lies below",
        _WEIGHT,
        closure(Specular),
    ),
    Effect("surface", "glass", "exact Fresnel and Snell", _WEIGHT, closure(Glass)),
    Effect("surface", "refraction", "Snell", _WEIGHT, closure(Refraction)),
    Effect(
        "surface",
        "rough interfaces",
        "samples facets that reflect or refract",
        _WEIGHT,
        closure((Glass, Refraction), is_rough),
    ),
    Effect(
        "surface",
        "dispersion",
        "draws a wavelength for each path",
        "an infinite Abbe number",
        closure(Glass, lambda c: not is_zero(c.dispersion)),
    ),
    Effect("surface", "translucency", "samples the cosine on the far side", _WEIGHT, closure(Translucent)),
    Effect(
        "surface", "transparent surfaces", "lets rays and shadow rays pass", "transparency 0", transport.transparency
    ),
    Effect("surface", "emission", "adds radiance at hits", "radiance 0", transport.emission),
    Effect(
        "texture", "image textures", "fetches texels", _CONSTANT, socket((ImageTexture,), "no socket reads an image")
    ),
    Effect(
        "texture",
        "procedural textures",
        "hashes cells and mixes slopes",
        _CONSTANT,
        socket((Checker, *PATTERNS), "no socket reads a pattern"),
    ),
    Effect("texture", "normal maps", "turns the normal", "strength 0", socket((NormalMap,), "no normal is mapped")),
    Effect("texture", "bumps", "takes slopes of a height", "strength 0", socket((Bump,), "no bump is linked")),
    Effect(
        "texture",
        "mesh attributes",
        "mixes corners' values",
        _CONSTANT,
        socket((Attribute,), "no socket reads an attribute"),
    ),
    Effect(
        "light",
        "point lights",
        "one direction, inverse square",
        _DARK,
        light((PointLight, SpotLight), lambda x: not getattr(x, "radius", 0)),
    ),
    Effect(
        "light",
        "sphere lights",
        "samples the cone they fill",
        _DARK,
        light((SphereLight, SpotLight), lambda x: x.radius > 0),
    ),
    Effect("light", "sun lights", "samples the sun's disk", _DARK, light(SunLight)),
    Effect("light", "area lights", "samples their solid angle", _DARK, light(AreaLight)),
    Effect("light", "mesh lights", "samples emissive faces", "radiance 0", transport.mesh_lights),
    Effect("light", "constant world", "adds the sky to escaping rays", "a black world", transport.constant_world),
    Effect(
        "light",
        "environment world",
        "asks the world for every escaping ray",
        "the same world everywhere",
        transport.environment_world,
    ),
    Effect(
        "light",
        "environment table",
        "probes the world and samples where it is bright",
        "no light sampling of the world",
        transport.environment_table,
    ),
    Effect("transport", "light sampling", "samples a direction to a light", "no lights", transport.light_sampling),
    Effect("transport", "light selection", "picks one light a point", "one light", transport.light_selection),
    Effect(
        "transport",
        "multiple importance sampling",
        "weighs light against lobe sampling",
        "a weight of 1",
        transport.multiple_importance_sampling,
    ),
    Effect("transport", "shadow rays", "asks whether lights are hidden", "all is lit", transport.shadow_rays),
    Effect("transport", "scattered rays", "samples lobes for directions", "no light", transport.scattered_rays),
    Effect("transport", "last rays", "follows the ray after the last scattering", "no light", transport.last_rays),
    Effect("transport", "last hits", "asks where the last ray ends", "whether it ends", transport.last_hits),
    Effect("transport", "second hits", "asks what rays meet after a face", "they meet nothing", transport.second_hits),
    Effect("transport", "indirect light", "scatters at further faces", "no bounces", transport.indirect_light),
    Effect("transport", "Russian roulette", "ends weak paths at random", "survival 1", transport.roulette),
)
