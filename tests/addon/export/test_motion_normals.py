# SPDX-License-Identifier: GPL-3.0-or-later
"""Normals of smooth meshes that deform while the shutter is open."""

import bpy
import numpy as np
import pytest
from etalon.addon.cycles.renderer import CyclesRenderer, neutral
from etalon.addon.host.quiet import quiet
from etalon.lib.errors import Refused
from etalon.lib.scene.moment import scene_at
from etalon.lib.settings.reference import Options
from etalon.lib.wavefront.moments import SHUTTER_ENDS
from etalon.lib.wavefront.render import ReferenceRenderer
from etalon.tests.addon.export.test_mesh import (
    all_smooth,
    custom,
    folded,
    one_sharp_edge,
    one_sharp_face,
    only_sharp_edges,
    sharp_face_and_edge,
)
from etalon.tests.addon.export.test_motion import animate, exported
from etalon.tests.conftest import unknown_cycles
from mathutils import Euler, Matrix

TURNED = Euler((0.2, -0.3, 0.4)).to_matrix().to_4x4() @ Matrix.Diagonal((0.4, 1.2, 2.4, 1.0))
MIRRORED = TURNED @ Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0))


def fold_over(thing):
    """A shape key that turns the slopes of `folded` round from frame 0 to frame 2, more on one side."""
    thing.shape_key_add(name="rest")
    shape = thing.shape_key_add(name="over")
    for point in shape.data:
        point.co.z = -1.6 * point.co.z + 0.5 * point.co.y
        point.co.x *= 0.9
    animate(shape, "value", 0.0, 0.5, 1.0)


@pytest.fixture
def blurred(studio):
    """The scene at frame 1, with a shutter from frame 0 to frame 2."""
    studio.look_down(2.47)
    studio.scene.render.use_motion_blur = True
    studio.scene.render.motion_blur_shutter = 2.0
    studio.scene.frame_set(1)
    return studio


def deforming(studio, shade=all_smooth, matrix=None):
    """`folded`, shaded by `shade`, while it folds over."""
    thing = folded(studio, matrix)
    shade(thing.data)
    fold_over(thing)
    studio.scene.frame_set(1)
    return thing


def share(studio, thing, matrix):
    """Two instances of `thing` in place of it, one of them out of sight."""
    inner = bpy.data.collections.new("inner")
    studio.scene.collection.objects.unlink(thing)
    inner.objects.link(thing)
    for name, place in (("one", (0, 0, 0)), ("two", (9, 0, 0))):
        group = studio.add(name, None, Matrix.Translation(place) @ matrix)
        group.instance_type, group.instance_collection = "COLLECTION", inner


def vertex_normals(thing, value):
    """(3, v) unit normals of the vertices of `folded` by the angles of its faces.

    The value of the shape key is `value`; Max's weights (1999), which are Blender's.
    """
    rest, over = (np.array([p.co for p in thing.data.shape_keys.key_blocks[name].data]).T for name in ("rest", "over"))
    points, sums = (1.0 - value) * rest + value * over, np.zeros_like(rest)
    for face in thing.data.polygons:
        ring = np.array(face.vertices)
        # Newell's normal of a polygon.
        here, ahead = points[:, ring], points[:, np.roll(ring, -1)]
        normal = np.cross(here, ahead, axis=0).sum(axis=1)
        normal /= np.linalg.norm(normal)
        to, fro = ahead - here, points[:, np.roll(ring, 1)] - here
        cosine = (to * fro).sum(axis=0) / (np.linalg.norm(to, axis=0) * np.linalg.norm(fro, axis=0))
        sums[:, ring] += np.arccos(cosine) * normal[:, None]
    return sums / np.linalg.norm(sums, axis=0)


def test_normals_at_the_keys_are_those_of_the_deformed_faces(blurred):
    thing = deforming(blurred)
    scene = exported(blurred)
    assert scene.motion.normals[0].shape == (3, 3, 3, 6)
    for time in (0.0, 0.5, 1.0):
        mesh = scene_at(scene, time).mesh
        expected = vertex_normals(thing, time)[:, mesh.triangles].transpose(1, 0, 2)
        np.testing.assert_allclose(mesh.corner_normals, expected, atol=1e-5)


def test_normals_are_mixed_in_the_world_for_one_user_and_in_the_object_for_two(blurred):
    """As in Cycles, which turns a mesh with one user into the world first."""
    thing = deforming(blurred, matrix=TURNED)
    alone = exported(blurred).motion
    assert not alone.objects
    turn = np.linalg.inv(np.array(thing.matrix_world)[:3, :3]).T
    thing.matrix_world = Matrix()
    share(blurred, thing, TURNED)
    scene = exported(blurred)
    assert list(scene.motion.objects) == list(scene.motion.normals) == [0, 1]
    faces = scene.mesh.triangles[:, scene.mesh.object_index == 0]
    for key, value in enumerate((0.0, 0.5, 1.0)):
        local = vertex_normals(thing, value)
        world = turn @ local
        world /= np.linalg.norm(world, axis=0)
        for motion, expected in ((scene.motion, local), (alone, world)):
            # Blender takes the angles by an arc cosine with an error of up to 7e-5.
            np.testing.assert_allclose(motion.normals[0][key], expected[:, faces].transpose(1, 0, 2), atol=1e-4)


def test_faces_without_area_are_left_out_of_the_normals(blurred):
    thing = folded(blurred)
    mesh = blurred.mesh(
        "with a sliver",
        [*(v.co for v in thing.data.vertices), (0, 0, 3), (0, 0, 4), (0, 0, 5)],
        [(8, 9, 10), *(tuple(p.vertices) for p in thing.data.polygons)],
    )
    mesh.polygons.foreach_set("use_smooth", [True] * 4)
    bpy.data.objects.remove(thing)
    thing = blurred.add("sliver", mesh)
    fold_over(thing)
    blurred.scene.frame_set(1)
    scene = exported(blurred)
    assert scene.motion.normals[0].shape == (3, 3, 3, 6)
    found = scene_at(scene, 0.0).mesh
    rest = np.array([p.co for p in thing.data.shape_keys.key_blocks["rest"].data]).T
    assert found.vertices[:, :8] == pytest.approx(rest[:, :8], abs=1e-6)


def test_a_mesh_that_slides_keeps_its_normals(blurred):
    """Its vertices move and its normals do not."""
    thing = folded(blurred)
    all_smooth(thing.data)
    thing.shape_key_add(name="rest")
    shape = thing.shape_key_add(name="aside")
    for point in shape.data:
        point.co.x += 0.5
    animate(shape, "value", 0.0, 0.5, 1.0)
    blurred.scene.frame_set(1)
    scene = exported(blurred)
    normals = scene.motion.normals[0]
    np.testing.assert_allclose(normals, np.broadcast_to(normals[:1], normals.shape), atol=1e-6)
    np.testing.assert_allclose(scene_at(scene, 0.2).mesh.corner_normals, scene.mesh.corner_normals, atol=1e-6)


def test_custom_normals_are_refused_before_blender_5_2(blurred):
    """Cycles has them at the frame alone there."""
    deforming(blurred, custom)
    if bpy.app.version >= (5, 2, 0):
        assert exported(blurred).motion.normals
        return
    with pytest.raises(Refused, match=r"a deforming mesh with custom normals, before Blender 5\.2"):
        exported(blurred)


CASES = {
    "smooth": (all_smooth, None, False, False),
    "turned": (all_smooth, TURNED, False, False),
    "mirrored": (all_smooth, MIRRORED, False, False),
    "two users": (all_smooth, TURNED, True, False),
    "moving": (all_smooth, TURNED, False, True),
    "moving mirrored": (all_smooth, MIRRORED, False, True),
    "sharp face": (one_sharp_face, TURNED, False, False),
    "sharp edge": (one_sharp_edge, TURNED, False, False),
    "sharp face and edge": (sharp_face_and_edge, None, False, False),
    "sharp edges": (only_sharp_edges, None, False, False),
    "custom": (custom, None, False, False),
}


@pytest.mark.slow
@pytest.mark.compares_with_cycles
@pytest.mark.parametrize("case", CASES)
def test_cycles_shows_the_same_mean_normal(blurred, seed, case):
    """A surface that glows with its normal, in blocks of the image."""
    if unknown_cycles():
        pytest.skip(unknown_cycles())
    if case == "custom" and bpy.app.version < (5, 2, 0):
        pytest.skip("custom normals are refused before Blender 5.2")
    shade, matrix, shared, moving = CASES[case]
    blurred.plain = blurred.probe_material("ShaderNodeNewGeometry", "Normal", offset=2.0)
    thing = deforming(blurred, shade, None if shared else matrix)
    if shared:
        share(blurred, thing, matrix)
    if moving:
        start = np.array(thing.rotation_euler)
        animate(thing, "rotation_euler", *(tuple(start + 0.3 * k * np.array([1.0, 0.5, -1.0])) for k in (-1, 0, 1)))
    blurred.scene.frame_set(1)
    blurred.scene.render.resolution_x = blurred.scene.render.resolution_y = 8
    # Without it the ends of a trail are off by more than the noise.
    options = Options(threads=1, seed=seed, departures=frozenset({SHUTTER_ENDS}))
    reference = ReferenceRenderer(exported(blurred), options)
    rounds = 32 if moving else 16  # where all moves, the moments are what is noisy; a replicate has as many of them
    ours = np.array([reference.render(k, 8192 // rounds).radiance for k in range(rounds)])
    with quiet(), neutral(blurred.scene, threads=1, motion_blur=True):
        cycles = CyclesRenderer(blurred.scene, seed=seed % 1000, threads=1, motion_blur=True)
        theirs = np.array([cycles.render(k, 1024).radiance for k in range(12)])
    ours, theirs = (x.reshape(-1, 4, 2, 4, 2, 3).mean(axis=(2, 4)) for x in (ours, theirs))
    error = np.sqrt(sum(x.var(axis=0, ddof=1) / len(x) for x in (ours, theirs)))
    difference = np.abs(ours.mean(axis=0) - theirs.mean(axis=0))
    # Cycles from 5.1 on keeps normals in 2 x 16 bits.
    assert (difference <= 6.0 * error + 2e-4).all()
    assert error.max() < 8e-3
