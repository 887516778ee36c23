# SPDX-License-Identifier: GPL-3.0-or-later
"""Color Ramp against NumPy's interpolation and SciPy's splines.

tests/addon/export holds it against Blender itself.
"""

import numpy as np
import pytest
from etalon.lib.scene.expressions import ZERO, ColorRamp
from etalon.lib.textures.ramp import color_ramp
from scipy.interpolate import BSpline

POSITIONS = (0.0, 0.25, 0.5, 0.75, 1.0)
COLORS = ((0.2, 0.9, 0.4, 1.0), (0.8, 0.3, 0.5, 0.2), (0.1, 0.6, 0.7, 0.9), (0.5, 0.2, 0.3, 0.4), (0.9, 0.8, 0.1, 0.6))
X = np.linspace(-0.2, 1.2, 281)


def ramp(**settings):
    return ColorRamp(ZERO, POSITIONS, COLORS, **settings)


def test_linear_is_numpys_interpolation():
    expected = [np.interp(X, POSITIONS, channel) for channel in np.array(COLORS).T]
    np.testing.assert_allclose(color_ramp(ramp(), X), expected[:3], atol=1e-12)
    np.testing.assert_allclose(color_ramp(ramp(output="ALPHA"), X), expected[3], atol=1e-12)


def test_constant_steps_at_the_stops():
    got = color_ramp(ramp(interpolation="CONSTANT"), np.array([-1.0, 0.2499, 0.25, 0.9999, 1.0]))
    np.testing.assert_allclose(got, np.array(COLORS)[[0, 0, 1, 3, 4], :3].T)


def test_b_spline_is_scipys_between_the_inner_stops():
    x = np.linspace(0.25, 0.75, 51)
    np.testing.assert_allclose(color_ramp(ramp(interpolation="B_SPLINE"), x), _uniform_cubic(x)[:3], atol=1e-12)


def _uniform_cubic(x):
    """The uniform cubic B-spline whose control points sit at the stops."""
    knots = (np.arange(len(COLORS) + 4) - 2) * 0.25
    return BSpline(knots, np.array(COLORS), 3)(x).T


@pytest.mark.parametrize("interpolation", ["LINEAR", "EASE", "CARDINAL"])
def test_interpolating_kinds_pass_through_the_stops(interpolation):
    got = color_ramp(ramp(interpolation=interpolation), np.array(POSITIONS))
    np.testing.assert_allclose(got, np.array(COLORS)[:, :3].T, atol=1e-12)


@pytest.mark.parametrize("interpolation", ["LINEAR", "EASE", "CARDINAL", "B_SPLINE"])
def test_no_jumps(interpolation):
    x = np.linspace(0, 1, 20001)
    assert np.abs(np.diff(color_ramp(ramp(interpolation=interpolation), x))).max() < 1e-3


@pytest.mark.parametrize(("hue", "middle"), [("NEAR", 0.0), ("FAR", 0.5), ("CW", 0.0), ("CCW", 0.5)])
def test_hue_takes_the_way_it_is_told(hue, middle):
    """From magenta-red (hue 11/12) to orange-red (hue 1/12).

    Near and growing go through red, the others through cyan.
    """
    stops = ((1.0, 0.0, 0.5, 1.0), (1.0, 0.5, 0.0, 1.0))
    got = color_ramp(ColorRamp(ZERO, (0.0, 1.0), stops, mode="HSV", hue=hue), np.array([0.5]))
    expected = (1.0, 0.0, 0.0) if middle == 0.0 else (0.0, 1.0, 1.0)
    np.testing.assert_allclose(got[:, 0], expected, atol=1e-12)


def test_one_stop_and_coinciding_stops():
    one = ColorRamp(ZERO, (0.4,), (COLORS[0],), interpolation="B_SPLINE")
    np.testing.assert_allclose(color_ramp(one, X), np.array(COLORS[0])[:3, None] * np.ones(X.size))
    twin = ColorRamp(ZERO, (0.5, 0.5), (COLORS[0], COLORS[1]))
    np.testing.assert_allclose(color_ramp(twin, np.array([0.49, 0.51])), np.array(COLORS)[:2, :3].T)
