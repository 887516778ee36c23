# SPDX-License-Identifier: GPL-3.0-or-later
"""The unsupported materials that only send on light.

Nodes that emit, add up lobes or move faces are distinguished from others.
"""

import bpy
import pytest
from etalon.addon.export.nodes.passive import is_passive


def surface(*kinds, **inputs):
    """A material whose last node is its surface.

    Each node is linked to the first shader input of the next.
    """
    material = bpy.data.materials.new("m")
    if material.node_tree is None:
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    last = None
    for kind in (*kinds, "ShaderNodeOutputMaterial"):
        node = tree.nodes.new(kind)
        if last is not None:
            shaders = [socket for socket in node.inputs if socket.type == "SHADER"]
            tree.links.new(last.outputs[0], shaders[0])
        last = node
    for name, value in inputs.items():
        tree.nodes[0].inputs[name.replace("_", " ")].default_value = value
    return material


@pytest.mark.parametrize(
    ("kinds", "inputs", "passive"),
    [
        (("ShaderNodeBsdfHairPrincipled",), {}, True),
        (("ShaderNodeSubsurfaceScattering", "ShaderNodeMixShader"), {}, True),
        (("ShaderNodeBsdfPrincipled",), {}, True),
        (("ShaderNodeBsdfPrincipled",), {"Emission_Strength": 0.5}, False),
        (("ShaderNodeBsdfDiffuse",), {"Color": (1.5, 0.5, 0.5, 1.0)}, False),
        (("ShaderNodeEmission", "ShaderNodeMixShader"), {}, False),
        (("ShaderNodeBsdfDiffuse", "ShaderNodeAddShader"), {}, False),
        (("ShaderNodeHoldout",), {}, False),
        (("ShaderNodeScript",), {}, False),
    ],
)
def test_materials_that_may_emit_are_told_from_those_that_do_not(kinds, inputs, passive):
    if kinds == ("ShaderNodeScript",):
        material = surface("ShaderNodeBsdfDiffuse")
        material.node_tree.nodes.new("ShaderNodeScript")
    else:
        material = surface(*kinds, **inputs)
    assert is_passive(material) is passive


def test_what_lies_in_groups_counts():
    group = bpy.data.node_groups.new("g", "ShaderNodeTree")
    material = surface("ShaderNodeBsdfDiffuse")
    material.node_tree.nodes.new("ShaderNodeGroup").node_tree = group
    assert is_passive(material)
    group.nodes.new("ShaderNodeEmission")
    assert not is_passive(material)


def test_faces_that_are_displaced_are_not_where_the_mesh_has_them():
    material = surface("ShaderNodeBsdfDiffuse")
    tree = material.node_tree
    out = next(n for n in tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(tree.nodes.new("ShaderNodeDisplacement").outputs[0], out.inputs["Displacement"])
    material.displacement_method = "BUMP"
    assert is_passive(material)
    material.displacement_method = "DISPLACEMENT"
    assert not is_passive(material)
