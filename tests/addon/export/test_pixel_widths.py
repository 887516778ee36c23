# SPDX-License-Identifier: GPL-3.0-or-later
"""Wireframe nodes with Pixel Size: the image beside Cycles'."""

from dataclasses import replace

import bpy
import pytest
from etalon.lib.scene import expressions as ex
from etalon.lib.scene.materials import WeightedClosure
from etalon.lib.textures.fold import inputs
from etalon.tests.addon.export.test_ray_visibility import stage
from etalon.tests.addon.export.test_visibility import apart


def wire(name, size):
    """Make the diffuse colour of a material 0.8 where a Wireframe node in pixels is 1, and 0.2 elsewhere."""
    tree = bpy.data.materials[name].node_tree
    node = tree.nodes.new("ShaderNodeWireframe")
    node.use_pixel_size, node.inputs["Size"].default_value = True, size
    lit = tree.nodes.new("ShaderNodeMath")
    lit.operation, lit.inputs[1].default_value, lit.inputs[2].default_value = "MULTIPLY_ADD", 0.6, 0.2
    tree.links.new(node.outputs[0], lit.inputs[0])
    tree.links.new(lit.outputs[0], tree.nodes["Diffuse BSDF"].inputs["Color"])


def wider(scene):
    """The scene with pixels of twice their width."""

    def one(node):
        if isinstance(node, ex.PixelWidth):
            return ex.Math("MULTIPLY", node, ex.Constant(2.0), ex.ZERO)
        return replace(node, **{name: one(part) for name, part in inputs(node).items()})

    def lobe(lobe):
        sockets = {name: one(part) for name, part in vars(lobe.closure).items() if isinstance(part, ex.Expression)}
        return WeightedClosure(replace(lobe.closure, **sockets), one(lobe.weight))

    return replace(scene, materials=tuple(replace(m, lobes=tuple(map(lobe, m.lobes))) for m in scene.materials))


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
def test_wires_in_pixels_are_those_of_cycles(studio, kind):
    """Seen by the camera and in a rough mirror below a sky; and the comparison notices pixels of twice the width."""
    stage(studio)
    for name in ("panel", "pane", "lamp"):  # their fireflies would hide small differences
        bpy.data.objects.remove(bpy.data.objects[name])
    bpy.context.scene.camera.data.type = kind
    wire("grey", 12.0)
    wire("red", 6.0)
    aware = studio.export()
    found = apart(studio, aware, wider(aware))
    assert found[0] < 1.5
    assert found[1] > 5.0
