# SPDX-License-Identifier: GPL-3.0-or-later
"""FLIP against its closed form."""

import numpy as np
import pytest
from etalon.lib.report import flip as flip_of_tiles
from etalon.lib.report.flip import flip


def _hunt(linear):
    """L*, a*, b* of a linear Rec. 709 colour (D65) with the Hunt effect.

    FLIP compares them (section 3 of the paper).
    """
    to_xyz = np.array([[0.412391, 0.357584, 0.180481], [0.212639, 0.715169, 0.072192], [0.019331, 0.119195, 0.950532]])
    xyz = to_xyz @ np.asarray(linear, float) / to_xyz.sum(axis=1)
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    lightness = 116 * f[1] - 16
    return np.array([lightness, 0.01 * lightness * 500 * (f[0] - f[1]), 0.01 * lightness * 200 * (f[1] - f[2])])


def _flip_of_uniform(one, other):
    """FLIP of two images without any feature.

    HyAB to the power 0.7, its lower 0.4 spread over 0.95 (Andersson et al. 2020, section 3.3).
    """

    def hyab(a, b):
        d = _hunt(a) - _hunt(b)
        return (abs(d[0]) + np.hypot(d[1], d[2])) ** 0.7

    most = hyab((0, 1, 0), (0, 0, 1))
    low = 0.4 * most
    error = hyab(one, other)
    return 0.95 * error / low if error < low else 0.95 + 0.05 * (error - low) / (most - low)


@pytest.mark.parametrize("color", [(1.0, 1.0, 1.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])
def test_flip_of_uniform_images_is_its_closed_form(color):
    black = np.zeros((64, 64, 3))
    expected = _flip_of_uniform((0.0, 0.0, 0.0), color)
    np.testing.assert_allclose(flip(black, black + np.array(color), 0.0), expected, atol=2e-3)


def test_flip_sees_what_is_shown():
    """Equal images are 0; what is brighter than white is white, and one stop less it is not.

    A pixel that is not finite has no value.
    """
    white = np.ones((64, 64, 3))
    assert flip(white, white, 1.0).max() == 0.0
    assert flip(white, 1.5 * white, 0.0).max() == 0.0
    assert flip(white, 1.5 * white, -1.0).min() > 0.01
    broken = white.copy()
    broken[3, 4, 0] = np.nan
    assert np.argwhere(np.isnan(flip(white, broken, 0.0))).tolist() == [[3, 4]]


def test_tiles_make_the_same_map_as_the_whole_image(rng, monkeypatch):
    reference = rng.random((70, 90, 3))
    candidate = reference * rng.uniform(0.8, 1.2, (70, 90, 1))
    whole = flip(reference, candidate, 0.0)
    monkeypatch.setattr(flip_of_tiles, "TILE", 32)
    np.testing.assert_array_equal(flip(reference, candidate, 0.0), whole)
