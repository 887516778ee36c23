# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that both sides can do without: set aside, and reported.

Also how the neutral state changes them.
"""

import bpy
import numpy as np
from etalon.addon import job
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


def test_motion_blur_that_is_wanted_and_off_in_the_scene_is_said(studio):
    studio.quad()
    render = studio.scene.render
    for in_scene, in_layer in ((False, True), (True, False), (True, True)):
        render.use_motion_blur, studio.layer.use_motion_blur = in_scene, in_layer
        said = finding(job.export(studio.scene, motion_blur=True), "motion blur")
        assert (said is None) == (in_scene and in_layer)
        assert said is None or "so --motion-blur changes nothing." in said
    render.use_motion_blur = False
    assert finding(job.export(studio.scene), "motion blur") is None


def test_lines_of_freestyle_are_set_aside_and_said(studio):
    studio.quad()
    render = studio.scene.render
    for in_scene, in_layer in ((False, True), (True, False), (True, True)):
        render.use_freestyle, studio.layer.use_freestyle = in_scene, in_layer
        said = finding(job.export(studio.scene), "Freestyle")
        assert (said is not None) == (in_scene and in_layer)
        assert said is None or "Freestyle is off on both sides." in said
    assert render.use_freestyle


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


def parabola(studio):
    """A sunlit plane of 2 x 2 m, in 32 x 32 pixels, that a Bump node raises by x^2."""
    studio.look_down(2.0)
    material = bpy.data.materials.new("parabola")
    if bpy.app.version < (5, 0, 0):
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    names = "TexCoord", "SeparateXYZ", "Math", "Bump", "BsdfDiffuse", "OutputMaterial"
    where, part, square, bump, diffuse, out = (tree.nodes.new(f"ShaderNode{name}") for name in names)
    square.operation = "MULTIPLY"
    diffuse.inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    tree.links.new(where.outputs["Object"], part.inputs[0])
    for socket in square.inputs[:2]:
        tree.links.new(part.outputs["X"], socket)
    tree.links.new(square.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs[0], diffuse.inputs["Normal"])
    tree.links.new(diffuse.outputs[0], out.inputs["Surface"])
    for name, value in (("Strength", 1.0), ("Distance", 1.0)):
        bump.inputs[name].default_value = value
    quad = studio.quad()
    quad.data.materials.clear()
    quad.data.materials.append(material)
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = np.pi, 0.0
    studio.add("sun", sun)
    return bump


def slopes(radiance):
    """(32,) the tangent of the angle between normal and sun, from white diffuse radiance.

    cos = 1 / sqrt(1 + slope^2).
    """
    return np.sqrt(np.maximum(np.mean(radiance[..., 0], axis=0) ** -2.0 - 1.0, 0.0))


def test_the_filter_width_of_a_bump_is_set_aside_and_said(studio):
    bump = parabola(studio)
    if "Filter Width" not in bump.inputs:
        return  # Blender before 4.5
    bump.inputs["Filter Width"].default_value = 0.1
    assert finding(studio.export(), "bump filter width") is None
    bump.inputs["Filter Width"].default_value = 1.0
    scene = studio.export()
    assert "0.1 pixels on both sides, in 1 material: 'parabola'." in finding(scene, "bump filter width")
    pixel = 2.0 / 32
    x = (np.arange(16, 32) + 0.5) * pixel - 1.0  # the plane's right half
    wide = slopes(studio.cycles())[16:]
    with neutral(studio.scene, threads=1):
        narrow = slopes(CyclesRenderer(studio.scene, threads=1).render(0, 64).radiance)[16:]
    reference = slopes(ReferenceRenderer(scene, Options(threads=1)).render(0, 64).radiance)[16:]
    # Differences of x^2 over w pixels, along the two diagonals of the pixel, make the slope 2 x + w / sqrt(2) pixels.
    np.testing.assert_allclose(wide - 2.0 * x, pixel / np.sqrt(2.0), rtol=0.01)
    np.testing.assert_allclose(narrow[1:] - 2.0 * x[1:], 0.1 * pixel / np.sqrt(2.0), atol=0.05 * pixel)
    np.testing.assert_allclose(reference[1:], 2.0 * x[1:], atol=0.05 * pixel)
    assert bump.inputs["Filter Width"].default_value == 1.0
