# SPDX-License-Identifier: GPL-3.0-or-later
"""Every effect of the catalogue at its neutral value.

These scenes give a forced stage something to do, and show the same image.
"""

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
from etalon.lib.scene.camera import Aperture
from etalon.lib.scene.expressions import (
    ONE,
    ZERO,
    AmbientOcclusion,
    Attribute,
    Bevel,
    Bump,
    Checker,
    Constant,
    Coordinates,
    Expression,
    ImageTexture,
    Mix,
    NormalMap,
    PixelWidth,
    ValueToColor,
)
from etalon.lib.scene.images import Image
from etalon.lib.scene.lights import AreaLight, PointLight, SphereLight, SunLight
from etalon.lib.scene.materials import (
    Closure,
    Diffuse,
    Emission,
    Glass,
    Glossy,
    Metallic,
    Refraction,
    Sheen,
    Specular,
    Subsurface,
    Toon,
    Translucent,
    Transparent,
    Velvet,
    WeightedClosure,
)
from etalon.lib.scene.scene import Scene
from etalon.lib.scene.volumes import Phase, Volume
from etalon.tests.scenes import color

HALF = Constant(0.5)
IOR = Constant(1.5)
DARK = (0.0, 0.0, 0.0)


def _lobe(closure: Closure) -> Callable[[Scene], Scene]:
    """Every material with one lobe more, of weight 0."""

    def added(scene: Scene) -> Scene:
        more = (WeightedClosure(closure, ZERO),)
        return replace(scene, materials=tuple(replace(m, lobes=m.lobes + more) for m in scene.materials))

    return added


def _sockets(name: str, changed: Callable[[Expression | None], Expression]) -> Callable[[Scene], Scene]:
    """Every socket of that name, in every closure that has it.

    A node that changes nothing feeds it.
    """

    def lobe(one: WeightedClosure) -> WeightedClosure:
        if name not in (field.name for field in fields(one.closure)):
            return one
        return replace(one, closure=replace(one.closure, **{name: changed(getattr(one.closure, name))}))

    def added(scene: Scene) -> Scene:
        scene = _with_coordinates(scene)
        return replace(scene, materials=tuple(replace(m, lobes=tuple(map(lobe, m.lobes))) for m in scene.materials))

    return added


def _with_coordinates(scene: Scene) -> Scene:
    """The scene with a UV map, an attribute and an image, where it has none."""
    count = scene.mesh.triangle_count
    uvs = scene.mesh.uvs or {"": np.tile(np.eye(3, 2, dtype=np.float32)[:, :, None], count)}
    attributes = scene.mesh.attributes or {"paint": np.ones((3, 6, count), np.float32)}
    generated = scene.mesh.vertices.astype(np.float32)
    images = scene.images or (Image("image", np.ones((64, 64, 4), np.float32), "LINEAR"),)
    return replace(scene, mesh=replace(scene.mesh, uvs=uvs, attributes=attributes, generated=generated), images=images)


def _unused(node: Expression) -> Callable[[Expression], Expression]:
    return lambda socket: Mix(ZERO, socket, node)


def _light(light: object) -> Callable[[Scene], Scene]:
    return lambda scene: replace(scene, lights=(*scene.lights, light))


def _lens(scene: Scene) -> Scene:
    return replace(scene, camera=replace(scene.camera, aperture=Aperture(0.0, 0, 0.0, 1.0, 5.0)))


def _smooth(scene: Scene) -> Scene:
    """The faces' own normals at all corners."""
    mesh = scene.mesh
    a, b, c = (mesh.vertices[:, corner] for corner in mesh.triangles)
    normal = np.cross(b - a, c - a, axis=0)
    normal /= np.linalg.norm(normal, axis=0)
    corners = np.repeat(normal[None].astype(np.float32), 3, axis=0)
    return replace(scene, mesh=replace(mesh, smooth=np.ones(mesh.triangle_count, bool), corner_normals=corners))


def _several_materials(scene: Scene) -> Scene:
    """Every second face with a copy of its material."""
    index = scene.mesh.material_index.copy()
    index[::2] += len(scene.materials)
    return replace(scene, mesh=replace(scene.mesh, material_index=index), materials=scene.materials * 2)


def _as_it_is(scene: Scene) -> Scene:
    return scene


# Effects that bring others with them: a second light is to be chosen from, and so on.
_MORE_LIGHTS = ("light sampling", "light selection", "multiple importance sampling")
TOGETHER: dict[str, tuple[str, ...]] = {
    "point lights": _MORE_LIGHTS,
    "sphere lights": _MORE_LIGHTS,
    "sun lights": _MORE_LIGHTS,
    "area lights": _MORE_LIGHTS,
    "mesh lights": ("emission", *_MORE_LIGHTS),
    "environment table": ("environment world", *_MORE_LIGHTS),
    "scattered rays": ("last rays",),
    "last hits": ("scattered rays", "last rays"),
    "second hits": ("scattered rays", "last rays"),
    "indirect light": ("second hits", "scattered rays", "last rays"),
    "Russian roulette": ("indirect light", "second hits", "scattered rays", "last rays"),
}


NEUTRAL: dict[str, Callable[[Scene], Scene]] = {
    "depth of field": _lens,
    "motion blur": _as_it_is,
    "hidden objects": _as_it_is,
    "shadow catchers": _as_it_is,
    "ray kinds": _as_it_is,
    "ray flags": _as_it_is,
    "ray counts": _as_it_is,
    "smooth normals": _smooth,
    "several materials": _several_materials,
    "several lobes": _lobe(Diffuse()),
    "Lambert": _lobe(Diffuse()),
    "Oren-Nayar": _lobe(Diffuse(roughness=HALF)),
    "mirrors": _lobe(Glossy()),
    "Beckmann": _lobe(Glossy("BECKMANN", roughness=HALF)),
    "GGX": _lobe(Glossy("GGX", roughness=HALF)),
    "multiple scattering": _lobe(Glossy("MULTI_GGX", roughness=HALF)),
    "Ashikhmin-Shirley": _lobe(Glossy("ASHIKHMIN_SHIRLEY", roughness=HALF)),
    "other models": _lobe(Glossy("ward", roughness=HALF)),
    "anisotropy": lambda scene: _lobe(Glossy("GGX", roughness=HALF, anisotropy=HALF))(_with_coordinates(scene)),
    "Fresnel": _lobe(Metallic("GGX", "CONDUCTOR", color(0.2), color(3.0), HALF)),
    "metals": _lobe(Metallic("GGX", roughness=HALF)),
    "glossy layers": _lobe(Specular("GGX", IOR, roughness=HALF)),
    "glass": _lobe(Glass(ior=IOR)),
    "refraction": _lobe(Refraction(ior=IOR)),
    "rough interfaces": _lobe(Glass(ior=IOR, roughness=HALF)),
    "dispersion": _lobe(Glass(ior=IOR, dispersion=ZERO)),
    "translucency": _lobe(Translucent()),
    "subsurface scattering": _lobe(Subsurface(radius=color(0.1))),
    "thin films": _lobe(Metallic("GGX", roughness=HALF, film_thickness=Constant(200.0))),
    "sheen": _lobe(Sheen(roughness=HALF)),
    "velvet": _lobe(Velvet()),
    "toon": _lobe(Toon()),
    "transparent surfaces": _lobe(Transparent(color(0.0))),
    "volumes": lambda scene: replace(scene, world=replace(scene.world, volume=Volume())),
    "volume scattering": lambda scene: replace(scene, world=replace(scene.world, volume=Volume(phases=(Phase(DARK),)))),
    "emission": _lobe(Emission(strength=ZERO)),
    "image textures": _sockets("color", _unused(ImageTexture(Coordinates("UV"), 0))),
    "procedural textures": _sockets("color", _unused(Checker(Coordinates("UV"), color(0.2), color(0.8), ONE))),
    "normal maps": _sockets("normal", lambda old: old or NormalMap(color(0.7), ZERO)),
    "bevels": _sockets("normal", lambda old: old or Bevel(ZERO)),
    "bumps": _sockets("normal", lambda old: old or Bump(Constant(0.3), ZERO, ONE)),
    "mesh attributes": _sockets("color", _unused(Attribute("paint"))),
    "pixel widths": _sockets("color", _unused(ValueToColor(PixelWidth()))),
    "ambient occlusion": _sockets("color", _unused(ValueToColor(AmbientOcclusion(ONE)))),
    "point lights": _light(PointLight("dark", (0.0, 0.0, 3.0), DARK)),
    "sphere lights": _light(SphereLight("dark", (0.0, 0.0, 3.0), 0.5, DARK)),
    "sun lights": _light(SunLight("dark", (0.0, 0.0, 1.0), 0.1, DARK)),
    "area lights": _light(
        AreaLight(
            "dark", (0.0, 0.0, 3.0), (1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0), "RECTANGLE", DARK, np.pi
        )
    ),
    "mesh lights": _lobe(Emission(strength=ZERO)),
    "constant world": _as_it_is,
    "environment world": _as_it_is,
    "environment table": _as_it_is,
    "light sampling": _as_it_is,
    "light selection": _as_it_is,
    "multiple importance sampling": _as_it_is,
    "shadow rays": _as_it_is,
    "shadows apart": _as_it_is,
    "lights without shadows": _as_it_is,
    "light bounces": _as_it_is,
    "linked lights": _as_it_is,
    "linked shadows": _as_it_is,
    "scattered rays": _as_it_is,
    "last rays": _as_it_is,
    "last hits": _as_it_is,
    "second hits": _as_it_is,
    "indirect light": _as_it_is,
    "Russian roulette": _as_it_is,
}
