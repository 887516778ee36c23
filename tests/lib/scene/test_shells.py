# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed meshes, and how often they enclose a point."""

import numpy as np
import pytest
from etalon.lib.scene.shells import find_defect, winding_number
from etalon.tests.scenes import cube, icosphere


@pytest.mark.parametrize(("place", "turns"), [((0.0, 0.1, 0.2), 1), ((1.5, 0.1, 0.2), 0), ((-0.99, 0.9, 0.9), 1)])
def test_winding_numbers_of_a_cube(place, turns):
    part = cube()
    corners = part.vertices[:, part.triangles].transpose(1, 0, 2)
    point = np.array(place)[:, None]
    assert winding_number(point, corners) == pytest.approx(turns, abs=1e-12)
    assert winding_number(point, corners[::-1]) == pytest.approx(-turns, abs=1e-12)


def test_triangles_with_corners_of_their_own_are_closed():
    """As the faces of one mesh with sharp edges, or of one that was written face by face."""
    part = icosphere(subdivisions=2)
    corners = part.triangles.T.ravel()
    assert find_defect(part.vertices[:, corners], np.arange(corners.size).reshape(-1, 3).T) == ""


def test_many_balls_beside_each_other_are_closed(rng):
    part = icosphere(subdivisions=1)
    places = np.stack(np.meshgrid(*3 * [np.arange(4)]), axis=-1).reshape(-1, 3) * 2.5
    vertices = np.concatenate([part.vertices + place[:, None] for place in places], axis=1)
    triangles = np.concatenate([part.triangles + k * part.vertices.shape[1] for k in range(64)], axis=1)
    assert find_defect(vertices, triangles) == ""
    assert find_defect(vertices, triangles[:, rng.permutation(triangles.shape[1])]) == ""
    inside_out = np.concatenate([triangles[::-1, :80], triangles[:, 80:]], axis=1)
    assert find_defect(vertices, inside_out) == "its parts overlap, or point inwards"
