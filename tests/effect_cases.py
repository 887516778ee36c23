# SPDX-License-Identifier: GPL-3.0-or-later
"""For every effect of the catalogue: scenes that call for it, and scenes that do not."""

from dataclasses import replace

import numpy as np
from etalon.lib.scene import rays
from etalon.lib.scene.converters import Component
from etalon.lib.scene.expressions import (
    ZERO,
    AmbientOcclusion,
    Attribute,
    Bevel,
    Bump,
    Constant,
    Coordinates,
    EnvironmentTexture,
    FresnelFactor,
    Math,
    NormalMap,
    PixelWidth,
    RayCount,
    RayFlag,
    ValueToColor,
    Wireframe,
)
from etalon.lib.scene.lights import SpotLight
from etalon.lib.scene.links import Links
from etalon.lib.scene.materials import (
    Diffuse,
    Emission,
    Glass,
    Glossy,
    GlossyToon,
    Material,
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
from etalon.lib.scene.motion import Motion
from etalon.lib.scene.scene import Transport
from etalon.lib.scene.volumes import Phase, Volume
from etalon.lib.scene.world import World
from etalon.tests.effect_parts import (
    AREA,
    BOUNDS,
    BOWL,
    CAMERA,
    COATED,
    CONE,
    CROWD,
    CROWDED,
    CROWDED_LAMP,
    DARK,
    FLAT,
    HALF,
    HIDING,
    IMAGE,
    INSIDE,
    LAMP,
    LAMP_AND_MIRROR,
    LEFT_TO_RIGHT,
    LENS,
    NEAR_ONLY,
    ONE_LIT,
    OPAQUE_SHADOW,
    PATTERNED,
    PLAIN,
    POINT,
    RISING,
    SHADOWLESS,
    SLOPED,
    SMOKE,
    SPHERE,
    SUN,
    TEXTURED,
    TINTED,
    UNHIDDEN,
    UNKNOWN,
    UNREFLECTED,
    catching,
    hiding,
    linked,
    of,
    with_uvs,
)
from etalon.tests.scenes import (
    color,
    cube,
    diffuse,
    floor,
    glass,
    glossy,
    icosphere,
    material,
    scene,
)

# Effect -> scenes that call for it, scenes that do not (the same without the cause, or with a cause that adds nothing).
CASES = {
    "depth of field": (
        [replace(PLAIN, camera=replace(CAMERA, aperture=LENS))],
        [PLAIN],
    ),
    "motion blur": (
        [
            replace(PLAIN, motion=Motion(camera=LEFT_TO_RIGHT)),
            replace(CROWDED, motion=Motion(objects={0: RISING}, shutter=np.array([0.0, 1.0, 0.5]))),
        ],
        [PLAIN, CROWDED],
    ),
    "hidden objects": ([HIDING, hiding(replace(CROWDED, lights=(POINT,)), rays.SHADOW)], [PLAIN, CROWDED]),
    "shadow catchers": ([catching(CROWDED)], [PLAIN, CROWDED, HIDING]),
    "ray kinds": (
        [
            replace(CROWDED, world=replace(SLOPED, rays=rays.SCATTERED)),
            replace(scene(CROWD, COATED, CAMERA), lights=(UNREFLECTED, POINT), transport=Transport(1)),
            hiding(scene(CROWD, COATED, CAMERA), rays.GLOSSY),
        ],
        [PLAIN, CROWDED, HIDING, replace(CROWDED, lights=(AREA,))],
    ),
    "ray flags": (
        [
            of(Diffuse(ValueToColor(RayFlag("CAMERA")))),
            scene(
                CROWD, [diffuse(0.5), material(Diffuse(ValueToColor(RayFlag("DIFFUSE"))))], CAMERA, (AREA,), bounces=1
            ),
            replace(CROWDED, world=World(ValueToColor(RayFlag("DIFFUSE")), (8, 4))),
        ],
        [PLAIN, CROWDED, of(Diffuse(color(0.5)), Emission(ValueToColor(RayFlag("CAMERA")), ZERO))],
    ),
    "ray counts": (
        [of(Diffuse(ValueToColor(RayCount("RAY_LENGTH")))), of(Diffuse(ValueToColor(RayCount("DIFFUSE_DEPTH"))))],
        [PLAIN, CROWDED, of(Diffuse(ValueToColor(RayFlag("CAMERA"))))],
    ),
    "smooth normals": (
        [scene(icosphere(smooth=True), diffuse(0.5), CAMERA)],
        [scene(icosphere(), diffuse(0.5), CAMERA)],
    ),
    "several materials": (
        [scene([cube(), floor(2.0, -1.5, 1)], [diffuse(0.5), glossy(0.2)], CAMERA)],
        [PLAIN, scene(cube(), [diffuse(0.5), glossy(0.2)], CAMERA)],
    ),
    "several lobes": (
        [of(Diffuse(color(0.3)), Glossy("GGX", color(0.4), HALF))],
        [PLAIN, of(Diffuse(color(0.3)), Glossy("GGX", color(0.0), HALF)), of(Diffuse(color(0.3)), Emission())],
    ),
    "Lambert": ([PLAIN], [of(Diffuse(color(0.5), HALF)), of(Diffuse(color(0.0))), of(Glossy())]),
    "Oren-Nayar": ([of(Diffuse(color(0.5), HALF))], [PLAIN, of(Diffuse(color(0.0), HALF))]),
    "mirrors": ([of(Glossy("GGX"))], [of(Glossy("GGX", roughness=HALF)), of(Glossy("ASHIKHMIN_SHIRLEY"))]),
    "Beckmann": ([of(Glossy("BECKMANN", roughness=HALF))], [of(Glossy("GGX", roughness=HALF)), PLAIN]),
    "GGX": (
        [of(Glossy("GGX", roughness=HALF)), of(Glossy("MULTI_GGX", roughness=HALF))],
        [of(Glossy("BECKMANN", roughness=HALF)), of(Glossy("GGX", color(0.0), HALF)), PLAIN],
    ),
    "multiple scattering": ([of(Glossy("MULTI_GGX", roughness=HALF))], [of(Glossy("GGX", roughness=HALF))]),
    "anisotropy": (
        [
            with_uvs(of(Glossy("GGX", roughness=HALF, anisotropy=HALF))),
            with_uvs(of(Glass(ior=Constant(1.5), roughness=HALF, anisotropy=HALF))),
        ],
        [of(Glossy("GGX", roughness=HALF)), of(Glossy("GGX", roughness=HALF, anisotropy=Constant(1e-5)))],
    ),
    "Ashikhmin-Shirley": (
        [of(Glossy("ASHIKHMIN_SHIRLEY", roughness=HALF))],
        [of(Glossy("GGX", roughness=HALF))],
    ),
    "other models": (
        [
            of(Glossy("student-t:g=2.5", roughness=HALF)),
            of(Glossy("ward", roughness=HALF)),
            of(Glossy("GGX", roughness=HALF, fresnel="schlick")),
        ],
        [of(Glossy("GGX", roughness=HALF)), of(Glossy("ward")), of(Metallic("GGX", roughness=HALF))],
    ),
    "Fresnel": (
        [
            of(Glossy("GGX", color=Constant(0.5), roughness=HALF, fresnel="cook-torrance")),
            of(Metallic("GGX", roughness=HALF)),
            of(Glass(ior=Constant(1.5))),
            of(Diffuse(ValueToColor(FresnelFactor(Constant(1.5))))),
        ],
        [PLAIN, of(Glossy("GGX", roughness=HALF)), of(Refraction(ior=Constant(1.5)))],
    ),
    "metals": ([of(Metallic("GGX", roughness=HALF))], [of(Glossy("GGX", roughness=HALF))]),
    "glossy layers": ([of(Specular("GGX", Constant(1.5)))], [of(Metallic("GGX", roughness=HALF))]),
    "rough interfaces": (
        [of(Glass(ior=Constant(1.5), roughness=HALF)), of(Refraction(ior=Constant(1.5), roughness=HALF))],
        [of(Glass(ior=Constant(1.5)))],
    ),
    "dispersion": (
        [of(Glass(ior=Constant(1.5), dispersion=Constant(0.05)))],
        [of(Glass(ior=Constant(1.5))), of(Glass(color(0.0), ior=Constant(1.5), dispersion=HALF)), PLAIN],
    ),
    "thin films": (
        [of(Metallic("GGX", roughness=HALF, film_thickness=Constant(200.0)))],
        [of(Metallic("GGX", roughness=HALF, film_thickness=Constant(0.1))), PLAIN],
    ),
    "sheen": ([of(Sheen(roughness=HALF))], [of(Sheen(color(0.0), HALF)), of(Velvet())]),
    "velvet": ([of(Velvet())], [of(Velvet(color(0.0))), of(Sheen(roughness=HALF))]),
    "toon": ([of(Toon()), of(GlossyToon(size=HALF))], [of(Toon(color=color(0.0))), PLAIN]),
    "subsurface scattering": (
        [of(Subsurface(color(0.5), color(0.3))), of(Diffuse(color(0.5)), Subsurface(color(0.4), color(0.2, 0.1, 0.0)))],
        [of(Subsurface(color(0.0))), PLAIN],
    ),
    "translucency": ([of(Translucent())], [of(Translucent(color(0.0))), PLAIN]),
    "glass": (
        [of(Glass(ior=Constant(1.5)))],
        [of(Refraction(ior=Constant(1.5))), of(Glass(color(0.0), ior=Constant(1.5)))],
    ),
    "refraction": ([of(Refraction(ior=Constant(1.5)))], [of(Glass(ior=Constant(1.5)))]),
    "transparent surfaces": (
        [of(Transparent(color(0.5))), of(Diffuse(), Transparent(color(0.1))), UNKNOWN],
        [PLAIN, of(Transparent(color(0.0))), of(Glass())],
    ),
    "volumes": (
        [
            scene(cube(material=1), [diffuse(0.5), TINTED], CAMERA),
            replace(PLAIN, world=World(color(0.0), volume=Volume((0.1, 0.2, 0.3)))),
            scene([cube(), floor(2.0, -1.5, 1)], [BOUNDS, diffuse(0.5)], CAMERA),
        ],
        [PLAIN, scene(cube(), glass(1.5), CAMERA), scene(cube(), replace(TINTED, volume=Volume()), CAMERA)],
    ),
    "volume scattering": (
        [
            scene([cube(material=1), floor(2.0, -1.5)], [diffuse(0.5), SMOKE], CAMERA, (POINT,), bounces=1),
            replace(PLAIN, world=replace(SLOPED, volume=Volume(phases=(Phase((0.1, 0.2, 0.3)),)))),
        ],
        [PLAIN, scene([cube(), floor(2.0, -1.5, 1)], [BOUNDS, diffuse(0.5)], CAMERA)],
    ),
    "emission": (
        [of(Emission(color(1.0))), CROWDED_LAMP],
        [PLAIN, of(Emission(color(1.0), ZERO)), of(Emission(color(0.0)))],
    ),
    "image textures": (
        [
            with_uvs(of(Diffuse(TEXTURED))),
            with_uvs(scene(cube(), Material("m", (WeightedClosure(Diffuse(), TEXTURED),)), CAMERA)),
        ],
        [with_uvs(PLAIN)],
    ),
    "procedural textures": (
        [with_uvs(of(Diffuse(PATTERNED)))],
        [with_uvs(PLAIN), with_uvs(of(Diffuse(TEXTURED)))],
    ),
    "normal maps": (
        [with_uvs(of(Diffuse(color(0.5), normal=NormalMap(color(0.7), HALF))))],
        [with_uvs(PLAIN), with_uvs(of(Diffuse(color(0.5), normal=Bump(Component(Coordinates("UV"), 0), HALF, HALF))))],
    ),
    "bumps": (
        [with_uvs(of(Diffuse(color(0.5), normal=Bump(Component(Coordinates("UV"), 0), HALF, HALF))))],
        [with_uvs(PLAIN)],
    ),
    "bevels": (
        [of(Diffuse(color(0.5), normal=Bevel(HALF))), of(Glossy("GGX", roughness=HALF, normal=Bevel(Constant(0.1))))],
        [PLAIN, with_uvs(of(Diffuse(color(0.5), normal=Bump(Component(Coordinates("UV"), 0), HALF, HALF))))],
    ),
    "pixel widths": (
        [of(Diffuse(ValueToColor(Wireframe(Math("MULTIPLY", Constant(k), PixelWidth(), ZERO))))) for k in (1.0, 3.0)],
        [of(Diffuse(ValueToColor(Wireframe(HALF)))), PLAIN],
    ),
    "ambient occlusion": (
        [
            of(Diffuse(ValueToColor(AmbientOcclusion(Constant(9.0), inside=True)))),
            of(Glossy("GGX", ValueToColor(AmbientOcclusion(Constant(0.3), inside=True)), HALF)),
        ],
        [PLAIN, CROWDED],
    ),
    "mesh attributes": ([with_uvs(of(Diffuse(Attribute("paint"))))], [with_uvs(PLAIN)]),
    "point lights": (
        [replace(PLAIN, lights=(POINT,)), replace(PLAIN, lights=(SpotLight("s", (0, 0, 3.0), 0.0, (1.0,) * 3, CONE),))],
        [PLAIN, replace(PLAIN, lights=(SUN, SPHERE, AREA))],
    ),
    "sphere lights": (
        [
            replace(PLAIN, lights=(SPHERE,)),
            replace(PLAIN, lights=(SpotLight("s", (0, 0, 3.0), 0.2, (1.0,) * 3, CONE),)),
        ],
        [PLAIN, replace(PLAIN, lights=(SUN, POINT, AREA))],
    ),
    "sun lights": ([replace(PLAIN, lights=(SUN,))], [PLAIN, replace(PLAIN, lights=(POINT, AREA))]),
    "area lights": ([replace(PLAIN, lights=(AREA,))], [PLAIN, replace(PLAIN, lights=(SUN, POINT))]),
    "mesh lights": (
        [CROWDED_LAMP],
        [PLAIN, replace(PLAIN, lights=(AREA,)), of(Diffuse(), Emission()), scene(CROWD, LAMP_AND_MIRROR, CAMERA)],
    ),
    "constant world": ([replace(PLAIN, world=World(color(0.5)))], [PLAIN, replace(PLAIN, world=SLOPED)]),
    "environment world": (
        [
            replace(PLAIN, world=SLOPED),
            replace(PLAIN, world=World(EnvironmentTexture(Coordinates("GENERATED"), 0), (8, 4)), images=(IMAGE,)),
        ],
        [PLAIN, replace(PLAIN, world=World(color(0.5)))],
    ),
    "environment table": (
        [replace(PLAIN, world=SLOPED)],
        [replace(PLAIN, world=World(color(0.5))), replace(of(Glossy("GGX")), world=SLOPED)],
    ),
    "light sampling": (
        [replace(PLAIN, lights=(POINT,)), replace(PLAIN, world=SLOPED), CROWDED_LAMP],
        [PLAIN, replace(PLAIN, world=World(color(0.5))), replace(of(Glass(ior=HALF)), lights=(AREA,))],
    ),
    "light selection": (
        [replace(PLAIN, lights=(POINT, SUN)), replace(PLAIN, lights=(POINT,), world=SLOPED)],
        [
            PLAIN,
            replace(PLAIN, lights=(POINT,)),
            replace(PLAIN, lights=(POINT, DARK)),
            replace(PLAIN, lights=(POINT,), world=World(color(0.5))),
            replace(of(Diffuse(color(0.5)), Emission()), lights=(SUN,)),
        ],
    ),
    "multiple importance sampling": (
        [replace(PLAIN, lights=(AREA,)), replace(PLAIN, world=SLOPED), CROWDED_LAMP],
        [PLAIN, replace(PLAIN, lights=(POINT, SUN)), replace(PLAIN, world=World(color(0.5)))],
    ),
    "shadow rays": (
        [replace(CROWDED, lights=(POINT,)), replace(CROWDED, world=SLOPED), CROWDED_LAMP],
        [PLAIN, replace(CROWDED, world=World(color(0.5))), replace(PLAIN, lights=(AREA,)), FLAT],
    ),
    "shadows apart": (
        [
            hiding(replace(CROWDED, lights=(AREA,)), rays.SHADOW),
            hiding(replace(CROWDED, lights=(AREA,)), rays.DIFFUSE),
            scene(CROWD, [diffuse(0.5), OPAQUE_SHADOW], CAMERA, (AREA,)),
        ],
        [PLAIN, replace(CROWDED, lights=(AREA,)), HIDING],
    ),
    "lights without shadows": (
        [replace(CROWDED, lights=(SHADOWLESS, POINT))],
        [PLAIN, replace(CROWDED, lights=(AREA,)), replace(CROWDED, lights=(replace(DARK, casts_shadow=False),))],
    ),
    "light bounces": (
        [replace(CROWDED, lights=(NEAR_ONLY, POINT), transport=Transport(2))],
        [PLAIN, replace(CROWDED, lights=(NEAR_ONLY,)), replace(CROWDED, lights=(AREA,), transport=Transport(2))],
    ),
    "linked lights": (
        [
            linked(replace(CROWDED, lights=(ONE_LIT, POINT))),
            linked(CROWDED_LAMP, links=Links(receivers=2)),
        ],
        [PLAIN, replace(CROWDED, lights=(UNHIDDEN,)), linked(CROWDED, links=Links(receivers=1))],
    ),
    "linked shadows": (
        [linked(replace(CROWDED, lights=(UNHIDDEN, POINT))), linked(CROWDED_LAMP, links=Links(blockers=1))],
        [PLAIN, replace(CROWDED, lights=(ONE_LIT,)), linked(CROWDED, links=Links(blockers=1))],
    ),
    "scattered rays": (
        [
            replace(PLAIN, world=World(color(0.5))),
            replace(PLAIN, lights=(AREA,)),
            CROWDED_LAMP,
            replace(CROWDED, lights=(POINT,), transport=Transport(1)),
            UNKNOWN,
        ],
        [PLAIN, replace(PLAIN, lights=(POINT,), transport=Transport(4)), replace(CROWDED, lights=(SUN,)), LAMP],
    ),
    "last rays": (
        [replace(PLAIN, world=SLOPED), replace(CROWDED, lights=(SPHERE,)), CROWDED_LAMP],
        [PLAIN, replace(CROWDED, lights=(POINT,), transport=Transport(3)), LAMP],
    ),
    "last hits": (
        [replace(CROWDED, lights=(AREA,)), CROWDED_LAMP],
        [replace(CROWDED, world=SLOPED), replace(CROWDED, lights=(POINT,)), replace(PLAIN, lights=(AREA,))],
    ),
    "second hits": (
        [replace(CROWDED, world=SLOPED), replace(of(Glass(ior=Constant(1.5))), lights=(AREA,)), BOWL],
        [replace(PLAIN, world=SLOPED), replace(CROWDED, lights=(POINT,)), FLAT, replace(of(), world=SLOPED)],
    ),
    "indirect light": (
        [replace(CROWDED, world=SLOPED, transport=Transport(1)), INSIDE],
        [
            replace(CROWDED, world=SLOPED),
            replace(PLAIN, world=SLOPED, transport=Transport(3)),
            replace(CROWDED, transport=Transport(3)),
        ],
    ),
    "Russian roulette": (
        [replace(CROWDED, world=SLOPED, transport=Transport(4))],
        [
            replace(CROWDED, world=SLOPED, transport=Transport(1)),
            replace(PLAIN, world=SLOPED, transport=Transport(4)),
        ],
    ),
}
