# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene at one moment of the time in which the shutter is open."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.errors import SceneError
from etalon.lib.scene.checks import validate
from etalon.lib.scene.mesh import Object
from etalon.lib.scene.moment import scene_at
from etalon.lib.scene.motion import Motion
from etalon.lib.scene.placements import LocalMesh, Placements
from etalon.tests.scenes import emission, icosphere, orthographic, quad, scene
from etalon.tests.turns import turned


def test_what_deforms_and_moves_is_placed_by_both():
    """Vertices lie between their keys, in object space, then the object's map applies.

    What stands still keeps its arrays.
    """
    still, moving = quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((2, 0, 0), (1, 0, 0), (0, 1, 0))
    one = scene((still, moving), emission(1.0), orthographic(4, 4, 2.0, (0, 0, 1)))
    local = np.array([moving.vertices, 3.0 * moving.vertices])
    motion = Motion(objects={1: np.array([turned(0.0), turned(np.pi / 2.0, at=(0, 0, 4))])}, positions={1: local})
    found = scene_at(replace(one, motion=motion), 0.5)
    expected = turned(np.pi / 4.0, at=(0, 0, 2))
    np.testing.assert_allclose(
        found.mesh.vertices[:, 4:], expected[:, :3] @ (2.0 * moving.vertices) + expected[:, 3:], atol=1e-12
    )
    np.testing.assert_array_equal(found.mesh.vertices[:, :4], still.vertices)
    np.testing.assert_allclose(found.mesh.objects[1].world_from_object, expected, atol=1e-12)
    assert found.camera is one.camera
    assert found.motion is None
    assert scene_at(one, 0.3) is one


def test_normals_of_what_turns_and_stretches_are_those_of_the_same_mesh_placed_there():
    """A smooth sphere that turns, stretched.

    Its normals mix as those of an instance that stands where it is half way.
    """
    vertices, triangles = icosphere(subdivisions=1).vertices, icosphere(subdivisions=1).triangles
    normals = vertices[:, triangles].transpose(1, 0, 2).astype(np.float32)
    count = triangles.shape[1]
    local = LocalMesh(
        vertices.astype(np.float32), triangles, np.zeros(count, np.int32), np.ones(count, bool), normals, {}, None, {}
    )
    keys = [turned(0.2, (1.0, 2.0, 3.0)), turned(1.0, (1.0, 2.0, 3.0))]

    def placed(*matrices):
        placements = Placements()
        for matrix in matrices:
            placements.add(Object("ball", matrix), local, np.zeros(1, np.int32))
        return placements.join(frozenset(), False)

    one = scene(quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), emission(1.0), orthographic(4, 4, 2.0, (0, 0, 1)))
    found = scene_at(replace(one, mesh=placed(keys[0]), motion=Motion(objects={0: np.array(keys)})), 0.5).mesh
    # Two users: the normals keep the lengths that the transform gives them.
    there = placed(turned(0.6, (1.0, 2.0, 3.0)), turned(0.6, (1.0, 2.0, 3.0)))
    np.testing.assert_allclose(found.vertices, there.vertices[:, : found.vertices.shape[1]], atol=1e-6)
    middle, expected = found.corner_normals.mean(axis=0), there.corner_normals[:, :, :count].mean(axis=0)
    middle, expected = (x / np.linalg.norm(x, axis=0) for x in (middle, expected))
    np.testing.assert_allclose(middle, expected, atol=1e-6)
    apart = (found.corner_normals / np.linalg.norm(found.corner_normals, axis=1, keepdims=True)).mean(axis=0)
    assert np.abs(apart / np.linalg.norm(apart, axis=0) - expected).max() > 1e-3, "unit normals would mix otherwise"


def wobbling():
    """A smooth ball that is squeezed to half its height, with its exact normals at both keys."""
    ball = icosphere(subdivisions=1, smooth=True)
    one = scene(ball, emission(1.0), orthographic(4, 4, 2.0, (0, 0, 1)))
    squeezed = ball.vertices * np.array([[1.0], [1.0], [0.5]])
    slopes = ball.vertices * np.array([[1.0], [1.0], [2.0]])
    corners = [
        x[:, ball.triangles].transpose(1, 0, 2) for x in (ball.vertices, slopes / np.linalg.norm(slopes, axis=0))
    ]
    positions = np.array([ball.vertices, squeezed])
    return one, Motion(positions={0: positions}, normals={0: np.array(corners, np.float32)})


def test_normals_of_what_deforms_are_its_own_at_the_keys():
    """Of a ball that becomes an ellipsoid: half way they are the unit vectors between both."""
    one, motion = wobbling()
    for time, key in ((0.0, 0), (1.0, 1)):
        found = scene_at(replace(one, motion=motion), time).mesh.corner_normals
        np.testing.assert_allclose(found, motion.normals[0][key], atol=1e-6)
    middle = motion.normals[0].sum(axis=0)
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    np.testing.assert_allclose(scene_at(replace(one, motion=motion), 0.5).mesh.corner_normals, middle, atol=1e-6)


def test_normals_of_what_deforms_and_is_stretched_are_those_of_the_stretched_surface():
    """The ellipsoid, turned and stretched: its normals are at right angles to tangents that the map moves as it moves points."""
    one, motion = wobbling()
    matrix = turned(0.7, (2.0, 0.5, 1.5), axis=(1.0, 2.0, -1.0))
    keys = np.array([matrix, matrix])
    found = scene_at(replace(one, motion=replace(motion, objects={0: keys})), 1.0).mesh.corner_normals
    local = motion.normals[0][1].astype(float)
    for axis in np.eye(3):
        tangent = np.cross(local, axis[None, :, None], axis=1)
        moved = np.einsum("ij,cjt->cit", matrix[:, :3], tangent)
        np.testing.assert_allclose(np.einsum("cit,cit->ct", found, moved), 0.0, atol=1e-5)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda motion: replace(motion, normals={}), "deform and have smooth faces"),
        (lambda motion: replace(motion, positions={}), "deform and have smooth faces"),
        (lambda motion: replace(motion, normals={0: motion.normals[0][:, :, :, 1:]}), "has shape"),
        (lambda motion: replace(motion, normals={0: 2.0 * motion.normals[0]}), "not of unit length"),
    ],
)
def test_normals_that_do_not_belong_are_named(change, what):
    one, motion = wobbling()
    validate(replace(one, motion=motion))
    with pytest.raises(SceneError, match=what):
        validate(replace(one, motion=change(motion)))
