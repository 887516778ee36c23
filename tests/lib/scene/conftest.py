# SPDX-License-Identifier: GPL-3.0-or-later
"""A small scene with one of everything, for the tests of its rules and its archive."""

import math

import numpy as np
import pytest
from etalon.lib.scene import expressions as ex
from etalon.lib.scene import lights, materials, rays
from etalon.lib.scene.camera import Aperture, Camera
from etalon.lib.scene.images import Image
from etalon.lib.scene.mesh import Mesh, Object
from etalon.lib.scene.scene import Scene, Transport
from etalon.lib.scene.world import World

POSITION = (0.0, 0.0, 3.0)
WHITE = (1.0, 1.0, 1.0)
DOWN = (0.0, 0.0, -1.0)


@pytest.fixture
def scene(rng):
    count = 40
    image = ex.ImageTexture(ex.Coordinates("UV"), 0)
    shared = ex.Math("ADD", ex.ColorToValue(image), ex.Constant(0.25), ex.ZERO)
    surface = materials.Material(
        "Oberfläche",
        (
            materials.WeightedClosure(materials.Glossy("GGX", image, shared, shared), shared),
            materials.WeightedClosure(materials.Diffuse(ex.Coordinates("GENERATED"))),
        ),
    )
    cone = lights.Cone(DOWN, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.5, 0.15)
    normals = rng.normal(size=(3, 3, count)).astype(np.float32)
    return Scene(
        name="everything",
        mesh=Mesh(
            vertices=rng.normal(size=(3, 3 * count)),
            triangles=np.arange(3 * count, dtype=np.int32).reshape(3, count),
            material_index=np.zeros(count, np.int32),
            object_index=np.arange(count, dtype=np.int32) % 2,
            smooth=np.arange(count) % 3 == 0,
            corner_normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
            objects=(Object("first", np.eye(3, 4)), Object("second", 2.0 * np.eye(3, 4))),
            uvs={"": rng.uniform(size=(3, 2, count)).astype(np.float32)},
            generated=rng.uniform(size=(3, 3 * count)).astype(np.float32),
        ),
        materials=(surface, materials.Material("glow", (materials.WeightedClosure(materials.Emission()),))),
        lights=(
            lights.PointLight("point", POSITION, WHITE),
            lights.SphereLight("sphere", POSITION, 0.5, WHITE, rays=rays.SEEN),
            lights.SpotLight("spot", POSITION, 0.0, WHITE, cone),
            lights.SunLight("sun", (0.0, 0.0, 1.0), 0.01, WHITE),
            lights.AreaLight("area", POSITION, (1.0, 0.0, 0.0), (0.0, 2.0, 0.0), DOWN, "RECTANGLE", WHITE, math.pi),
        ),
        world=World(ex.EnvironmentTexture(ex.Coordinates("GENERATED"), 1), (64, 32)),
        camera=Camera(
            "PERSPECTIVE",
            32,
            24,
            np.array([[0.1, 0, -1.6], [0, 0.1, -1.2]]),
            np.eye(3, 4),
            0.1,
            1e3,
            Aperture(0.1, 5, 0.2, 1.0, 4.0),
        ),
        transport=Transport(3, 8),
        images=(
            Image("a", rng.uniform(size=(4, 6, 4)).astype(np.float32), "SRGB"),
            Image("b", rng.uniform(size=(2, 2, 4)).astype(np.float32), "LINEAR"),
        ),
    )
