# SPDX-License-Identifier: GPL-3.0-or-later
"""Toon: cones of uniform directions, and closed forms of what they reflect."""

import numpy as np
import pytest
from etalon.lib.bsdfs.toon import Toon, cone_half_angle
from etalon.tests.charts import Cone
from etalon.tests.chi2 import chi_square, sidak

COUNT = 100_000
LEVEL = 1e-3
SIZES = [(0.5, 0.0), (0.3, 0.4), (0.9, 0.6), (1.0, 0.0), (1e-4, 0.0), (0.0, 0.2)]


def viewer(cos_o, count):
    sine = np.sqrt(1.0 - cos_o**2)
    return np.repeat(np.array([[0.6 * sine], [0.8 * sine], [cos_o]]), count, axis=1)


def lobe(cos_o, size, smooth, glossy, count=COUNT):
    return Toon(viewer(cos_o, count), np.float64(size), np.float64(smooth), glossy)


@pytest.mark.parametrize("glossy", [False, True])
@pytest.mark.parametrize(("size", "smooth"), SIZES)
def test_toon_is_uniform_in_its_cone(size, smooth, glossy, rng):
    wi, weight, pdf = lobe(0.8, size, smooth, glossy).sample(*rng.random((2, COUNT)))
    wo = viewer(0.8, 1)[:, 0]
    axis = np.array([-wo[0], -wo[1], wo[2]]) if glossy else np.array([0.0, 0.0, 1.0])
    chart = Cone(axis, 1.0 - np.cos(cone_half_angle(np.float64(size), np.float64(smooth))))

    def density(directions):
        return lobe(0.8, size, smooth, glossy, directions.shape[1]).evaluate(directions)[1]

    kept = np.where(pdf > 0.0, wi, np.nan)
    assert chi_square(kept, density, chart, (8, 16), tolerance=3e-4).p_value > sidak(LEVEL, 2 * len(SIZES))
    value, density_there = lobe(0.8, size, smooth, glossy).evaluate(wi)
    inner = np.arccos(np.clip(axis @ wi, -1.0, 1.0)) < 0.999 * cone_half_angle(np.float64(size), np.float64(smooth))
    np.testing.assert_allclose(pdf[inner], density_there[inner], rtol=1e-12)
    np.testing.assert_allclose((weight * pdf)[:, inner], value[:, inner], rtol=1e-6)
    assert (wi[2, pdf > 0.0] > 0.0).all()


@pytest.mark.parametrize(("size", "smooth"), [(0.5, 0.0), (0.3, 0.4), (0.1, 0.9)])
def test_toon_reflects_the_mean_of_its_edge(size, smooth, rng):
    """A cone of half angle b, whose intensity falls from a on over w.

    It reflects (1 - (sin b - sin a) / w) / (1 - cos b) of the light.
    """
    _, weight, _ = lobe(0.8, size, smooth, False).sample(*rng.random((2, COUNT)))
    a, w = 0.5 * np.pi * size, 0.5 * np.pi * smooth
    expected = 1.0 if smooth == 0.0 else (1.0 - (np.sin(a + w) - np.sin(a)) / w) / (1.0 - np.cos(a + w))
    assert weight[0].mean() == pytest.approx(expected, abs=5.0 * weight[0].std() / np.sqrt(COUNT) + 1e-12)


def test_a_glossy_cone_loses_what_lies_below_the_horizon(rng):
    """At grazing half of a cone about the mirror direction lies below the surface."""
    _, weight, pdf = lobe(1e-9, 0.3, 0.0, True).sample(*rng.random((2, COUNT)))
    assert weight[0].mean() == pytest.approx(0.5, abs=5.0 * 0.5 / np.sqrt(COUNT))
    np.testing.assert_array_equal(weight[0] > 0.0, pdf > 0.0)


def test_a_viewer_behind_the_normal_sees_no_mirror_cone_but_the_normals():
    below = viewer(-0.2, 3)
    up = viewer(0.9, 3)
    assert not Toon(below, np.float64(1.0), np.float64(0.0), True).evaluate(up)[0].any()
    assert Toon(below, np.float64(1.0), np.float64(0.0), False).evaluate(up)[0].all()
