# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights, materials and small scenes, of which effect_cases.py makes its scenes."""

from dataclasses import replace

import numpy as np
from etalon.lib.scene import rays
from etalon.lib.scene.camera import Aperture
from etalon.lib.scene.expressions import (
    ZERO,
    Checker,
    Constant,
    Coordinates,
    ImageTexture,
    Math,
    ValueToColor,
    VectorToValue,
)
from etalon.lib.scene.images import Image
from etalon.lib.scene.lights import AreaLight, Cone, PointLight, SphereLight, SunLight
from etalon.lib.scene.links import Links
from etalon.lib.scene.materials import (
    Diffuse,
    Emission,
    Glossy,
    Material,
    Transparent,
)
from etalon.lib.scene.volumes import Phase, Volume
from etalon.lib.scene.world import World
from etalon.tests.scenes import (
    color,
    cube,
    diffuse,
    emission,
    floor,
    glass,
    material,
    orthographic,
    perspective,
    quad,
    scene,
)

CAMERA = orthographic(4, 4, 3.0, (0.1, 0.1, 5.0))
LEFT_TO_RIGHT = np.repeat(CAMERA.world_from_camera[None], 2, axis=0)
LEFT_TO_RIGHT[:, 0, 3] += -0.5, 0.5
RISING = np.array([np.column_stack([np.eye(3), (0.0, 0.0, z)]) for z in (-0.2, 0.2)])
LENS = Aperture(0.1, 0, 0.0, 1.0, 5.0)
HALF = Constant(0.5)
POINT = PointLight("point", (0.0, 0.0, 3.0), (1.0, 1.0, 1.0))
DARK = PointLight("dark", (1.0, 0.0, 3.0), (0.0, 0.0, 0.0))
SUN = SunLight("sun", (0.0, 0.0, 1.0), 0.0, (1.0, 1.0, 1.0))
AREA = AreaLight("area", (0, 0, 3.0), (1.0, 0, 0), (0, -1.0, 0), (0, 0, -1.0), "RECTANGLE", (1.0, 1.0, 1.0), np.pi)
SPHERE = SphereLight("sphere", (0.0, 0.0, 3.0), 0.5, (1.0, 1.0, 1.0))
CONE = Cone((0, 0, -1.0), (1.0, 0, 0), (0, 1.0, 0), 0.7, 0.2)
IMAGE = Image("image", np.ones((2, 2, 4), np.float32), "LINEAR")
AROUND = World(ValueToColor(Math("ADD", VectorToValue(Coordinates("GENERATED")), HALF, ZERO)), (8, 4))
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
# More than one body: light that leaves a face may meet another.
CROWD = [cube(), cube(0.3, (0.2, 0.3, 1.7), 1)]
CROWDED = scene(CROWD, [diffuse(0.5), diffuse(0.8)], CAMERA)
UNKNOWN = scene(CROWD, [diffuse(0.5), Material("?", (), "a node")], CAMERA)


def hiding(the_scene, without):
    """The scene with its second object hidden from some rays."""
    first, second = the_scene.mesh.objects
    return replace(
        the_scene, mesh=replace(the_scene.mesh, objects=(first, replace(second, rays=rays.EVERY & ~without)))
    )


def catching(the_scene):
    """The scene with its second object a shadow catcher."""
    first, second = the_scene.mesh.objects
    return replace(the_scene, mesh=replace(the_scene.mesh, objects=(first, replace(second, catches_shadows=True))))


def linked(the_scene, **facts):
    """The scene with those facts of its second object, which is alone in its sets."""
    first, second = the_scene.mesh.objects
    second = replace(second, receiver=1, blocker=1, **facts)
    return replace(the_scene, mesh=replace(the_scene.mesh, objects=(first, second)))


ONE_LIT, UNHIDDEN = replace(AREA, links=Links(receivers=1)), replace(AREA, links=Links(blockers=1))
HIDING = hiding(CROWDED, rays.CAMERA)
SHADOWLESS = replace(AREA, casts_shadow=False)
NEAR_ONLY = replace(AREA, max_bounces=0)
UNREFLECTED = replace(AREA, rays=rays.DIFFUSE)
OPAQUE_SHADOW = replace(material(Transparent(color(0.8))), transparent_shadows=False)
TINTED = replace(glass(1.5), volume=Volume((0.2, 0.5, 0.9)))
SMOKE = Material("smoke", (), volume=Volume((0.2, 0.1, 0.0), (Phase((0.5, 0.7, 0.9), 0.4),)), only_bounds=True)
BOUNDS = Material("bounds", (), volume=Volume((0.2, 0.5, 0.9)), only_bounds=True)
COATED = [material(Diffuse(color(0.5)), Glossy("GGX", color(0.3), HALF)), diffuse(0.8)]
LAMP = of(Emission(color(1.0)))
CROWDED_LAMP = scene(CROWD, [diffuse(0.5), emission(1.0)], CAMERA)
LAMP_AND_MIRROR = [emission(1.0), material(Glossy("GGX"))]
FLAT = scene(
    [floor(1.0), quad((1.2, -1.0, 0.0), (0.5, 0.0, 0.0), (0.0, 2.0, 0.0))],
    diffuse(0.5),
    CAMERA,
    (AREA, POINT),
    bounces=2,
)
BOWL = scene(
    [floor(0.5, -0.5), quad((0.5, -0.5, -0.5), (0.5, 0.0, 0.5), (0.0, 1.0, 0.0))], diffuse(0.7), CAMERA, (AREA,), 0.5
)
INSIDE = scene(cube(3.0), diffuse(0.8), perspective(4, 4, 1.0, (0.1, 0.2, 0.3)), (POINT,), bounces=2)
