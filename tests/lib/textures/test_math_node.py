# SPDX-License-Identifier: GPL-3.0-or-later
"""The Math node where the usual functions have no value.

Inside their domains Cycles is the judge (tests/addon/export).
"""

import numpy as np
import pytest
from etalon.lib.textures.math_node import OPERATIONS, math

OUTSIDE = [
    ("DIVIDE", 3.0, 0.0, 0.0),
    ("POWER", 0.0, 0.0, 1.0),
    ("POWER", 0.0, -1.0, 0.0),
    ("POWER", -2.0, 0.5, 0.0),
    ("POWER", -2.0, 3.0, -8.0),
    ("LOGARITHM", -1.0, 2.0, 0.0),
    ("LOGARITHM", 8.0, 2.0, 3.0),
    ("LOGARITHM", 8.0, 1.0, 0.0),
    ("LOGARITHM", 8.0, -2.0, 0.0),
    ("SQRT", -4.0, 0.0, 0.0),
    ("INVERSE_SQRT", 0.0, 0.0, 0.0),
    ("INVERSE_SQRT", 4.0, 0.0, 0.5),
    ("MODULO", -7.0, 3.0, -1.0),
    ("MODULO", 7.0, 0.0, 0.0),
    ("FLOORED_MODULO", -7.0, 3.0, 2.0),
    ("FLOORED_MODULO", -7.0, 0.0, 0.0),
    ("SNAP", 7.3, 0.0, 0.0),
    ("PINGPONG", 2.5, 1.0, 0.5),
    ("PINGPONG", 2.5, 0.0, 0.0),
    ("ROUND", -2.5, 0.0, -2.0),
    ("TRUNC", -2.7, 0.0, -2.0),
    ("FRACT", -0.25, 0.0, 0.75),
    ("ARCSINE", 5.0, 0.0, np.pi / 2),
    ("ARCCOSINE", -5.0, 0.0, np.pi),
    ("ARCTAN2", 0.0, -0.0, 0.0),
    ("SIGN", 0.0, 0.0, 0.0),
    ("COMPARE", 1.0, 1.0, 1.0),
]


@pytest.mark.parametrize(("operation", "a", "b", "expected"), OUTSIDE)
def test_outside_the_domain(operation, a, b, expected):
    values = (np.array(a), np.array(b), np.array(0.0))
    assert math(operation, *values, clamp=False) == pytest.approx(expected)


def test_wrap_and_smooth_minimum_take_three():
    three = np.array([5.5, -0.5, 1.0])
    np.testing.assert_allclose(math("WRAP", three, np.array(2.0), np.array(1.0), clamp=False), [1.5, 1.5, 1.0])
    np.testing.assert_allclose(math("WRAP", three, np.array(2.0), np.array(2.0), clamp=False), 2.0)
    # At equal arguments the smooth minimum lies a sixth of the distance below (Inigo Quilez, smooth minimum, cubic).
    assert math("SMOOTH_MIN", np.array(1.0), np.array(1.0), np.array(0.6), clamp=False) == pytest.approx(0.9)
    assert math("SMOOTH_MAX", np.array(1.0), np.array(1.0), np.array(0.0), clamp=False) == pytest.approx(1.0)


@pytest.mark.parametrize("operation", OPERATIONS)
def test_every_operation_keeps_shape_arguments_and_bounds(operation, rng):
    arguments = rng.uniform(-4, 4, (3, 200))
    before = arguments.copy()
    result = math(operation, *arguments, clamp=True)
    np.testing.assert_array_equal(arguments, before)
    assert result.shape == (200,)
    assert result.dtype == np.float64
    assert result.min() >= 0
    assert result.max() <= 1
    assert math(operation, *arguments[:, 0], clamp=True) == result[0]
