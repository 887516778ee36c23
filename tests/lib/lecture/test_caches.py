# SPDX-License-Identifier: GPL-3.0-or-later
"""Form factors, radiosity and irradiance caching of the box.

They are compared with closed forms, and with path tracing.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.lecture.box import find_harmonic_distance, find_plain_pixels, make_patches
from etalon.lib.lecture.caches import GatheredBox, compare_pictures, trace_box
from etalon.lib.lecture.radiosity import form_factors, point_form_factors, solve_radiosity


def test_form_factors_of_a_cube_have_their_closed_form():
    """Opposite faces of a cube: Howell's catalogue, C-11, with X = Y = 1.

    The light of a patch arrives somewhere.
    """
    factors = form_factors(make_patches(8))
    np.testing.assert_allclose(factors.sum(axis=1), 1.0, atol=1e-12)
    walls = factors.reshape(6, 64, 6, 64).sum(axis=3).mean(axis=1)
    opposite = (
        2.0 / np.pi * (np.log(2.0 / np.sqrt(3.0)) + 2.0 * np.sqrt(2.0) * np.arctan(1.0 / np.sqrt(2.0)) - np.pi / 2.0)
    )
    assert walls[0, 1] == pytest.approx(opposite, abs=1e-5)
    np.testing.assert_allclose(walls, walls.T, atol=1e-5)


def test_form_factor_of_a_point_below_the_corner_of_a_square_has_its_closed_form():
    """Howell's catalogue, B-3.

    A unit square at height 1 above a corner, parallel to the element.
    """
    square = np.array([[[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]])
    found = point_form_factors(np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]), square)
    expected = 2.0 / (2.0 * np.pi) / np.sqrt(2.0) * np.arctan(1.0 / np.sqrt(2.0))
    assert found[0, 0] == pytest.approx(expected, rel=1e-12)


def test_radiosity_of_a_furnace_is_emission_over_what_is_absorbed():
    patches = make_patches(4)
    furnace = replace(patches, albedos=np.full_like(patches.albedos, 0.6), emitted=np.ones_like(patches.emitted))
    np.testing.assert_allclose(solve_radiosity(furnace), 2.5, rtol=1e-12)


def test_harmonic_distance_in_the_middle_of_the_floor_is_that_of_quadrature(rng):
    z = np.sqrt(rng.random(200_000))
    phi = 2.0 * np.pi * rng.random(z.size)
    x, y = np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi)
    nearest = np.maximum(np.maximum(np.abs(x), np.abs(y)) / 0.5, z)  # 1 / distance
    found = find_harmonic_distance(np.array([[0.5, 0.5, 0.0]]), np.array([[0.0, 0.0, 1.0]]))
    assert found[0] == pytest.approx(1.0 / nearest.mean(), rel=0.01)


@pytest.mark.slow
def test_gathered_light_agrees_with_path_tracing_and_the_cache_comes_nearer_as_it_is_refined(seed):
    traced, plain = trace_box(seed, samples=8, replicates=8), find_plain_pixels()
    gathered = GatheredBox(4)
    exact = gathered.exact()
    # Pixels are independent; 96 patches leave an error of some tenths of a per cent besides the noise of the mean.
    noise = np.sqrt(np.square(traced.standard_error[plain]).sum()) / traced.mean[plain].sum()
    assert abs(compare_pictures(exact, traced.mean)[0]) < 5.0 * noise + 0.005
    (coarse, few), (fine, many) = (gathered.cached(accuracy) for accuracy in (0.5, 0.25))
    assert many > 2 * few
    errors = [compare_pictures(picture, exact) for picture in (coarse, fine)]
    assert abs(errors[1][0]) < 0.005 < errors[0][1] < 0.08
    assert errors[1][1] < 0.6 * errors[0][1]
