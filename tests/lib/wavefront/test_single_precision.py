# SPDX-License-Identifier: GPL-3.0-or-later
"""The rounding of points on triangles, and of rays that leave them, against Embree itself."""

import numpy as np
import pytest
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from etalon.lib.wavefront.single_precision import corners_of, meet, place
from etalon.tests import scenes

COUNT = 20_000


def points(rng, mesh):
    """Points on the first triangle, by the formula of Cycles, and directions about them."""
    u, v = np.sort(rng.random((2, COUNT)), axis=0)
    u, v = u, v - u
    corners = corners_of(mesh, np.zeros(COUNT, np.int32))
    direction = rng.standard_normal((3, COUNT))
    return corners, place(corners, u, v), direction / np.linalg.norm(direction, axis=0)


def triangle(rng, size=3.0):
    return scenes.mesh(scenes.Part(rng.uniform(-size, size, (3, 3)), np.array([[0], [1], [2]])))


@pytest.mark.parametrize("case", range(4))
def test_rays_that_leave_a_triangle_meet_a_copy_of_it_where_embree_says_so(rng, case):
    """Embree in its robust mode, as Cycles uses it. Processors without fused products round otherwise now and then."""
    mesh = triangle(rng)
    corners, origin, direction = points(rng, mesh)
    scene = EmbreeScene(robust=True)
    kept = TriangleMesh(scene, mesh.vertices.T.astype(np.float32), np.array([[0, 1, 2]], np.int32))
    there = scene.run(np.stack(origin, axis=1), np.ascontiguousarray(direction.T, np.float32), output=True)
    hits, meets = meet(corners, origin, direction), there["primID"] >= 0
    assert kept is not None
    assert np.mean(hits.meets == meets) > 0.99
    assert 0.3 < meets.mean() < 0.7
    both = hits.meets & meets
    assert hits.u[both] == pytest.approx(there["u"][both], abs=1e-6)
    assert hits.v[both] == pytest.approx(there["v"][both], abs=1e-6)


def test_a_ray_from_afar_meets_a_triangle_where_it_lies(rng):
    """Points by barycentrics in float64, seen from a metre off along the ray."""
    mesh = triangle(rng)
    corners, origin, direction = points(rng, mesh)
    away = [place - along.astype(np.float32) for place, along in zip(origin, direction, strict=True)]
    hits = meet(corners, away, direction)
    steep = np.abs(np.cross(*(np.diff(mesh.vertices, axis=1).T)) @ direction) > 1.0
    assert hits.meets[steep].mean() > 0.999
    assert hits.distance[steep & hits.meets] == pytest.approx(1.0, abs=1e-4)
    assert not meet(corners, away, -direction).meets[steep].any()


def test_a_ray_within_the_plane_meets_nothing(rng):
    flat = scenes.mesh(
        scenes.Part(np.array([[-1.3, 2.1, 0.4], [0.2, -0.7, 1.9], [3.7] * 3]), np.array([[0], [1], [2]]))
    )
    corners, origin, direction = points(rng, flat)
    direction[2] = 0.0
    assert not meet(corners, origin, direction).meets.any()


def test_a_point_in_a_plane_along_two_axes_lies_in_it_exactly(rng):
    mesh = scenes.mesh(
        scenes.Part(np.array([[-1.3, 2.1, 0.4], [0.2, -0.7, 1.9], [3.7] * 3]), np.array([[0], [1], [2]]))
    )
    corners, origin, direction = points(rng, mesh)
    hits = meet(corners, origin, direction)
    assert (hits.distance == 0.0).all()
    assert hits.meets.mean() > 0.999
