# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan runs what a scene calls for: each effect with its cause, and without it."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.effects.catalogue import EFFECTS
from etalon.lib.effects.plan import make_plan
from etalon.lib.errors import EtalonError
from etalon.lib.scene.camera import Aperture
from etalon.lib.scene.converters import Component
from etalon.lib.scene.expressions import (
    ZERO,
    Attribute,
    Bump,
    Checker,
    Constant,
    Coordinates,
    EnvironmentTexture,
    ImageTexture,
    Math,
    NormalMap,
    ValueToColor,
    VectorToValue,
)
from etalon.lib.scene.images import Image
from etalon.lib.scene.lights import AreaLight, Cone, PointLight, SphereLight, SpotLight, SunLight
from etalon.lib.scene.materials import (
    Diffuse,
    Emission,
    Glass,
    Glossy,
    Lobe,
    Material,
    Metallic,
    Refraction,
    Specular,
    Translucent,
    Transparent,
)
from etalon.lib.scene.world import World
from etalon.lib.wavefront.options import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.scenes import color, cube, diffuse, floor, icosphere, material, orthographic, scene

CAMERA = orthographic(4, 4, 3.0, (0.1, 0.1, 5.0))
LENS = Aperture(0.1, 0, 0.0, 1.0, 5.0)
HALF = Constant(0.5)
POINT = PointLight("point", (0.0, 0.0, 3.0), (1.0, 1.0, 1.0))
SUN = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (1.0, 1.0, 1.0))
AREA = AreaLight("area", (0, 0, 3.0), (1.0, 0, 0), (0, -1.0, 0), (0, 0, -1.0), "RECTANGLE", (1.0, 1.0, 1.0), np.pi)
SPHERE = SphereLight("sphere", (0.0, 0.0, 3.0), 0.5, (1.0, 1.0, 1.0))
CONE = Cone((0, 0, -1.0), (1.0, 0, 0), (0, 1.0, 0), 0.7, 0.2)
IMAGE = Image("image", np.ones((2, 2, 4), np.float32), "LINEAR")
SLOPED = World(ValueToColor(VectorToValue(Coordinates("GENERATED"))), (8, 4))


def of(*closures, **more):
    return scene(cube(), material(*closures), CAMERA, **more)


def with_uvs(the_scene):
    count = the_scene.mesh.triangle_count
    mesh = replace(the_scene.mesh, uvs={"": np.zeros((3, 2, count), np.float32)})
    mesh = replace(mesh, attributes={"paint": np.ones((3, 6, count), np.float32)})
    mesh = replace(mesh, generated=np.zeros((3, mesh.vertices.shape[1]), np.float32))
    return replace(the_scene, mesh=mesh, images=(IMAGE,))


TEXTURED = ImageTexture(Coordinates("UV"), 0)
PATTERNED = Checker(Coordinates("UV"), color(0.2), color(0.8), HALF)
PLAIN = of(Diffuse(color(0.5)))
# Effect -> scenes that call for it, scenes that do not (the same without the cause, or with a cause that adds nothing).
CASES = {
    "depth of field": (
        [replace(PLAIN, camera=replace(CAMERA, aperture=LENS))],
        [PLAIN],
    ),
    "smooth normals": (
        [scene(icosphere(smooth=True), diffuse(0.5), CAMERA)],
        [scene(icosphere(), diffuse(0.5), CAMERA)],
    ),
    "Lambert": ([PLAIN], [of(Diffuse(color(0.5), HALF)), of(Diffuse(color(0.0))), of(Glossy())]),
    "Oren-Nayar": ([of(Diffuse(color(0.5), HALF))], [PLAIN, of(Diffuse(color(0.0), HALF))]),
    "Beckmann": ([of(Glossy("BECKMANN", roughness=HALF))], [of(Glossy("GGX", roughness=HALF)), PLAIN]),
    "GGX": (
        [of(Glossy("GGX", roughness=HALF)), of(Glossy("MULTI_GGX", roughness=HALF))],
        [of(Glossy("BECKMANN", roughness=HALF)), of(Glossy("GGX", color(0.0), HALF)), PLAIN],
    ),
    "multiple scattering": ([of(Glossy("MULTI_GGX", roughness=HALF))], [of(Glossy("GGX", roughness=HALF))]),
    "anisotropy": (
        [of(Glossy("GGX", roughness=HALF, anisotropy=HALF))],
        [of(Glossy("GGX", roughness=HALF)), of(Glossy("GGX", roughness=HALF, anisotropy=Constant(1e-5)))],
    ),
    "Ashikhmin-Shirley": (
        [of(Glossy("ASHIKHMIN_SHIRLEY", roughness=HALF))],
        [of(Glossy("GGX", roughness=HALF))],
    ),
    "metals": ([of(Metallic("GGX", roughness=HALF))], [of(Glossy("GGX", roughness=HALF))]),
    "glossy layers": ([of(Specular("GGX", Constant(1.5)))], [of(Metallic("GGX", roughness=HALF))]),
    "rough interfaces": (
        [of(Glass(ior=Constant(1.5), roughness=HALF)), of(Refraction(ior=Constant(1.5), roughness=HALF))],
        [of(Glass(ior=Constant(1.5)))],
    ),
    "translucency": ([of(Translucent())], [of(Translucent(color(0.0))), PLAIN]),
    "glass": (
        [of(Glass(ior=Constant(1.5)))],
        [of(Refraction(ior=Constant(1.5))), of(Glass(color(0.0), ior=Constant(1.5)))],
    ),
    "refraction": ([of(Refraction(ior=Constant(1.5)))], [of(Glass(ior=Constant(1.5)))]),
    "transparent surfaces": (
        [of(Transparent(color(0.5))), of(Diffuse(), Transparent(color(0.1)))],
        [PLAIN, of(Transparent(color(0.0))), of(Glass())],
    ),
    "emission": ([of(Emission(color(1.0)))], [PLAIN, of(Emission(color(1.0), ZERO)), of(Emission(color(0.0)))]),
    "image textures": (
        [with_uvs(of(Diffuse(TEXTURED))), with_uvs(scene(cube(), Material("m", (Lobe(Diffuse(), TEXTURED),)), CAMERA))],
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
    "mesh lights": ([of(Emission(color(1.0)))], [PLAIN, replace(PLAIN, lights=(AREA,))]),
    "constant world": ([replace(PLAIN, world=World(color(0.5)))], [PLAIN, replace(PLAIN, world=SLOPED)]),
    "environment world": (
        [
            replace(PLAIN, world=SLOPED),
            replace(PLAIN, world=World(EnvironmentTexture(Coordinates("GENERATED"), 0), (8, 4)), images=(IMAGE,)),
        ],
        [PLAIN, replace(PLAIN, world=World(color(0.5)))],
    ),
    "shadow rays": (
        [replace(PLAIN, lights=(POINT,)), replace(PLAIN, world=SLOPED), of(Diffuse(), Emission())],
        [PLAIN, replace(PLAIN, world=World(color(0.5)))],
    ),
    "light selection": (
        [
            replace(PLAIN, lights=(POINT, SUN)),
            replace(PLAIN, lights=(POINT,), world=SLOPED),
            replace(of(Emission()), lights=(SUN,)),
        ],
        [PLAIN, replace(PLAIN, lights=(POINT,)), replace(PLAIN, lights=(POINT,), world=World(color(0.5)))],
    ),
    "indirect light": (
        [replace(PLAIN, transport=replace(PLAIN.transport, max_bounces=1))],
        [replace(PLAIN, transport=replace(PLAIN.transport, max_bounces=0))],
    ),
}


@pytest.mark.parametrize("effect", [effect.name for effect in EFFECTS])
def test_cause_and_effect(effect):
    assert effect in CASES, f"the effect '{effect}' has no scenes here that call for it and that do not"
    for the_scene in CASES[effect][0]:
        assert make_plan(the_scene).needs(effect)
    for the_scene in CASES[effect][1]:
        assert not make_plan(the_scene).needs(effect)


@pytest.mark.parametrize("effect", [effect.name for effect in EFFECTS])
def test_every_decision_gives_its_reason(effect):
    """One line each, whether needed or not, and another one when the answer is another."""
    facts = {True: set(), False: set()}
    for answer, scenes in zip((True, False), CASES[effect], strict=True):
        for the_scene in scenes:
            (decision,) = [d for d in make_plan(the_scene).decisions if d.effect == effect]
            assert decision.needed == answer
            assert decision.fact
            assert "\n" not in decision.fact
            facts[answer].add(decision.fact)
    assert not facts[True] & facts[False]


def test_names_are_unique_and_known():
    names = [effect.name for effect in EFFECTS]
    assert len(set(names)) == len(names)
    assert all(effect.group and effect.stage for effect in EFFECTS)
    with pytest.raises(EtalonError, match="no effect is called 'caustics'"):
        make_plan(PLAIN).needs("caustics")


def test_the_material_that_calls_for_it_is_named():
    the_scene = scene(
        [cube(), floor(2.0, -1.0, 1)],
        [material(Emission(), name="Lamp <1>"), material(Diffuse(), name="Floor")],
        CAMERA,
    )
    facts = {d.effect: d.fact for d in make_plan(the_scene).decisions}
    assert "'Lamp <1>'" in facts["emission"]
    assert "'Floor'" not in facts["emission"]
    assert "'Floor'" in facts["Lambert"]


def test_a_material_that_no_face_has_calls_for_nothing():
    unseen = scene(cube(), [diffuse(0.5), material(Emission(), Glass(), Transparent())], CAMERA)
    plan = make_plan(unseen)
    assert not any(plan.needs(effect) for effect in ("emission", "mesh lights", "glass", "transparent surfaces"))


def test_a_constant_behind_nodes_is_still_a_constant():
    """Folding: 0.5 * 0 is no roughness, and a world of constants is a constant world."""
    nothing = Math("MULTIPLY", HALF, ZERO, ZERO)
    assert make_plan(of(Diffuse(color(0.5), nothing))).needs("Lambert")
    world = World(ValueToColor(Math("ADD", HALF, HALF, ZERO)))
    assert make_plan(replace(PLAIN, world=world)).needs("constant world")


def test_what_is_not_called_for_is_not_run(seed):
    """The stage clock knows no stage that the plan leaves out, and no shadow ray is traced where none is asked for."""
    sky_only = replace(PLAIN, world=World(color(0.5)))
    rendering = ReferenceRenderer(sky_only, Options(seed=seed, threads=1)).render(0, 4)
    assert "shadow rays" not in rendering.stages
    assert "pass through" not in rendering.stages
    lit = replace(sky_only, lights=(POINT,))
    assert "shadow rays" in ReferenceRenderer(lit, Options(seed=seed, threads=1)).render(0, 4).stages
    veiled = of(Diffuse(color(0.5)), Transparent(color(0.5)), world=0.5)
    assert "pass through" in ReferenceRenderer(veiled, Options(seed=seed, threads=1)).render(0, 4).stages
