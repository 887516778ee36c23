# SPDX-License-Identifier: GPL-3.0-or-later
"""Tiles of images, from the definition of their numbers."""

import numpy as np
import pytest
from etalon.lib.scene import expressions as ex
from etalon.lib.textures.evaluate import evaluate
from etalon.lib.textures.images import ImageSet
from etalon.lib.textures.tiles import lies_in_tile, tile_corner


@pytest.mark.parametrize(
    ("number", "corner"), [(1001, (0, 0)), (1002, (1, 0)), (1010, (9, 0)), (1011, (0, 1)), (1034, (3, 3))]
)
def test_a_tile_has_its_corner_and_is_a_unit_square(number, corner, rng):
    assert tile_corner(number) == corner
    within = rng.random((3, 50)) + np.array([[*corner, 0.0]]).T
    assert lies_in_tile(within, number).all()
    for step in ([2.0, 0.0, 0.0], [0.0, -2.0, 0.0]):
        assert not lies_in_tile(within + np.array([step]).T, number).any()


@pytest.mark.parametrize(
    ("place", "number"), [((-0.5, 0.5), 1001), ((1.5, -0.5), 1002), ((-1.5, 1.5), None), ((10.5, 0.5), None)]
)
def test_the_first_tiles_reach_to_minus_one_and_there_are_ten_columns(place, number):
    point = np.array([[*place, 0.0]]).T
    assert [k for k in range(1001, 1031) if lies_in_tile(point, k)] == ([number] if number else [])


def test_a_point_shows_its_tile_and_elsewhere_the_rest():
    class Points:
        size = 3

        def coordinates(self, kind, uv_map):
            return np.array([[0.5, 1.5, 2.5], [0.5, 0.5, 0.5], [0.0, 0.0, 0.0]])

    uv = ex.Coordinates("UV")
    shown = ex.Tile(uv, 1001, ex.Constant(2.0), ex.Tile(uv, 1002, ex.Constant(3.0), ex.Constant(5.0)))
    np.testing.assert_array_equal(evaluate(shown, Points(), ImageSet(())), [2.0, 3.0, 5.0])
