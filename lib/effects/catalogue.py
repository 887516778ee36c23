# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogue: every effect that can be simulated, the fact that calls for it, the stage it adds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..scene.expressions import (
    ONE,
    Attribute,
    Bump,
    Checker,
    Constant,
    EnvironmentTexture,
    Expression,
    ImageTexture,
    NormalMap,
)
from ..scene.lights import AreaLight, PointLight, SphereLight, SpotLight, SunLight
from ..scene.materials import (
    Anisotropic,
    Closure,
    Diffuse,
    Emission,
    Glass,
    Lobe,
    Metallic,
    Refraction,
    Specular,
    Translucent,
    Transparent,
)
from ..scene.scene import Scene
from ..textures.fold import fold, walk
from ..textures.patterns import PATTERNS

Answer = tuple[bool, str]


@dataclass(frozen=True)
class Effect:
    """One effect: `group` and `name` for the user, `stage` the work it adds, `called_for` the question to the scene."""

    group: str
    name: str
    stage: str
    called_for: Callable[[Scene], Answer]


def _named(names: list[str], what: str, none: str) -> Answer:
    """Needed by the named things, at most three of them spelled out."""
    if not names:
        return False, none
    more = f" and {len(names) - 3} more" if len(names) > 3 else ""
    return True, f"{what} {', '.join(repr(n) for n in names[:3])}{more}"


def _is_zero(expression: Expression) -> bool:
    folded = fold(expression)
    return isinstance(folded, Constant) and not np.any(folded.value)


def adds_nothing(lobe: Lobe) -> bool:
    """Whether weight, colour or strength of a lobe is the constant zero."""
    sockets = [lobe.weight, getattr(lobe.closure, "color", ONE)]
    if isinstance(lobe.closure, Emission):
        sockets.append(lobe.closure.strength)
    return any(_is_zero(socket) for socket in sockets)


def _materials_with(scene: Scene, test: Callable[[Closure], bool]) -> list[str]:
    used = np.unique(scene.mesh.material_index)
    return [
        scene.materials[k].name
        for k in used
        if any(test(lobe.closure) and not adds_nothing(lobe) for lobe in scene.materials[k].lobes)
    ]


def _closure(
    kind: type | tuple[type, ...], test: Callable[[Closure], bool] = lambda _: True
) -> Callable[[Scene], Answer]:
    def called_for(scene: Scene) -> Answer:
        names = _materials_with(scene, lambda c: isinstance(c, kind) and test(c))
        return _named(names, "material", "no material that is seen has such a lobe")

    return called_for


def _light(kind: type | tuple[type, ...], test: Callable[..., bool] = lambda _: True) -> Callable[[Scene], Answer]:
    def called_for(scene: Scene) -> Answer:
        names = [light.name for light in scene.lights if isinstance(light, kind) and test(light)]
        return _named(names, "light", "no such light")

    return called_for


def _distribution(*names: str) -> Callable[[Scene], Answer]:
    """Any closure with one of the distributions, smooth interfaces left out: they have none."""

    def called_for(closure: Closure) -> bool:
        smooth = isinstance(closure, Glass | Refraction) and not _rough(closure)
        return not smooth and getattr(closure, "distribution", None) in names

    return _closure(Closure, called_for)


def _lens(scene: Scene) -> Answer:
    if scene.camera.aperture is None:
        return False, "the camera has no depth of field"
    return True, f"the camera's lens has a radius of {scene.camera.aperture.radius:.4g} m"


def _smooth(scene: Scene) -> Answer:
    if scene.mesh.corner_normals.shape[2] and scene.mesh.smooth.any():
        return True, f"{int(scene.mesh.smooth.sum())} of {scene.mesh.triangle_count} triangles are shaded smooth"
    return False, "every face is shaded flat"


def _world(scene: Scene) -> Expression:
    return fold(scene.world.radiance)


def _constant_world(scene: Scene) -> Answer:
    world = _world(scene)
    if not isinstance(world, Constant):
        return False, "the world's colour depends on the direction"
    if not np.any(world.value):
        return False, "the world is black"
    return True, f"the world's radiance is {np.round(np.broadcast_to(world.value, (3,)), 4).tolist()} everywhere"


def _environment(scene: Scene) -> Answer:
    world = _world(scene)
    if isinstance(world, Constant):
        return False, "the world's colour is the same in every direction"
    textured = any(isinstance(node, EnvironmentTexture) for node in walk(world))
    return (
        True,
        "the world is lit by an environment texture" if textured else "the world's colour depends on the direction",
    )


def _socket(kinds: tuple[type, ...], none: str) -> Callable[[Scene], Answer]:
    """Whether a socket of a material that is seen holds a node of one of `kinds`."""

    def called_for(scene: Scene) -> Answer:
        names = []
        for k in np.unique(scene.mesh.material_index):
            material = scene.materials[k]
            sockets = [
                v for x in material.lobes for v in (x.weight, *vars(x.closure).values()) if isinstance(v, Expression)
            ]
            if any(isinstance(node, kinds) for socket in sockets for node in walk(fold(socket))):
                names.append(material.name)
        return _named(names, "material", none)

    return called_for


def _light_selection(scene: Scene) -> Answer:
    count = len(scene.lights) + _environment(scene)[0] + _mesh_lights(scene)[0]
    return (count > 1, f"{count} lights to choose from" if count > 1 else f"{count} light: nothing to choose")


def _shadows(scene: Scene) -> Answer:
    count = len(scene.lights) + _environment(scene)[0] + _mesh_lights(scene)[0]
    return (count > 0, f"{count} light(s) that faces can hide" if count else "no light is sampled")


def _emits(scene: Scene) -> Answer:
    return _named(_materials_with(scene, lambda c: isinstance(c, Emission)), "material", "no material emits light")


_mesh_lights = _emits


def _indirect(scene: Scene) -> Answer:
    bounces = scene.transport.max_bounces
    return (bounces > 0, f"up to {bounces} bounces after the first hit" if bounces else "bounces are set to 0")


def _rough(closure: Closure) -> bool:
    return not _is_zero(closure.roughness)


EFFECTS: tuple[Effect, ...] = (
    Effect("camera", "depth of field", "samples the lens", _lens),
    Effect("surface", "smooth normals", "mixes corner normals", _smooth),
    Effect("surface", "Lambert", "samples the cosine", _closure(Diffuse, lambda c: not _rough(c))),
    Effect("surface", "Oren-Nayar", "adds the rough diffuse lobe", _closure(Diffuse, _rough)),
    Effect("surface", "Beckmann", "samples Beckmann's slopes", _distribution("BECKMANN")),
    Effect("surface", "GGX", "samples GGX's normals", _distribution("GGX", "MULTI_GGX")),
    Effect("surface", "multiple scattering", "compensates lost energy", _distribution("MULTI_GGX")),
    Effect("surface", "Ashikhmin-Shirley", "samples powers of a cosine", _distribution("ASHIKHMIN_SHIRLEY")),
    Effect("surface", "anisotropy", "turns the lobe to the tangent", _closure(Anisotropic, lambda c: c.is_anisotropic)),
    Effect("surface", "metals", "reflects by the F82 or the conductor's curve", _closure(Metallic)),
    Effect("surface", "glossy layers", "exact Fresnel at facets, and the rest for what lies below", _closure(Specular)),
    Effect("surface", "glass", "exact Fresnel and Snell", _closure(Glass)),
    Effect("surface", "refraction", "Snell", _closure(Refraction)),
    Effect(
        "surface", "rough interfaces", "samples facets that reflect or refract", _closure((Glass, Refraction), _rough)
    ),
    Effect("surface", "translucency", "samples the cosine on the far side", _closure(Translucent)),
    Effect("surface", "transparent surfaces", "lets rays and shadow rays pass", _closure(Transparent)),
    Effect("surface", "emission", "adds radiance at hits", _emits),
    Effect("texture", "image textures", "fetches texels", _socket((ImageTexture,), "no socket reads an image")),
    Effect(
        "texture",
        "procedural textures",
        "hashes cells and mixes slopes",
        _socket((Checker, *PATTERNS), "no socket reads a pattern"),
    ),
    Effect("texture", "normal maps", "turns the normal", _socket((NormalMap,), "no normal is mapped")),
    Effect("texture", "bumps", "takes slopes of a height", _socket((Bump,), "no bump is linked")),
    Effect(
        "texture", "mesh attributes", "mixes corners' values", _socket((Attribute,), "no socket reads an attribute")
    ),
    Effect(
        "light",
        "point lights",
        "one direction, inverse square",
        _light((PointLight, SpotLight), lambda x: not getattr(x, "radius", 0)),
    ),
    Effect(
        "light", "sphere lights", "samples the cone they fill", _light((SphereLight, SpotLight), lambda x: x.radius > 0)
    ),
    Effect("light", "sun lights", "samples the sun's disk", _light(SunLight)),
    Effect("light", "area lights", "samples their solid angle", _light(AreaLight)),
    Effect("light", "mesh lights", "samples emissive faces", _mesh_lights),
    Effect("light", "constant world", "adds the sky to escaping rays", _constant_world),
    Effect("light", "environment world", "samples the world's table", _environment),
    Effect("transport", "shadow rays", "asks whether lights are hidden", _shadows),
    Effect("transport", "light selection", "picks one light a point", _light_selection),
    Effect("transport", "indirect light", "follows reflected rays", _indirect),
)
