# SPDX-License-Identifier: GPL-3.0-or-later
"""Luminance, HSV and HSL, against IEC's numbers and Python's colorsys."""

import colorsys

import numpy as np
import pytest
from etalon.lib.textures import color_spaces as cs


def test_white_has_luminance_one():
    assert cs.luminance(np.ones(3)) == pytest.approx(1.0, abs=1e-12)


def test_hsv_and_hsl_are_those_of_colorsys(rng):
    color = rng.random((3, 500))
    color[:, :3] = [[0.0, 1.0, 0.4]] * 3  # black, white, grey
    hsv = np.array([colorsys.rgb_to_hsv(*c) for c in color.T]).T
    hls = np.array([colorsys.rgb_to_hls(*c) for c in color.T]).T
    np.testing.assert_allclose(cs.rgb_to_hsv(color), hsv, atol=1e-12)
    np.testing.assert_allclose(cs.rgb_to_hsl(color), hls[[0, 2, 1]], atol=1e-12)
    np.testing.assert_allclose(cs.hsv_to_rgb(hsv), color, atol=1e-12)
    np.testing.assert_allclose(cs.hsl_to_rgb(hls[[0, 2, 1]]), color, atol=1e-12)


@pytest.mark.parametrize("hue", [-0.7, -2.0, 1.3, 2.9])
def test_a_hue_outside_the_turn_counts_to_the_last_sector(hue):
    """value, p and q as Smith's algorithm has them, with the place in the hue's own sector."""
    place = hue * 6 - np.floor(hue * 6)
    rgb = cs.hsv_to_rgb(np.array([[hue], [0.8], [0.5]]))[:, 0]
    assert rgb == pytest.approx([0.5, 0.5 * 0.2, 0.5 * (1 - 0.8 * place)], abs=1e-12)


def test_lightness_is_at_most_one_and_a_scale_of_zero_is_no_saturation():
    _, s, lightness = cs.rgb_to_hsl(np.array([[3.0, 2.0], [2.0, 0.5], [0.0, 0.0]]))
    assert lightness == pytest.approx([1.0, 1.0])
    assert s[0] == pytest.approx(-3.0)
    assert np.isinf(s[1])
