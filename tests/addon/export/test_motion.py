# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion while the shutter is open.

Keys of objects, deforming meshes and the camera, and refusals of the rest.
"""

import bpy
import numpy as np
import pytest
from etalon.addon import job
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.host.quiet import quiet
from etalon.lib.errors import EtalonError, Refused
from etalon.lib.scene.moment import scene_at
from etalon.lib.settings.comparison import Settings
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.conftest import unknown_cycles


def animate(owner, path, *values):
    """Keys of a property at the frames 0, 1 and so on, linear between them."""
    for frame, value in enumerate(values):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)
    action = owner.id_data.animation_data.action
    # Shape keys share their object's action, in a slot of their own.
    bags = [bag for layer in action.layers for strip in layer.strips for bag in strip.channelbags]
    for curve in (curve for bag in bags for curve in bag.fcurves):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def exported(studio):
    with quiet():
        return job.export(studio.scene, motion_blur=True)


@pytest.fixture
def moving(studio):
    """A square over a still one, at frame 1.5 with a shutter of half a frame."""
    studio.look_down(4.0)
    studio.quad("still", 3.0)
    square = studio.quad("square", z=1.0)
    animate(square, "location", (-1.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, 2.0, 0.0))
    studio.scene.render.use_motion_blur = True
    studio.scene.render.motion_blur_shutter = 0.5
    studio.scene.frame_set(1, subframe=0.5)
    return square


def bend(thing):
    """A shape key that moves all vertices by 1 from frame 0 to frame 2."""
    thing.shape_key_add(name="rest")
    shape = thing.shape_key_add(name="bent")
    for point in shape.data:
        point.co.x += 1.0
    animate(shape, "value", 0.0, 0.5, 1.0)


def test_keys_are_where_things_are_at_the_shutters_frames(studio, moving):
    """Two steps are five keys, from 1.25 to 1.75, and the camera has three.

    The frame is restored, whatever happens.
    """
    moving.cycles.motion_steps = 2
    animate(studio.camera, "location", (0.0, 0.0, 10.0), (0.0, 0.0, 12.0), (0.0, 0.0, 14.0))
    studio.scene.frame_set(1, subframe=0.5)
    motion = exported(studio).motion
    assert list(motion.objects) == [1]
    expected = [(t, 2.0 * t, 0.0) for t in (0.25, 0.375, 0.5, 0.625, 0.75)]
    np.testing.assert_allclose(motion.objects[1][:, :, 3], expected, atol=1e-6)
    np.testing.assert_allclose(motion.camera[:, 2, 3], (12.5, 13.0, 13.5), atol=1e-5)
    assert not motion.positions
    assert (studio.scene.frame_current, studio.scene.frame_subframe) == (1, 0.5)
    assert studio.scene.render.use_motion_blur


def test_a_linked_namesake_keeps_what_moves_apart(studio, moving, tmp_path):
    """Two objects of one name, of which one stands still, come before the one that moves."""
    studio.quad("first", z=-1.0)
    bpy.data.libraries.write(str(tmp_path / "library.blend"), {bpy.data.objects["first"]})
    with bpy.data.libraries.load(str(tmp_path / "library.blend"), link=True) as (_, wanted):
        wanted.objects = ["first"]
    studio.scene.collection.objects.link(wanted.objects[0])
    scene = exported(studio)
    names = [thing.name for thing in scene.mesh.objects]
    assert names.count("first") == 2
    assert list(scene.motion.objects) == [names.index("square")]


def test_vertices_of_a_mesh_that_deforms_are_those_at_the_keys(studio, moving):
    """Of the second of two users of one mesh, too, whose vertices follow those of the first."""
    bend(moving)
    studio.add("twin", moving.data)
    studio.scene.frame_set(1)
    scene = exported(studio)
    assert sorted(scene.motion.positions) == [1, 2]
    rest = np.array([(-1.0, 1.0, 1.0, -1.0), (-1.0, -1.0, 1.0, 1.0)])
    for positions in scene.motion.positions.values():
        for key, value in zip(positions, (0.375, 0.5, 0.625), strict=True):
            np.testing.assert_allclose(key[:2], rest + np.array([[value], [0.0]]), atol=1e-6)


def test_what_has_its_motion_blur_off_stands_still(studio, moving):
    moving.cycles.use_motion_blur = False
    assert exported(studio).motion is None
    moving.cycles.use_motion_blur = True
    moving.cycles.use_deform_motion = False
    bend(moving)
    studio.scene.frame_set(1)
    motion = exported(studio).motion
    assert list(motion.objects) == [1]
    assert not motion.positions
    studio.layer.use_motion_blur = False
    assert exported(studio).motion is None


def _rolling(studio, square):
    studio.scene.cycles.rolling_shutter_type = "TOP"


def _start(studio, square):
    studio.scene.render.motion_blur_position = "START"


def _curve(studio, square):
    studio.scene.render.motion_blur_shutter_curve.curves[0].points[0].location = (0.0, 0.2)


def _light(studio, square):
    animate(studio.add("lamp", bpy.data.lights.new("lamp", "POINT")), "location", (0, 0, 3), (1, 0, 3), (2, 0, 3))


def _lens(studio, square):
    animate(studio.camera.data, "ortho_scale", 4.0, 5.0, 6.0)


def _hidden(studio, square):
    square.hide_render = False
    square.keyframe_insert("hide_render", frame=0)
    square.hide_render = True
    square.keyframe_insert("hide_render", frame=1)


def _remeshed(studio, square):
    copies = square.modifiers.new("array", "ARRAY")
    for frame, count in enumerate((1, 1, 3)):
        copies.count = count
        square.keyframe_insert('modifiers["array"].count', frame=frame)


def _velocity(studio, square):
    square.data.attributes.new("velocity", "FLOAT_VECTOR", "POINT")


def _mapped(studio, square):
    bend(square)
    square.data.uv_layers.new(name="uv")
    tree = square.data.materials[0].node_tree
    shader, out = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(tree.nodes.new("ShaderNodeNormalMap").outputs["Normal"], shader.inputs["Normal"])
    tree.links.new(shader.outputs[0], out.inputs["Surface"])


def _displaced(studio, square, height=1.0):
    material = studio.probe_material("ShaderNodeNewGeometry", "Position")
    tree = material.node_tree
    (out,) = (node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    moves = tree.nodes.new("ShaderNodeDisplacement")
    for name, value in (("Height", height), ("Midlevel", 0.0), ("Scale", 1.0)):
        moves.inputs[name].default_value = value
    tree.links.new(moves.outputs["Displacement"], out.inputs["Displacement"])
    material.displacement_method = "DISPLACEMENT"
    square.data.materials[0] = material


def _displaced_and_bent(studio, square):
    bend(square)
    _displaced(studio, square)


def _mirrored(studio, square):
    animate(square, "scale", (-1.0, 1.0, 1.0), (-1.0, 1.0, 1.0), (2.0, 1.0, 1.0))


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (_rolling, "a rolling shutter"),
        (_start, "a shutter that does not open about the frame"),
        (_curve, "a Shutter Curve that is not flat"),
        (_light, "motion blur of a moving light"),
        (_lens, "motion blur of lens, shift, clipping or focus"),
        (_hidden, "an object that appears or vanishes"),
        (_remeshed, "a mesh whose faces change"),
        (_velocity, "by the attribute 'velocity'"),
        (_mapped, "a deforming mesh whose material has a normal map or UV tangents"),
        (_displaced_and_bent, "a deforming mesh that a material displaces"),
        (_mirrored, "a scale of 0, or of one that changes its sign"),
    ],
    ids=lambda value: value.__name__.strip("_") if callable(value) else "",
)
def test_what_is_not_simulated_is_refused_by_name(studio, moving, change, what):
    """Each is refused with the option alone; the frame comes back."""
    change(studio, moving)
    studio.scene.frame_set(1, subframe=0.0 if change is _hidden else 0.5)
    before = studio.scene.frame_current, studio.scene.frame_subframe
    with pytest.raises(Refused, match=what):
        exported(studio)
    assert (studio.scene.frame_current, studio.scene.frame_subframe) == before
    with quiet():
        assert change is _hidden or job.export(studio.scene).motion is None


def test_a_displaced_mesh_moves_as_it_is(studio, moving):
    """A square that faces +z, 1 above the ground, is raised by 0.25 while it moves."""
    _displaced(studio, moving, height=0.25)
    scene = exported(studio)
    for time, at in ((0.0, (0.25, 0.5)), (1.0, (0.75, 1.5))):
        found = scene_at(scene, time).mesh.vertices[:, 4:]
        expected = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float).T + np.array(at)[:, None]
        np.testing.assert_allclose(found, np.vstack([expected, np.full(4, 1.25)]), atol=1e-5)


def test_partial_comparisons_refuse_it():
    with pytest.raises(EtalonError, match="leave --partial or --motion-blur out"):
        Settings(partial=True, motion_blur=True)


def test_the_neutral_state_keeps_it_where_asked(studio, moving):
    render = studio.scene.render
    with neutral(studio.scene, motion_blur=True) as changes:
        assert render.use_motion_blur
        assert changes.settings["render.motion_blur_shutter"] == 0.5
    with neutral(studio.scene) as changes:
        assert not render.use_motion_blur
    assert render.use_motion_blur


@pytest.mark.slow
@pytest.mark.compares_with_cycles
def test_cycles_shows_the_same_blur(studio, moving, seed):
    """A square turns and moves under a moving camera, beside one that deforms.

    Blocks agree within their errors.
    """
    if unknown_cycles():
        pytest.skip(unknown_cycles())
    animate(moving, "rotation_euler", (0.0, 0.0, 0.0), (0.0, 0.0, 0.5), (0.0, 0.0, 1.4))
    bend(studio.quad("blob", 0.5, z=0.5))
    animate(studio.camera, "location", (0.0, 0.0, 10.0), (0.0, 0.2, 10.0), (0.0, 0.6, 10.0))
    bright = studio.probe_material("ShaderNodeNewGeometry", "Position")
    moving.data.materials[0] = bright
    studio.scene.frame_set(1)
    studio.scene.render.motion_blur_shutter = 0.9
    studio.scene.render.resolution_x = studio.scene.render.resolution_y = 16
    reference = ReferenceRenderer(exported(studio), Options(threads=1, seed=seed))
    ours = np.array([reference.render(k, 64).radiance for k in range(12)])
    with quiet(), neutral(studio.scene, threads=1, motion_blur=True):
        cycles = CyclesRenderer(studio.scene, seed=seed % 1000, threads=1, motion_blur=True)
        theirs = np.array([cycles.render(k, 256).radiance for k in range(12)])
    left, right = (x.reshape(12, 4, 4, 4, 4, 3).mean(axis=(2, 4)) for x in (ours, theirs))
    error = np.sqrt((left.var(axis=0, ddof=1) + right.var(axis=0, ddof=1)) / 12)
    difference = np.abs(left.mean(axis=0) - right.mean(axis=0))
    assert (difference <= 6.0 * error + 2e-3 * np.abs(right).mean()).all()
    assert np.abs(left.mean(axis=0)).max() > 0.1
