# SPDX-License-Identifier: GPL-3.0-or-later
"""A Holdout node removes the light that arrives.

It is seen by the camera, and in a mirror, before a white world.
"""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.host.quiet import quiet
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer

pytestmark = pytest.mark.compares_with_cycles


def nodes_of(studio):
    """The tree of the studio's plain material, and its output's socket."""
    tree = studio.plain.node_tree
    return tree, tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"]


@pytest.fixture
def view(studio):
    """A square that fills the picture, before a white world."""
    studio.look_down(0.5)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 2
    studio.quad()
    studio.scene.world = bpy.data.worlds.new("white")
    if bpy.app.version < (5, 0, 0):
        studio.scene.world.use_nodes = True
    studio.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    return studio


def render_both(studio):
    scene = studio.export()
    with quiet(), neutral(studio.scene, threads=1):
        shown = CyclesRenderer(studio.scene, threads=1).render(0, 1024).radiance[0, 0]
    return shown, ReferenceRenderer(scene, Options(threads=1)).render(0, 1024).radiance[0, 0]


@pytest.mark.parametrize(("share", "left"), [(1.0, 0.0), (0.25, 0.75)])
def test_what_a_holdout_leaves_of_a_transparent_surface(view, share, left):
    tree, surface = nodes_of(view)
    mix = tree.nodes.new("ShaderNodeMixShader")
    mix.inputs["Fac"].default_value = share
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(tree.nodes.new("ShaderNodeHoldout").outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], surface)
    for radiance in render_both(view):
        np.testing.assert_allclose(radiance, left, atol=1e-6)


def test_a_mirror_shows_a_holdout_black(view):
    tree, surface = nodes_of(view)
    tree.links.new(tree.nodes.new("ShaderNodeHoldout").outputs[0], surface)
    view.quad("above", half=9.0, z=12.0)
    mirror = bpy.data.materials.new("mirror")
    if bpy.app.version < (5, 0, 0):
        mirror.use_nodes = True
    mirror.node_tree.nodes.clear()
    glossy = mirror.node_tree.nodes.new("ShaderNodeBsdfAnisotropic")
    glossy.inputs["Roughness"].default_value = 0.0
    out = mirror.node_tree.nodes.new("ShaderNodeOutputMaterial")
    mirror.node_tree.links.new(glossy.outputs[0], out.inputs["Surface"])
    bpy.data.objects["quad"].data.materials[0] = mirror
    for radiance in render_both(view):
        np.testing.assert_array_equal(radiance, 0.0)
