# SPDX-License-Identifier: GPL-3.0-or-later
"""Worlds: what Cycles shows in every direction, closed forms, and refusals."""

import bpy
import numpy as np
import pytest
from etalon.addon.export.materials import read_world
from etalon.addon.export.nodes.images import ImageTable
from etalon.lib.scene import expressions as ex
from etalon.lib.textures.evaluate import Evaluator
from etalon.lib.textures.images import ImageSet
from etalon.tests.addon.export.nodes.node_cases import mix_colors
from etalon.tests.addon.export.nodes.node_cells import Points, assert_same, node, prepare, rendered, stored_image


@pytest.mark.parametrize("kind", ["plain", "mirror ball", "mixed", "emission", "image at one point"])
def test_world_radiance_is_cycles_radiance(tmp_path, rng, kind):
    scene = prepare("PERSP", 48, 24)
    scene.camera.data.lens = 12
    scene.camera.rotation_euler = rng.uniform(0, 6, 3)
    world = scene.world = bpy.data.worlds.new("world")
    world.cycles.sampling_method = "NONE"  # nothing is lit; the table to sample it takes seconds
    if bpy.app.version < (5, 0):
        world.use_nodes = True
    tree = world.node_tree
    image = stored_image(tmp_path, "sky", "exr", "Linear Rec.709", "PREMUL", True, rng)()
    tree.nodes.clear()
    out = tree.nodes.new("ShaderNodeOutputWorld")

    half = mix_colors(tree, 1.0, node(tree, "TexCoord", output="Generated"), (1, 1, 1, 1), "ADD")
    tree.links.new(node(tree, "Background", {"Color": half}), out.inputs[0])
    direction = rendered(scene, tmp_path).reshape(3, -1) - 1

    sky = node(tree, "TexEnvironment", image=image)
    if kind == "mirror ball":
        sky.node.projection = "MIRROR_BALL"
    if kind in ("plain", "mirror ball"):
        surface = node(tree, "Background", {"Color": sky, "Strength": 1.7})
    elif kind == "image at one point":
        surface = node(tree, "Background", {"Color": node(tree, "TexImage", image=image)})
    else:
        inputs = {"Vector": node(tree, "TexCoord", output="Object"), "Rotation": (0.3, 0.2, 0.8), "Scale": (1, 2, 1)}
        tree.links.new(node(tree, "Mapping", inputs), sky.node.inputs[0])
        glow = node(tree, "Emission" if kind == "emission" else "Background", {"Color": sky})
        flat = node(tree, "Background", {"Color": (0.2, 0.4, 0.1, 1), "Strength": 0.6})
        surface = node(
            tree, "AddShader", {"Shader": node(tree, "MixShader", {"Fac": 0.3, "Shader": glow}), "Shader_001": flat}
        )
    tree.links.new(surface, out.inputs[0])
    shown = rendered(scene, tmp_path).reshape(3, -1)

    images, refusals = ImageTable(), []
    read = read_world(world, images, refusals)
    assert not refusals
    got = Evaluator(Points({"GENERATED": direction}), ImageSet(images.images))(read.radiance)
    assert_same(got, shown, 5e-5)


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND"])
def test_an_image_texture_without_coordinates_shows_its_corner(world, extension, rng):
    image = bpy.data.images.new("map", 3, 2, float_buffer=True)
    texels = np.ones((2, 3, 4), np.float32)
    texels[..., :3] = rng.random((2, 3, 3))
    image.pixels.foreach_set(texels.ravel())
    connect(world, node(world.node_tree, "Background", {"Color": image_node(world, image, extension)}))
    images, refusals = ImageTable(), []
    read = read_world(world, images, refusals)
    assert not refusals
    directions = Points({"GENERATED": rng.normal(size=(3, 4))})
    got = Evaluator(directions, ImageSet(images.images))(read.radiance)
    ends = texels[..., :3][[0, -1]][:, [0, -1]].mean((0, 1)) if extension == "REPEAT" else texels[0, 0, :3]
    np.testing.assert_allclose(got, np.broadcast_to(ends[:, None], got.shape), rtol=1e-6)


def image_node(world, image, extension):
    return node(world.node_tree, "TexImage", image=image, extension=extension)


@pytest.fixture
def world():
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    made = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0):
        made.use_nodes = True
    made.node_tree.nodes.clear()
    made.node_tree.nodes.new("ShaderNodeOutputWorld")
    return made


def connect(world, socket, name="Surface"):
    (out,) = (n for n in world.node_tree.nodes if n.bl_idname == "ShaderNodeOutputWorld")
    world.node_tree.links.new(socket, out.inputs[name])


def read(world):
    refusals = []
    return read_world(world, ImageTable(), refusals), [str(refusal) for refusal in refusals]


def test_no_world_and_an_empty_one_are_black(world):
    assert read_world(None, ImageTable(), []).radiance == ex.BLACK
    assert read(world)[0].radiance == ex.BLACK


def test_a_plain_world_is_one_constant(world):
    connect(world, node(world.node_tree, "Background", {"Color": (0.5, 0.25, 1.0, 1.0), "Strength": 4.0}))
    got, refusals = read(world)
    assert got.radiance == ex.Constant((2.0, 1.0, 4.0))
    assert refusals == []


def test_the_sampling_table_has_the_size_of_the_image_within_bounds(world):
    sky = bpy.data.images.new("sky", 5000, 400, float_buffer=True)
    connect(world, node(world.node_tree, "Background", {"Color": node(world.node_tree, "TexEnvironment", image=sky)}))
    assert read(world)[0].table_resolution == (4096, 400)


@pytest.mark.parametrize(
    ("build", "named"),
    [
        (lambda t: node(t, "BsdfDiffuse"), "Diffuse BSDF) on a world"),
        (lambda t: node(t, "Background", {"Color": node(t, "TexGabor")}), "Gabor Texture"),
        (lambda t: node(t, "Background", {"Color": node(t, "TexCoord", output="Camera")}), "output 'Camera'"),
        (lambda t: node(t, "Background", {"Strength": node(t, "LayerWeight")}), "Layer Weight) in a world"),
    ],
)
def test_what_is_not_simulated_is_refused_by_name(world, build, named):
    connect(world, build(world.node_tree))
    (refusal,) = read(world)[1]
    assert refusal.startswith("world 'World': ")
    assert named in refusal


def test_a_surface_in_its_volume_is_refused(world):
    connect(world, node(world.node_tree, "BsdfDiffuse"), "Volume")
    (refusal,) = read(world)[1]
    assert "Diffuse BSDF) in a volume" in refusal
