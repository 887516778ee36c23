# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs whose link ends in muted nodes or reroutes that lead nowhere, against Cycles."""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.host.quiet import quiet
from etalon.lib.errors import Refused
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer

pytestmark = pytest.mark.compares_with_cycles

OWN = (0.1, 0.2, 0.3)
GIVEN = (0.7, 0.8, 0.9, 1.0)


def muted(tree, name):
    made = tree.nodes.new(name)
    made.mute = True
    return made


def muted_source(tree):
    return muted(tree, "ShaderNodeRGB").outputs[0]


def muted_mix(tree):
    made = muted(tree, "ShaderNodeMix")
    made.data_type = "RGBA"
    made.inputs[6].default_value = GIVEN
    return made.outputs[2]


def empty_reroute(tree):
    return tree.nodes.new("NodeReroute").outputs[0]


def reroute_of_a_muted_source(tree):
    made = tree.nodes.new("NodeReroute")
    tree.links.new(muted_source(tree), made.inputs[0])
    return made.outputs[0]


def group_input(tree):
    """What a group passes on of an input (0.7, 0.8, 0.9) that a muted node is linked to."""
    inner = bpy.data.node_groups.new("group", "ShaderNodeTree")
    inner.interface.new_socket("In", in_out="INPUT", socket_type="NodeSocketColor")
    inner.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketColor")
    gamma = inner.nodes.new("ShaderNodeGamma")
    inner.links.new(inner.nodes.new("NodeGroupInput").outputs[0], gamma.inputs["Color"])
    inner.links.new(gamma.outputs[0], inner.nodes.new("NodeGroupOutput").inputs[0])
    made = tree.nodes.new("ShaderNodeGroup")
    made.node_tree = inner
    made.inputs[0].default_value = GIVEN
    tree.links.new(muted_source(tree), made.inputs[0])
    return made.outputs[0]


def render_both(studio, source):
    """The pixel that Cycles and the reference show of an emission of colour `OWN`.

    `source` is linked to its colour.
    """
    studio.look_down(0.5)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 2
    studio.quad()
    tree = studio.plain.node_tree
    emission, out = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    emission.inputs["Color"].default_value = (*OWN, 1.0)
    tree.links.new(source(tree), emission.inputs["Color"])
    tree.links.new(emission.outputs[0], out.inputs["Surface"])
    scene = studio.export()
    with quiet(), neutral(studio.scene, threads=1):
        shown = CyclesRenderer(studio.scene, threads=1).render(0, 1).radiance[0, 0]
    return shown, ReferenceRenderer(scene, Options(threads=1)).render(0, 1).radiance[0, 0]


def test_an_input_that_a_muted_source_is_linked_to_keeps_its_own_value(studio):
    shown, reference = render_both(studio, muted_source)
    np.testing.assert_allclose(shown, OWN, rtol=1e-6)
    np.testing.assert_allclose(reference, OWN, rtol=1e-6)


def test_a_groups_input_that_a_muted_source_is_linked_to_keeps_its_own_value(studio):
    shown, reference = render_both(studio, group_input)
    np.testing.assert_allclose(shown, GIVEN[:3], rtol=1e-6)
    np.testing.assert_allclose(reference, GIVEN[:3], rtol=1e-6)


@pytest.mark.parametrize("source", [muted_mix, empty_reroute, reroute_of_a_muted_source])
def test_muted_nodes_and_reroutes_that_lead_nowhere_leave_an_input_its_own_value(studio, source):
    if bpy.app.version < (5, 2):
        with pytest.raises(Refused, match="which passes nothing on"):
            render_both(studio, source)
        return
    shown, reference = render_both(studio, source)
    np.testing.assert_allclose(shown, OWN, rtol=1e-6)
    np.testing.assert_allclose(reference, OWN, rtol=1e-6)
