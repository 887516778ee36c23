# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panel says before its button is pressed, and what its buttons select."""

from itertools import product

import bpy
import pytest
from etalon.addon.ui import preflight, registration
from etalon.addon.ui.places import objects_with, set_border
from etalon.lib.errors import Refusal
from etalon.lib.report.ranking import RankedRegion
from etalon.lib.verdict.outcome import Outcome
from etalon.reference_scenes import building

UNKNOWN = "ShaderNodeBsdfSheen"


@pytest.fixture
def scene(monkeypatch):
    """A floor with a material of the user's, where one kind of node is not known."""
    known = {kind: declaration for kind, declaration in preflight.DECLARATIONS.items() if kind != UNKNOWN}
    monkeypatch.setattr(preflight, "DECLARATIONS", known)
    scene = building.start("floor", 64, 32, 0)
    building.rectangle("floor", building.diffuse("grey", (0.5, 0.5, 0.5)), (0, 0, 0), (1, 0, 0), (0, 1, 0))
    return scene


def put_before_output(kind, material="grey", muted=False):
    """Have a new node of that kind feed the output of a material."""
    tree = bpy.data.materials[material].node_tree
    node = tree.nodes.new(kind)
    node.mute = muted
    tree.links.new(node.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    return node


def test_a_scene_that_can_be_compared_has_no_notice(scene):
    assert preflight.survey(scene) == []


def test_a_material_with_an_unsupported_node_is_named(scene):
    put_before_output(UNKNOWN)
    (notice,) = preflight.survey(scene)
    assert (notice.kind, notice.name, notice.stops) == ("material", "grey", True)
    assert "Sheen BSDF" in notice.text


def test_a_node_that_feeds_nothing_and_a_muted_one_do_not_count(scene):
    bpy.data.materials["grey"].node_tree.nodes.new(UNKNOWN)
    assert preflight.survey(scene) == []
    put_before_output(UNKNOWN, muted=True)
    assert preflight.survey(scene) == []


def test_a_node_in_a_group_counts(scene):
    inner = bpy.data.node_groups.new("inner", "ShaderNodeTree")
    inner.interface.new_socket("Shader", in_out="OUTPUT", socket_type="NodeSocketShader")
    end, skin = inner.nodes.new("NodeGroupOutput"), inner.nodes.new(UNKNOWN)
    inner.links.new(skin.outputs[0], end.inputs[0])
    tree = bpy.data.materials["grey"].node_tree
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree = inner
    tree.links.new(group.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    assert [notice.name for notice in preflight.survey(scene)] == ["grey"]


def test_objects_that_are_not_rendered_do_not_count(scene):
    cloud = bpy.data.objects.new("cloud", bpy.data.pointclouds.new("cloud"))
    scene.collection.objects.link(cloud)
    assert [notice.name for notice in preflight.survey(scene)] == ["cloud"]
    cloud.hide_render = True
    assert preflight.survey(scene) == []


@pytest.mark.parametrize(
    ("owner", "found"),
    [("material 'A 'b''", ("material", "A 'b'")), ("object 'x'", ("object", "x")), ("the file", ("", ""))],
)
def test_the_owner_of_a_refusal_can_be_selected(owner, found):
    notice = preflight.notice_of(Refusal(owner, "smoke", "do not render it"))
    assert (notice.kind, notice.name) == found


def test_objects_are_found_by_their_name_or_material(scene):
    layer = scene.view_layers[0]
    layer.update()
    assert [thing.name for thing in objects_with(layer, "material", "grey")] == ["floor"]
    assert [thing.name for thing in objects_with(layer, "object", "floor")] == ["floor"]
    assert objects_with(layer, "object", "grey") == []
    assert objects_with(layer, "block", "floor") == []


def test_motion_blur_that_is_off_in_the_scene_is_said(scene):
    registration.register()
    try:
        layer, said = scene.view_layers[0], "Motion blur is off in this scene or its view layer, so it is not compared"
        for chosen, in_scene, in_layer in product((False, True), repeat=3):
            scene.etalon.motion_blur, scene.render.use_motion_blur, layer.use_motion_blur = chosen, in_scene, in_layer
            notices = [notice for notice in preflight.notices_of_settings(scene) if notice.text == said]
            assert len(notices) == (chosen and not (in_scene and in_layer))
            assert not any(notice.stops for notice in notices)
    finally:
        registration.unregister()


def region(kind, box):
    return RankedRegion(kind, "", "", Outcome.DIFFERENT, 0.1, 0.0, 0.2, 0.2, "R", box)


def test_a_region_of_a_border_lies_within_it(scene):
    set_border(scene, (0.5, 0.0, 1.0, 0.5), region("block", (0.0, 0.0, 0.5, 1.0)))
    render = scene.render
    assert render.use_border
    edges = render.border_min_x, render.border_max_x, render.border_min_y, render.border_max_y
    assert edges == pytest.approx((0.5, 0.75, 0.0, 0.5))
    set_border(scene, (0.0, 0.0, 1.0, 1.0), region("image", (0.0, 0.0, 1.0, 1.0)))
    assert not render.use_border
