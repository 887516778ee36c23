# SPDX-License-Identifier: GPL-3.0-or-later
"""Holdouts: black to the camera, and as they are to all other rays."""

import bpy
import numpy as np
import pytest
from etalon.lib.errors import Refused
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.addon.export.test_ray_visibility import stage
from etalon.tests.addon.export.test_visibility import shader


def middle(exported):
    """The means of the frame's inner quarter and of its border."""
    image = ReferenceRenderer(exported, Options(threads=1)).render(0, 4).radiance
    inner = image[6:10, 6:10].mean()
    return inner, (image.sum() - image[4:12, 4:12].sum()) / (image.size - image[4:12, 4:12].size)


def card_over_floor(studio):
    glow = shader("glow", "Emission", Strength=2.0)
    studio.quad("floor", 4.0).data.materials[0] = glow
    card = studio.quad("card", half=0.5, z=1.0)
    card.data.materials[0] = glow
    studio.look_down(2.0)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 16
    return card


def hold_out_itself(card, studio):
    card.is_holdout = True


def hold_out_its_collection(card, studio):
    inner = bpy.data.collections.new("inner")
    studio.scene.collection.children.link(inner)
    studio.scene.collection.objects.unlink(card)
    inner.objects.link(card)
    studio.layer.layer_collection.children["inner"].holdout = True


@pytest.mark.parametrize("hold_out", [hold_out_itself, hold_out_its_collection])
def test_the_camera_sees_black(studio, hold_out):
    """Also where it shares its material with what is seen."""
    hold_out(card_over_floor(studio), studio)
    inner, border = middle(studio.export())
    assert inner == 0.0
    np.testing.assert_allclose(border, 2.0, rtol=1e-6)


def test_what_is_clear_stays_clear(studio):
    """Half of the light from below passes a holdout that is half transparent."""
    card = card_over_floor(studio)
    half = shader("half", "Emission", Strength=1.0)
    tree = half.node_tree
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(tree.nodes["Emission"].outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    card.data.materials[0] = half
    assert middle(studio.export())[0] == pytest.approx(0.5 * 2.0 + 0.5 * 1.0, rel=0.2)
    card.is_holdout = True
    assert middle(studio.export())[0] == pytest.approx(0.5 * 2.0, rel=0.2)


def test_a_mirror_shows_a_holdout_as_it_is(studio):
    """A glowing holdout outside of the frame, in a mirror that fills it."""
    mirror = shader("mirror", "BsdfGlossy", Roughness=0.0)
    studio.quad("mirror", 4.0).data.materials[0] = mirror
    above = studio.quad("above", half=20.0, z=30.0)
    above.data.materials[0] = shader("glow", "Emission", Strength=3.0)
    studio.look_down(2.0)
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 4
    studio.scene.cycles.max_bounces = 1
    bright = ReferenceRenderer(studio.export(), Options(threads=1)).render(0, 4).radiance
    above.is_holdout = True
    held = ReferenceRenderer(studio.export(), Options(threads=1)).render(0, 4).radiance
    assert bright.min() > 1.0
    np.testing.assert_allclose(held, bright, rtol=1e-6)


def test_a_holdout_with_a_volume_is_refused(studio):
    card = stage(studio)[0]
    tree = bpy.data.materials["red"].node_tree
    volume = tree.nodes.new("ShaderNodeVolumeAbsorption")
    tree.links.new(volume.outputs[0], tree.nodes["Material Output"].inputs["Volume"])
    card.is_holdout = True
    with pytest.raises(Refused, match="material 'red': the volume of a holdout is not simulated"):
        studio.export()
