# SPDX-License-Identifier: GPL-3.0-or-later
"""Pointiness against angles that are known."""

import itertools

import numpy as np
import pytest
from etalon.lib.scene.pointiness import pointiness
from scipy.spatial.transform import Rotation

CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3))).T
SOLIDS = {
    # Corners, the length of an edge, the cosine between an edge and the outward normal at its end.
    "tetrahedron": (CORNERS[:, [0, 3, 5, 6]], np.sqrt(8.0), np.sqrt(2.0 / 3.0)),
    "cube": (CORNERS, 2.0, np.sqrt(1.0 / 3.0)),
    "octahedron": (np.hstack([np.eye(3), -np.eye(3)]), np.sqrt(2.0), np.sqrt(0.5)),
}


def edges_of_length(corners, length):
    pairs = itertools.combinations(range(corners.shape[1]), 2)
    return np.array([(a, b) for a, b in pairs if np.isclose(np.linalg.norm(corners[:, a] - corners[:, b]), length)]).T


def single(values):
    return np.asarray(values, np.float32)


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("outward", [1.0, -1.0])
def test_corners_of_regular_solids_have_the_angle_between_edge_and_normal(name, outward, rng):
    corners, length, cosine = SOLIDS[name]
    edges = edges_of_length(corners, length)
    turned = Rotation.from_rotvec(rng.normal(size=3)).apply(corners.T).T
    normals = outward * turned / np.linalg.norm(turned, axis=0)
    got = pointiness(single(turned * 3.0), single(normals), edges)
    assert np.allclose(got, np.arccos(-outward * cosine) / np.pi, atol=1e-6)


def test_a_plane_has_one_half(rng):
    flat = np.vstack([rng.random((2, 60)), np.zeros(60)])
    edges = np.array([(k, j) for k in range(60) for j in rng.choice(np.delete(np.arange(60), k), 3, replace=False)]).T
    turn = Rotation.from_rotvec(rng.normal(size=3))
    normal = np.repeat(turn.apply([[0.0, 0.0, 1.0]]).T, 60, axis=1)
    assert np.allclose(pointiness(single(turn.apply(flat.T).T), single(normal), edges), 0.5, atol=1e-6)


def test_a_vertex_has_the_mean_of_its_own_and_its_neighbours_values(rng):
    """A hub with spokes that slope down by an angle: 1/2 + angle at the hub, 1/2 - angle at the ends."""
    spokes, slope = 7, 0.4
    turns = 2.0 * np.pi * np.arange(spokes) / spokes
    ends = np.stack([np.cos(slope) * np.cos(turns), np.cos(slope) * np.sin(turns), np.full(spokes, -np.sin(slope))])
    positions = np.hstack([np.zeros((3, 1)), ends * rng.uniform(0.5, 2.0, spokes)])
    normals = np.repeat([[0.0], [0.0], [1.0]], spokes + 1, axis=1)
    got = pointiness(single(positions), single(normals), np.stack([np.zeros(spokes, int), 1 + np.arange(spokes)]))
    hub, end = 0.5 + slope / np.pi, 0.5 - slope / np.pi
    assert np.isclose(got[0], (hub + spokes * end) / (spokes + 1), atol=1e-6)
    assert np.allclose(got[1:], (hub + end) / 2.0, atol=1e-6)


def cube_of_single_faces():
    """Positions and normals of 24 vertices, and the 24 edges of six faces that share none."""
    positions, normals, edges = [], [], []
    for axis, side in itertools.product(range(3), (-1.0, 1.0)):
        face = CORNERS[:, CORNERS[axis] == side]
        edges.append(edges_of_length(face, 2.0) + 4 * len(normals))
        positions.append(face)
        normals.append(np.repeat(side * np.eye(3)[:, axis, None], 4, axis=1))
    return np.hstack(positions), np.hstack(normals), np.hstack(edges)


def test_faces_that_share_no_vertices_count_as_joined_where_their_corners_meet():
    positions, normals, edges = cube_of_single_faces()
    got = pointiness(single(positions), single(normals), edges)
    assert np.allclose(got, np.arccos(-np.sqrt(1.0 / 3.0)) / np.pi, atol=1e-6)


@pytest.mark.parametrize(
    ("offset", "joined"),
    [((3e-4, 0, 0), False), ((2e-4, -2e-4, 0), True), ((3e-4, -3e-4, 0), False), ((1e-7, 0, 0), True)],
)
def test_near_vertices_are_one_if_their_coordinates_have_one_sum(offset, joined):
    """Distances below sqrt(2^-23) = 3.45e-4 are near; all three offsets but one are, and two have other sums."""
    a, b = np.array([0.3, -0.2, 0.1]), np.array([1.3, 0.0, 0.4])
    positions = np.stack([a, a + np.array(offset), b, a + np.array([0.0, 0.0, 2.0])], axis=1)
    normals = np.repeat([[0.0], [0.0], [1.0]], 4, axis=1)
    got = pointiness(single(positions), single(normals), np.array([[0, 1, 2], [2, 3, 3]]))
    assert np.isclose(got[0], got[1]) == joined


def test_where_normals_cancel_the_angle_is_a_half_turn():
    """Two sheets back to back: their corners meet, and their normals cancel."""
    square = np.array([[0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0], [0.0] * 4])
    up = np.repeat([[0.0], [0.0], [1.0]], 4, axis=1)
    edges = np.array([[0, 1, 2, 3], [1, 2, 3, 0]])
    got = pointiness(single(np.hstack([square] * 2)), single(np.hstack([up, -up])), np.hstack([edges, edges + 4]))
    assert (got == 1.0).all()


@pytest.mark.parametrize("lengthless", [0.0, np.nan])
def test_an_edge_without_length_counts_as_two_neighbours_at_the_same_place(lengthless):
    """A vertex with one edge that rises by 30 degrees, and one edge to its own copy.

    Of the mean direction two thirds are 0: the cosine is 1/6. The other end looks down along the edge: 2/3 of a half turn.
    """
    positions = np.array([[0.0, 0.0, np.sqrt(0.75)], [0.0] * 3, [0.0, 0.0, 0.5]])
    normals = np.repeat([[0.0], [0.0], [1.0]], 3, axis=1)
    got = pointiness(single(positions), single(normals), np.array([[0, 0], [1, 2]]), lengthless)
    own = 1.0 if np.isnan(lengthless) else np.arccos(1.0 / 6.0) / np.pi
    assert np.allclose(got, [(3.0 * own + 2.0 / 3.0) / 4.0] * 2 + [(2.0 / 3.0 + own) / 2.0], atol=1e-6)


def test_a_vertex_without_edges_has_nothing():
    assert pointiness(np.zeros((3, 1), np.float32), np.zeros((3, 1), np.float32), np.zeros((2, 0), int)) == 0.0
    assert pointiness(np.zeros((3, 0), np.float32), np.zeros((3, 0), np.float32), np.zeros((2, 0), int)).size == 0
