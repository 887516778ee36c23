# SPDX-License-Identifier: GPL-3.0-or-later
"""Ambient Occlusion nodes: what is read, and the image beside Cycles'."""

from dataclasses import replace

import bpy
import pytest
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.materials import WeightedClosure
from etalon.lib.textures.fold import inputs, walk
from etalon.tests.addon.export.nodes.node_cells import glowing, node, prepare, quad, rendered, through_emission
from etalon.tests.addon.export.test_ray_visibility import stage
from etalon.tests.addon.export.test_visibility import FEW_SAMPLES, apart, shader, square
from mathutils import Matrix


def occlude(name, color, output="Color", **properties):
    """Give the diffuse colour of a material to an Ambient Occlusion node; return that."""
    tree = bpy.data.materials[name].node_tree
    node = tree.nodes.new("ShaderNodeAmbientOcclusion")
    node.inputs["Color"].default_value = (*color, 1.0)
    for key, value in properties.items():
        setattr(node, key, value)
    tree.links.new(node.outputs[output], tree.nodes["Diffuse BSDF"].inputs["Color"])
    return node


def as_it_comes(_):
    occlude("grey", (0.9, 0.6, 0.3)).inputs["Distance"].default_value = 2.0


def near(_):
    """A shorter distance, by AO, and one that a texture makes, of 0 to 3."""
    occlude("red", (1.0, 1.0, 1.0), "AO").inputs["Distance"].default_value = 1.5
    tree = bpy.data.materials["grey"].node_tree
    node, checker = occlude("grey", (0.9, 0.6, 0.3)), tree.nodes.new("ShaderNodeTexChecker")
    checker.inputs["Scale"].default_value = 2.0
    times = tree.nodes.new("ShaderNodeMath")
    times.operation, times.inputs[1].default_value = "MULTIPLY", 3.0
    tree.links.new(checker.outputs["Fac"], times.inputs[0])
    tree.links.new(times.outputs[0], node.inputs["Distance"])


def inside(studio):
    """Below the floor there is a smaller one."""
    occlude("grey", (0.9, 0.6, 0.3), inside=True).inputs["Distance"].default_value = 3.0
    square(studio, "below", bpy.data.materials["red"], 2.0, Matrix.Translation((0.5, -1.0, -0.7)))


def turned(_):
    """About a normal that leans to the wall."""
    tree = bpy.data.materials["grey"].node_tree
    node, normal = occlude("grey", (0.9, 0.6, 0.3)), tree.nodes.new("ShaderNodeCombineXYZ")
    normal.inputs["Y"].default_value, normal.inputs["Z"].default_value = 0.8, 1.5
    node.inputs["Distance"].default_value = 6.0
    tree.links.new(normal.outputs[0], node.inputs["Normal"])


def mixed(_):
    """Two shaders, mixed by the occlusion, on the floor."""
    tree = bpy.data.materials["grey"].node_tree
    node, mix = tree.nodes.new("ShaderNodeAmbientOcclusion"), tree.nodes.new("ShaderNodeMixShader")
    node.inputs["Distance"].default_value = 4.0
    gloss = tree.nodes.new("ShaderNodeBsdfGlossy")
    gloss.inputs["Roughness"].default_value = 0.5
    tree.links.new(node.outputs["AO"], mix.inputs[0])
    tree.links.new(gloss.outputs[0], mix.inputs[1])
    tree.links.new(tree.nodes["Diffuse BSDF"].outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


def beside(change):
    """With a transparent card, and one that casts no shadow."""

    def both(studio):
        clear = shader("clear", "BsdfTransparent", Color=(0.9, 0.9, 0.9, 1))
        square(studio, "clear", clear, 1.0, Matrix.Translation((1.2, -2.0, 0.4)))
        faint = square(studio, "faint", bpy.data.materials["red"], 1.0, Matrix.Translation((-2.6, -2.0, 0.4)))
        faint.visible_shadow = False
        change(studio)

    return both


def own(studio):
    """A box whose inside counts, and the floor, whose own faces are all."""
    occlude("grey", (0.9, 0.6, 0.3), only_local=True).inputs["Distance"].default_value = 5.0
    bowl = bpy.data.meshes.new("bowl")
    corners = [(x, y, z) for z in (0.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)]
    bowl.from_pydata(corners, [], [(0, 1, 3, 2), (0, 4, 5, 1), (1, 5, 7, 3), (3, 7, 6, 2), (2, 6, 4, 0)])
    bowl.materials.append(bpy.data.materials["grey"])
    studio.add("bowl", bowl, Matrix.Translation((0.5, -2.5, 0.3)))


def blind(scene):
    """The scene with nothing that occludes: the Ambient Occlusion of all materials is 1."""

    def one(node):
        if isinstance(node, ex.AmbientOcclusion):
            return ex.ONE
        return replace(node, **{name: one(part) for name, part in inputs(node).items()})

    def lobe(lobe):
        sockets = {name: one(part) for name, part in vars(lobe.closure).items() if isinstance(part, ex.Expression)}
        return WeightedClosure(replace(lobe.closure, **sockets), one(lobe.weight))

    return replace(scene, materials=tuple(replace(m, lobes=tuple(map(lobe, m.lobes))) for m in scene.materials))


def round_and_principled(studio):
    """A smooth ball on the floor, of few faces, and a floor with a Principled BSDF; rays go below the ball's faces."""
    tree = bpy.data.materials["grey"].node_tree
    node, whole = occlude("grey", (0.9, 0.6, 0.3)), tree.nodes.new("ShaderNodeBsdfPrincipled")
    node.inputs["Distance"].default_value = 2.0
    tree.links.new(node.outputs["Color"], whole.inputs["Base Color"])
    tree.links.new(whole.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    occlude("red", (0.9, 0.3, 0.2)).inputs["Distance"].default_value = 1.0
    bpy.ops.mesh.primitive_uv_sphere_add(segments=8, ring_count=5, radius=1.0, location=(0.8, -1.0, 0.9))
    ball = bpy.context.object
    ball.data.materials.append(bpy.data.materials["red"])
    ball.data.polygons.foreach_set("use_smooth", [True] * len(ball.data.polygons))


def curved(_):
    """Behind a ramp that is dark up to half of the hemisphere, by 4 rays, and squared, by 3."""
    tree = bpy.data.materials["grey"].node_tree
    node, ramp = occlude("grey", (1.0, 1.0, 1.0), samples=4), tree.nodes.new("ShaderNodeValToRGB")
    node.inputs["Distance"].default_value = 4.0
    ramp.color_ramp.elements[0].position, ramp.color_ramp.elements[1].position = 0.5, 0.9
    tree.links.new(node.outputs["AO"], ramp.inputs[0])
    tree.links.new(ramp.outputs[0], tree.nodes["Diffuse BSDF"].inputs["Color"])
    tree = bpy.data.materials["red"].node_tree
    node, times = occlude("red", (1.0, 1.0, 1.0), samples=3), tree.nodes.new("ShaderNodeMath")
    node.inputs["Distance"].default_value, times.operation = 2.0, "MULTIPLY"
    for socket in times.inputs[:2]:
        tree.links.new(node.outputs["AO"], socket)
    tree.links.new(times.outputs[0], tree.nodes["Diffuse BSDF"].inputs["Color"])


def roughened(_):
    """A floor that is rougher where nothing is near, by 16 rays."""
    tree = bpy.data.materials["grey"].node_tree
    node, whole = occlude("grey", (0.9, 0.6, 0.3)), tree.nodes.new("ShaderNodeBsdfPrincipled")
    node.inputs["Distance"].default_value = 3.0
    for output, name in (("Color", "Base Color"), ("AO", "Roughness")):
        tree.links.new(node.outputs[output], whole.inputs[name])
    tree.links.new(whole.outputs[0], tree.nodes["Material Output"].inputs["Surface"])


CHANGES = {
    "beside a clear card and one without shadows": beside(as_it_comes),
    "near": near,
    "inside": inside,
    "turned": turned,
    "mixed shaders": mixed,
    "own faces": own,
    "behind curves": curved,
    "in other sockets": roughened,
    "a smooth ball and a Principled BSDF": round_and_principled,
}


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_occluded_colours_are_those_of_cycles(studio, change):
    """Seen by the camera and in a rough mirror below a sky; and the comparison notices where nothing occludes."""
    stage(studio)
    for name in ("panel", "pane", "lamp"):  # their fireflies would hide small differences
        bpy.data.objects.remove(bpy.data.objects[name])
    change(studio)
    aware = studio.export()
    found = apart(studio, aware, blind(aware), samples=FEW_SAMPLES)
    assert found[0] < 1.5
    assert found[1] > 5.0


def test_the_sockets_are_read(studio):
    stage(studio)
    occlude("grey", (0.9, 0.6, 0.3), inside=True, only_local=True, samples=3).inputs["Distance"].default_value = 2.5
    (material,) = (one for one in studio.export().materials if one.name == "grey")
    (share,) = (n for n in walk(material.lobes[0].closure.color) if isinstance(n, ex.AmbientOcclusion))
    assert share == ex.AmbientOcclusion(ex.Constant(2.5), None, inside=True, only_local=True, samples=3)


@pytest.mark.parametrize("world", ["its own", "of the view layer", "unseen", "none"])
def test_a_distance_of_0_stands_for_that_of_the_world(studio, world):
    stage(studio)
    occlude("grey", (1.0, 1.0, 1.0)).inputs["Distance"].default_value = 0.0
    scene, layer = bpy.context.scene, bpy.context.view_layer
    scene.world.light_settings.distance = 3.0
    if world == "of the view layer":
        layer.world_override = bpy.data.worlds.new("other")
        layer.world_override.light_settings.distance = 2.0
    elif world == "none":
        scene.world = None
    layer.use_sky = world != "unseen"
    shares = [n for m in studio.export().materials for x in m.lobes for n in walk(x.closure.color)]
    (share,) = {n for n in shares if isinstance(n, ex.AmbientOcclusion)}
    assert share.distance == ex.Constant({"of the view layer": 2.0, "none": 10.0}.get(world, 3.0))


@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("world", ["its own", "of the view layer", "unseen", "none"])
def test_a_distance_of_0_is_that_of_the_world_in_cycles(world, tmp_path):
    """Between two walls, a floor glows by its occlusion: as much as with the distance itself, and not twice that."""
    scene = prepare("ORTHO", 4, 1)
    scene.camera.data.ortho_scale, scene.camera.location = 1.0, (0, 0, 10)
    scene.cycles.samples = 64
    scene.world = bpy.data.worlds.new("sky")
    scene.world.light_settings.distance = 1.5
    layer = bpy.context.view_layer
    if world == "of the view layer":
        layer.world_override = bpy.data.worlds.new("other")
        layer.world_override.light_settings.distance = 1.2
    elif world == "none":
        scene.world = None
    layer.use_sky = world != "unseen"
    floor = glowing("floor", through_emission(lambda tree: node(tree, "AmbientOcclusion")))
    quad("floor", (0, 0, 0), 0.0, False).materials.append(floor)
    for place in (-1.0, 1.0):
        wall = bpy.data.meshes.new("wall")
        wall.from_pydata([(place, y, z) for y, z in ((-60, -1), (60, -1), (60, 60), (-60, 60))], [], [(0, 1, 2, 3)])
        scene.collection.objects.link(bpy.data.objects.new("wall", wall))
    distance = {"of the view layer": 1.2, "none": 10.0}.get(world, 1.5)
    pictures = []
    for given in (0.0, distance, 2.0 * distance):
        floor.node_tree.nodes["Ambient Occlusion"].inputs["Distance"].default_value = given
        pictures.append(rendered(scene, tmp_path))
    assert (pictures[0] == pictures[1]).all()
    assert (pictures[0] != pictures[2]).any()


def test_nothing_is_near_a_world(studio):
    stage(studio)
    tree = bpy.data.worlds["sky"].node_tree
    node = tree.nodes.new("ShaderNodeAmbientOcclusion")
    node.inputs["Color"].default_value = (0.2, 0.4, 0.6, 1.0)
    tree.links.new(node.outputs["Color"], tree.nodes["Background"].inputs["Color"])
    tree.links.new(node.outputs["AO"], tree.nodes["Background"].inputs["Strength"])
    assert studio.export().world.radiance.value == pytest.approx((0.2, 0.4, 0.6))
