# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that both sides can do without: set aside, and said; and what the neutral state makes of them."""

import bpy
import numpy as np
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer


def finding(scene, check):
    return next((str(one) for one in scene.findings if one.check == check), None)


def test_motion_blur_is_set_aside_and_said(studio):
    studio.quad()
    assert finding(studio.export(), "motion blur") is None
    studio.scene.render.use_motion_blur = True
    assert "Motion blur is off on both sides." in finding(studio.export(), "motion blur")
    studio.layer.use_motion_blur = False
    assert finding(studio.export(), "motion blur") is None


def mirrored_lamp(studio):
    """A mirror under the camera that shows a square lamp above it."""
    studio.look_down(0.5)
    shader = bpy.data.materials.new("mirror")
    if bpy.app.version < (5, 0, 0):
        shader.use_nodes = True
    tree = shader.node_tree
    tree.nodes.clear()
    glossy, out = tree.nodes.new("ShaderNodeBsdfAnisotropic"), tree.nodes.new("ShaderNodeOutputMaterial")
    glossy.inputs["Roughness"].default_value = 0.0
    glossy.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)
    tree.links.new(glossy.outputs[0], out.inputs["Surface"])
    quad = studio.quad()
    quad.data.materials.clear()
    quad.data.materials.append(shader)
    lamp = studio.add("lamp", bpy.data.lights.new("lamp", "AREA"))
    lamp.data.energy, lamp.data.size, lamp.location = 100.0, 2.0, (0.0, 0.0, 12.0)
    return lamp


def test_a_light_without_multiple_importance_sampling_is_compared_with_it_and_said(studio):
    lamp = mirrored_lamp(studio)
    assert finding(studio.export(), "light sampling") is None
    lamp.data.cycles.use_multiple_importance_sampling = False
    scene = studio.export()
    told = finding(scene, "light sampling")
    assert "Multiple importance sampling of 1 light is on on both sides: 'lamp'." in told
    # What the finding says of Cycles: with it off, mirrors do not show the light.
    studio.scene.cycles.max_bounces = 2
    assert not studio.cycles().any()
    with neutral(studio.scene, threads=1):
        image = CyclesRenderer(studio.scene, threads=1).render(0, 1).radiance
    reference = ReferenceRenderer(scene, Options(threads=1)).render(0, 1).radiance
    np.testing.assert_allclose(image[8:24, 8:24], reference[8:24, 8:24], rtol=1e-5)
    assert not lamp.data.cycles.use_multiple_importance_sampling
