# SPDX-License-Identifier: GPL-3.0-or-later
"""Depths and length of rays that shaders ask for, against Cycles."""

import bpy
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer
from etalon.lib.errors import Refused
from etalon.lib.scene.rays import COUNTS
from etalon.lib.textures.fold import walk
from etalon.tests.addon.export.test_ray_visibility import stage
from etalon.tests.addon.export.test_visibility import apart, blocks, off, reference_of


def color_by(outputs):
    """Colours of the floor and the card.

    `outputs` are (output, factor) of a Light Path node for red, green and blue.
    """
    for name in ("grey", "red"):
        tree = bpy.data.materials[name].node_tree
        path, combine = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeCombineColor")
        for socket, (output, factor) in zip(combine.inputs, outputs, strict=True):
            times = tree.nodes.new("ShaderNodeMath")
            times.operation = "MULTIPLY_ADD"
            times.inputs[1].default_value, times.inputs[2].default_value = factor, 0.1
            tree.links.new(path.outputs[output], times.inputs[0])
            tree.links.new(times.outputs[0], socket)
        tree.links.new(combine.outputs[0], tree.nodes["Diffuse BSDF"].inputs["Color"])


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(
    "outputs",
    [
        [("Ray Depth", 0.3), ("Diffuse Depth", 0.4), ("Glossy Depth", 0.4)],
        [("Transmission Depth", 0.3), ("Ray Length", 0.05), ("Ray Depth", 0.5)],
    ],
    ids=["reflected", "transmitted"],
)
def test_surfaces_coloured_by_depths_and_lengths_are_those_of_cycles(studio, outputs):
    """They are seen by the camera, in a rough mirror and through glass, with two bounces.

    The comparison notices white ones.
    """
    stage(studio)
    for name in ("grey", "red"):
        color = bpy.data.materials[name].node_tree.nodes["Diffuse BSDF"].inputs["Color"]
        color.default_value = (0.3, 0.3, 0.3, 1.0)
    bpy.data.objects.remove(bpy.data.objects["panel"])
    unaware = studio.export()
    color_by(outputs)
    aware, blind = apart(studio, studio.export(), unaware)
    assert aware < 1.5
    assert blind > 5.0


def clear_by(output, factor, least):
    """The card lets a count times `factor`, and `least`, of the light straight through."""
    tree = bpy.data.materials["red"].node_tree
    path, share, mix = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("LightPath", "Math", "MixShader"))
    share.operation = "MULTIPLY_ADD"
    share.inputs[1].default_value, share.inputs[2].default_value = factor, least
    out = tree.nodes["Material Output"]
    diffuse = out.inputs["Surface"].links[0].from_socket
    tree.links.new(path.outputs[output], share.inputs[0])
    tree.links.new(share.outputs[0], mix.inputs[0])
    tree.links.new(diffuse, mix.inputs[1])
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], out.inputs["Surface"])
    return share.inputs


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(
    ("output", "factor", "least", "constant"),
    [("Ray Depth", 0.4, 0.1, 0.1), ("Transparent Depth", 0.5, 0.3, 0.3), ("Ray Length", 0.1, -0.4, 0.4)],
)
def test_a_card_that_is_clear_by_a_count_is_that_of_cycles(studio, output, factor, least, constant):
    """A second card lies below it, so that rays pass several, and all of it is seen in a mirror, too.

    The comparison notices a reference for which the card is as clear to all rays as to those of the camera.
    """
    card = stage(studio)[0]
    second = card.copy()
    studio.scene.collection.objects.link(second)
    second.location[2] -= 0.4
    inputs = clear_by(output, factor, least)
    aware = studio.export()
    theirs = blocks(CyclesRenderer(studio.scene, threads=1), 64)
    inputs[1].default_value, inputs[2].default_value = 0.0, constant
    assert off(reference_of(aware, 64), theirs) < 1.5
    assert off(reference_of(studio.export(), 64), theirs) > 1.9


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize(
    ("output", "smooth"), [("Linear", 0.0), ("Constant", 0.0), ("Linear", 3.0), ("Quadratic", 3.0)]
)
def test_a_panel_behind_a_light_falloff_node_is_that_of_cycles(studio, output, smooth):
    """It lights the floor and is seen by the camera, in a rough mirror and through glass.

    The comparison notices a panel that falls off as usual.
    """
    stage(studio)
    tree = bpy.data.materials["glow"].node_tree
    bpy.data.lights["lamp"].energy = 30.0
    unaware = studio.export()
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value, falloff.inputs["Smooth"].default_value = 4.0, smooth
    tree.links.new(falloff.outputs[output], tree.nodes["Emission"].inputs["Strength"])
    aware, blind = apart(studio, studio.export(), unaware)
    assert aware < 1.5
    assert blind > 1.9


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("output", ["Linear", "Constant"])
def test_a_lamp_behind_a_light_falloff_node_is_that_of_cycles(studio, output):
    """A ball that the rough mirror shows, too. The comparison notices one that falls off as usual."""
    lamp = stage(studio)[2]
    bpy.data.objects.remove(bpy.data.objects["panel"])
    lamp.data.shadow_soft_size = 0.5
    if lamp.data.node_tree is None:
        lamp.data.use_nodes = True
    tree = lamp.data.node_tree
    (emission,) = (n for n in tree.nodes if n.bl_idname == "ShaderNodeEmission")
    unaware = studio.export()
    falloff = tree.nodes.new("ShaderNodeLightFalloff")
    falloff.inputs["Strength"].default_value = 0.5
    tree.links.new(falloff.outputs[output], emission.inputs["Strength"])
    aware, blind = apart(studio, studio.export(), unaware)
    assert aware < 1.5
    assert blind > 1.9


def test_all_outputs_are_read(studio):
    stage(studio)
    names = ["Ray Depth", "Diffuse Depth", "Glossy Depth", "Transmission Depth", "Transparent Depth", "Ray Length"]
    color_by([(name, 1.0) for name in names[:3]])
    tree = bpy.data.materials["grey"].node_tree
    for socket, name in zip(tree.nodes["Combine Color"].inputs, names[3:], strict=True):
        tree.links.new(tree.nodes["Light Path"].outputs[name], socket)
    found = set()
    for material in studio.export().materials:
        if material.name in ("grey", "red"):
            (lobe,) = material.lobes
            found |= {getattr(node, "count", None) for node in walk(lobe.closure.color)}
    assert found - {None} == {*COUNTS}


@pytest.mark.parametrize(
    ("closure", "where"), [("BsdfTransparent", "what lets light straight through"), ("Emission", "its emission")]
)
def test_light_that_would_depend_on_how_it_is_sampled_is_refused(studio, closure, where):
    stage(studio)
    tree = bpy.data.materials["red"].node_tree
    path, mix = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(path.outputs["Diffuse Depth"], mix.inputs[0])
    tree.links.new(tree.nodes["Diffuse BSDF"].outputs[0], mix.inputs[1])
    tree.links.new(tree.nodes.new(f"ShaderNode{closure}").outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    with pytest.raises(Refused, match=f"'Diffuse Depth' of a Light Path node in {where} is not"):
        studio.export()


def test_a_world_that_asks_for_a_depth_is_refused(studio):
    stage(studio)
    tree = bpy.data.worlds["sky"].node_tree
    path = tree.nodes.new("ShaderNodeLightPath")
    tree.links.new(path.outputs["Ray Depth"], tree.nodes["Background"].inputs["Strength"])
    with pytest.raises(Refused, match=r"node 'Light Path' .*, output 'Ray Depth', is not simulated"):
        studio.export()
