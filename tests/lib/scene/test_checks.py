# SPDX-License-Identifier: GPL-3.0-or-later
"""A sound scene passes; each broken rule is one line that names its owner."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import SceneError
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.checks import validate
from etalon.lib.scene.lights import Falloff
from etalon.lib.scene.materials import Diffuse, Material, WeightedClosure


def with_mesh(scene, **changes):
    return replace(scene, mesh=replace(scene.mesh, **changes))


def with_camera(scene, **changes):
    return replace(scene, camera=replace(scene.camera, **changes))


def with_lens(scene, **changes):
    return with_camera(scene, aperture=replace(scene.camera.aperture, **changes))


def with_light(scene, index, **changes):
    lights = list(scene.lights)
    lights[index] = replace(lights[index], **changes)
    return replace(scene, lights=tuple(lights))


def with_cone(scene, **changes):
    return with_light(scene, 2, cone=replace(scene.lights[2].cone, **changes))


def with_color(scene, color):
    return replace(scene, materials=(Material("paint", (WeightedClosure(Diffuse(color)),)), scene.materials[1]))


def with_image(scene, **changes):
    return replace(scene, images=(replace(scene.images[0], **changes), scene.images[1]))


def altered(array, at, value):
    array = array.copy()
    array[at] = value
    return array


def test_a_sound_scene_passes(scene):
    validate(scene)
    bare = with_mesh(scene, corner_normals=np.zeros((3, 3, 0), np.float32), smooth=np.zeros(40, bool))
    validate(with_camera(bare, aperture=None))


BROKEN = {
    "light 'point': its falloff is not known": lambda s: with_light(s, 0, falloff=Falloff(3)),
    "light 'area': its falloff is not known": lambda s: with_light(s, 4, falloff=Falloff(1, -1.0)),
    "light 'sun': a sun is at no distance": lambda s: with_light(s, 3, falloff=Falloff(1)),
    "object 'second': 1 coordinate of vertices not finite": lambda s: with_mesh(
        s, vertices=altered(s.mesh.vertices, (1, 1), np.nan)
    ),
    "object 'second': 1 coordinate of vertices not finite or beyond 1e+18": lambda s: with_mesh(
        s, vertices=altered(s.mesh.vertices, (1, 1), -1.1e18)
    ),
    "mesh: vertices has shape": lambda s: with_mesh(s, vertices=s.mesh.vertices[:2]),
    "mesh: triangles leaves 0..119": lambda s: with_mesh(s, triangles=altered(s.mesh.triangles, (0, 0), 120)),
    "mesh: triangles is of type float64": lambda s: with_mesh(s, triangles=s.mesh.triangles.astype(float)),
    "mesh: material_index leaves 0..1": lambda s: with_mesh(s, material_index=s.mesh.material_index - 1),
    "mesh: object_index leaves 0..1": lambda s: with_mesh(s, object_index=s.mesh.object_index + 1),
    "mesh: smooth has shape": lambda s: with_mesh(s, smooth=s.mesh.smooth[1:]),
    "mesh: corner_normals has shape": lambda s: with_mesh(s, corner_normals=s.mesh.corner_normals[..., :0]),
    "object 'second': a corner normal has no length": lambda s: with_mesh(
        s, corner_normals=altered(s.mesh.corner_normals, (0, slice(None), 1), 0.0)
    ),
    "mesh: UV map '' has shape": lambda s: with_mesh(s, uvs={"": s.mesh.uvs[""][:, :1]}),
    "mesh: generated is not finite": lambda s: with_mesh(s, generated=altered(s.mesh.generated, (0, 0), np.inf)),
    "object 'first': its transform has shape": lambda s: with_mesh(
        s, objects=(replace(s.mesh.objects[0], world_from_object=np.eye(3)), s.mesh.objects[1])
    ),
    "material 'Oberfläche': UV map '' is missing": lambda s: with_mesh(s, uvs={}),
    "material 'Oberfläche': generated coordinates are missing": lambda s: with_mesh(
        s, generated=np.zeros((3, 0), np.float32)
    ),
    "material 'paint': the places of vertices before displacement are missing": lambda s: with_color(
        s, ex.Undisplaced(ex.Coordinates("NORMAL"))
    ),
    "material 'paint': image 2 is not in the scene": lambda s: with_color(
        s, ex.ImageTexture(ex.Coordinates("NORMAL"), 2)
    ),
    "material 'paint': a constant is not finite": lambda s: with_color(s, ex.Constant((0.0, np.nan, 0.0))),
    "world: image 1 is not in the scene": lambda s: replace(s, images=s.images[:1]),
    "world: its sampling table is empty": lambda s: replace(s, world=replace(s.world, table_resolution=(0, 4))),
    "image 'a': its encoding is 'GAMMA'": lambda s: with_image(s, encoding="GAMMA"),
    "image 'a': its pixels have shape": lambda s: with_image(s, pixels=np.zeros((2, 2, 3), np.float32)),
    "image 'a': it has no pixels": lambda s: with_image(s, pixels=np.zeros((0, 2, 4), np.float32)),
    "camera: its kind is 'PANORAMIC'": lambda s: with_camera(s, kind="PANORAMIC"),
    "camera: its image has no pixels": lambda s: with_camera(s, width=0),
    "camera: its raster has no extent": lambda s: with_camera(s, plane_from_raster=np.zeros((2, 3))),
    "camera: its axes are not": lambda s: with_camera(s, world_from_camera=2.0 * np.eye(3, 4)),
    "camera: its clip planes enclose nothing": lambda s: with_camera(s, clip_end=0.1),
    "camera: its lens has no extent": lambda s: with_lens(s, radius=0.0),
    "camera: its lens has 2 blades": lambda s: with_lens(s, blades=2),
    "camera: its lens is not finite": lambda s: with_lens(s, rotation=np.nan),
    "camera: its focus is not in front of it": lambda s: with_lens(s, focus_distance=0.0),
    "light 'point': is not finite": lambda s: with_light(s, 0, position=(0.0, np.inf, 0.0)),
    "light 'point': its intensity is negative": lambda s: with_light(s, 0, intensity=(1.0, -1.0, 1.0)),
    "light 'sphere': its radius is not positive": lambda s: with_light(s, 1, radius=0.0),
    "light 'spot': its radius is negative": lambda s: with_light(s, 2, radius=-1.0),
    "light 'spot': its blend leaves 0..1": lambda s: with_cone(s, blend=2.0),
    "light 'spot': its cone leaves 0..180 degrees": lambda s: with_cone(s, cos_half_angle=1.0),
    "light 'sun': its angle leaves 0..180 degrees": lambda s: with_light(s, 3, half_angle=2.0),
    "light 'sun': its direction is not of unit length": lambda s: with_light(s, 3, direction=(0.0, 0.0, 2.0)),
    "light 'area': has no area": lambda s: with_light(s, 4, edge_u=(0.0, 1.0, 0.0)),
    "light 'area': its shape is 'SQUARE'": lambda s: with_light(s, 4, shape="SQUARE"),
    "light 'area': its spread leaves 0..180 degrees": lambda s: with_light(s, 4, spread=0.0),
    "everything: its number of bounces is negative": lambda s: replace(
        s, transport=replace(s.transport, max_bounces=-1)
    ),
    "everything: its number of transparent bounces is negative": lambda s: replace(
        s, transport=replace(s.transport, transparent_max_bounces=-1)
    ),
}


@pytest.mark.parametrize("defect", BROKEN)
def test_a_broken_rule_is_named(scene, defect):
    with pytest.raises(SceneError) as caught:
        validate(BROKEN[defect](scene))
    assert str(caught.value).startswith(defect)
    assert "\n" not in str(caught.value)


def test_a_scene_without_triangles_is_no_broken_one(scene):
    empty = with_mesh(
        scene,
        vertices=np.zeros((3, 0)),
        triangles=np.zeros((3, 0), np.int32),
        material_index=np.zeros(0, np.int32),
        object_index=np.zeros(0, np.int32),
        smooth=np.zeros(0, bool),
        corner_normals=np.zeros((3, 3, 0), np.float32),
        uvs={"": np.zeros((3, 2, 0), np.float32)},
        generated=np.zeros((3, 0), np.float32),
        objects=(),
    )
    validate(empty)
