# SPDX-License-Identifier: GPL-3.0-or-later
"""What rays meet, as values."""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.wavefront.casters import Casters
from etalon.lib.wavefront.frame import weighted_median
from etalon.lib.wavefront.raycaster import Hits, Raycaster
from etalon.tests import scenes


def hits(*triangles):
    """Hits of these triangles at distances of their own."""
    numbers = np.array(triangles, float)
    return Hits(np.array(triangles, np.int32), numbers, numbers / 8.0, numbers / 16.0)


def test_replacing_hits_leaves_both_as_they_were():
    first, second = hits(1, 2, 3), hits(-1, 5)
    merged = first.replaced(np.array([2, 0]), second)
    for name in ("triangle", "distance", "u", "v"):
        np.testing.assert_array_equal(getattr(merged, name), getattr(hits(5, 2, -1), name))
        np.testing.assert_array_equal(getattr(first, name), getattr(hits(1, 2, 3), name))
        np.testing.assert_array_equal(getattr(second, name), getattr(hits(-1, 5), name))
    assert merged.triangle.dtype == np.int32


FAR = [10.0, 1e4, 1e8, 1e15, 9e17]
CARD = scenes.quad((-0.5, -0.5, 1e-4), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def assert_card_shades_floor(caster):
    """A card 0.1 mm above a floor is met where it is and shades the floor.

    The two are the first of the mesh.
    """
    x = np.linspace(-0.95, 0.95, 20)
    origin, down = np.stack([x, 0.3 * x, np.full(20, 2.0)]), np.tile([[0.0], [0.0], [-1.0]], 20)
    found = caster.closest(origin, down)
    inside = np.abs(x) < 0.5
    assert (found.triangle // 2).tolist() == inside.astype(int).tolist()
    np.testing.assert_allclose(found.distance, np.where(inside, 2.0 - 1e-4, 2.0), atol=1e-6)
    point, normal, offset = caster.on_plane(np.where(x < 0.0, 1, 0), np.stack([x, 0.3 * x, 0.0 * x]))
    assert offset.max() < 1e-5
    np.testing.assert_array_equal(caster.occluded(point + offset * normal, -down, np.full(20, np.inf)), inside)


@pytest.mark.parametrize("far", FAR)
def test_one_face_far_away_moves_no_other(far):
    aside = scenes.quad((far, 0.0, 0.0), (1.0 + 0.1 * far, 0.0, 0.0), (0.0, 1.0 + 0.1 * far, 0.0))
    assert_card_shades_floor(Raycaster(scenes.mesh(scenes.floor(), CARD, aside)))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("far", FAR)
def test_a_far_object_of_many_faces_moves_no_near_one(far, sign):
    """20,480 faces against two objects of two, or against one of four and the camera."""
    mesh = scenes.mesh(scenes.floor(), CARD, scenes.icosphere(0.05 * far, 5))
    far_vertices = np.arange(mesh.vertices.shape[1]) >= 8
    mesh.vertices[0, far_vertices] += sign * far
    assert_card_shades_floor(Raycaster(mesh))
    one = replace(mesh, object_index=np.maximum(mesh.object_index - 1, 0), objects=mesh.objects[1:])
    camera = np.array([0.3, 0.2, 2.0])
    assert_card_shades_floor(Casters(one, camera).whole)


def test_a_weighted_median_is_the_median_of_repeated_values(rng):
    values, times = rng.standard_normal(31), rng.integers(1, 6, 31)
    repeated = np.sort(np.repeat(values, times))
    assert weighted_median(values, times) == repeated[(repeated.size + 1) // 2 - 1]
