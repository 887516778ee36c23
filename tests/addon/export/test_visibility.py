# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that hide from camera rays, against Cycles.

They stand alone, behind a veil, in a mirror, as lamps and as instances.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.lib.effects.plan import make_plan
from etalon.lib.scene.rays import CAMERA
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.coverage import coverage
from etalon.lib.wavefront.render import ReferenceRenderer
from mathutils import Euler, Matrix

REPLICATES, SAMPLES = 4, 64
FEW_SAMPLES = 32
"""Where a scene is blind to what is tested, its image is so far off that these are enough to see it."""


def shader(name, kind, **values):
    """A material of one shader node."""
    material = bpy.data.materials.new(name)
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node, out = tree.nodes.new(f"ShaderNode{kind}"), tree.nodes.new("ShaderNodeOutputMaterial")
    for socket, value in values.items():
        node.inputs[socket].default_value = value
    tree.links.new(node.outputs[0], out.inputs["Surface"])
    return material


def square(studio, name, material, half, *transform):
    thing = studio.quad(name, half)
    thing.data.materials.clear()
    thing.data.materials.append(material)
    matrix = Matrix.Identity(4)
    for one in transform:
        matrix = matrix @ one
    thing.matrix_world = matrix
    return thing


def below_a_sky(studio, bounces):
    """A grey sky, a camera that looks down on the origin, and the size that `apart` takes."""
    world = bpy.data.worlds.new("sky")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.3, 0.35, 0.4, 1.0)
    studio.scene.world = world
    studio.camera.location, studio.camera.rotation_euler = (0.0, -5.0, 2.6), (1.15, 0.0, 0.0)
    studio.scene.render.resolution_x, studio.scene.render.resolution_y = 48, 32
    studio.scene.render.engine, studio.scene.cycles.max_bounces = "CYCLES", bounces


def scene(studio):
    """A floor and a mirror wall, with a card and a lamp that hide above the floor.

    A veil stands before a part of it all.
    """
    grey, red = (
        shader("grey", "BsdfDiffuse", Color=(0.6, 0.6, 0.6, 1)),
        shader("red", "BsdfDiffuse", Color=(0.9, 0.1, 0.1, 1)),
    )
    mirror = shader("mirror", "BsdfGlossy", Roughness=0.0)
    lamp, veil = shader("lamp", "Emission", Strength=4.0), shader("veil", "BsdfTransparent", Color=(0.8, 0.9, 1.0, 1))
    upright = Euler((np.pi / 2, 0, 0)).to_matrix().to_4x4()
    square(studio, "floor", grey, 4.0)
    square(studio, "wall", mirror, 3.0, Matrix.Translation((0, 3, 3)), upright)
    card = square(studio, "card", red, 0.8, Matrix.Translation((-1.2, 0, 1.0)))
    light = square(studio, "light", lamp, 0.5, Matrix.Translation((1.5, 0, 2.0)))
    square(studio, "veil", veil, 1.5, Matrix.Translation((0.5, -4.0, 2.0)), upright)
    card.visible_camera = light.visible_camera = False
    inside = bpy.data.collections.new("inside")
    inside.objects.link(square(studio, "member", red, 0.4))
    empty = studio.add("empty", None, Matrix.Translation((1.0, -1.5, 0.6)))
    empty.instance_type, empty.instance_collection, empty.visible_camera = "COLLECTION", inside, False
    studio.camera.location, studio.camera.rotation_euler = (0.0, -9.0, 4.0), (1.2, 0.0, 0.0)
    studio.scene.render.resolution_x, studio.scene.render.resolution_y = 48, 32
    world = bpy.data.worlds.new("sky")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.3, 0.3, 0.3, 1.0)
    studio.scene.world = world
    bpy.data.objects["member"].location = (50.0, 0.0, 0.0)
    studio.scene.render.engine = "CYCLES"
    studio.scene.cycles.max_bounces = 2


def test_collections_that_are_indirect_only_hide_from_the_camera(studio):
    """A face and a lamp each, as Cycles has it."""
    glow = shader("glow", "Emission", Strength=1.0)
    lamp = bpy.data.lights.new("lamp", "AREA")
    panel = studio.add("panel", lamp, Euler((np.pi, 0, 0)).to_matrix().to_4x4())
    things = {"face": square(studio, "face", glow, 1.0), "panel": panel}
    panel.visible_camera = True
    studio.quad("ground", 4.0, z=-1.0)
    studio.look_down(0.1)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 4
    collection = bpy.data.collections.new("indirect")
    studio.scene.collection.children.link(collection)
    for name, thing in things.items():
        studio.scene.collection.objects.unlink(thing)
        for other in (x for x in things.values() if x is not thing):
            other.hide_render = True
        thing.hide_render = False
        collection.objects.link(thing)
        for indirect in (False, True):
            studio.layer.layer_collection.children["indirect"].indirect_only = indirect
            shown = studio.cycles(1).max()
            found = ReferenceRenderer(studio.export(), Options()).render(0, 1).radiance.max()
            assert (shown > 0.5) == (found > 0.5) == (not indirect), name


def apart(studio, *exported, samples=SAMPLES):
    """How far images of the exported scenes are from Cycles', in blocks of 8 x 8.

    Images have 48 x 32 pixels. Root mean squares of standard errors.
    """
    theirs = blocks(CyclesRenderer(studio.scene, threads=1), samples)
    return [off(reference_of(one, samples), theirs) for one in exported]


def blocks(side, samples=SAMPLES):
    """The means of blocks of 8 x 8 pixels in each replicate."""
    images = np.array([side.render(k, samples).radiance for k in range(REPLICATES)])
    return images.reshape(REPLICATES, 4, 8, 6, 8, 3).mean(axis=(2, 4))


def reference_of(exported, samples=SAMPLES):
    return blocks(ReferenceRenderer(exported, Options(threads=1)), samples)


def off(ours, theirs):
    """The root mean square of the differences in standard errors."""
    error = np.sqrt((ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / REPLICATES)
    gap = (ours.mean(axis=0) - theirs.mean(axis=0)) / (error + 1e-3 * theirs.mean(axis=0))
    return np.sqrt((gap**2).mean())


@pytest.mark.compares_with_cycles
def test_camera_rays_pass_what_hides_from_them(studio):
    scene(studio)
    exported = studio.export()
    hidden = {thing.name for thing in exported.mesh.objects if not thing.rays & CAMERA}
    assert hidden == {"card", "light", "member"}
    assert make_plan(exported).needs("second hits")
    assert apart(studio, exported)[0] < 1.5
    seen = {name for name, _ in coverage(ReferenceRenderer(exported).kernel, least=0.0)["object"]}
    assert seen == {"floor", "wall", "veil"}


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_the_card_would_be_seen(studio):
    """The comparison notices a card that should hide and does not."""
    scene(studio)
    bpy.data.objects["card"].visible_camera = True
    exported = studio.export()
    bpy.data.objects["card"].visible_camera = False
    assert apart(studio, exported)[0] > 5.0
