# SPDX-License-Identifier: GPL-3.0-or-later
"""Relative differences, and what stands for those that have no scale."""

import numpy as np
from etalon.lib.relative import relative_difference


def test_a_difference_without_a_scale_is_infinite_and_no_difference_is_zero():
    gap = np.array([0.0, 0.1, 0.1, -0.1, np.nan])
    found = relative_difference(gap, np.array([0.0, -2.0, 0.0, 0.0, 1.0]), 0.0)
    np.testing.assert_array_equal(found, [0.0, 0.05, np.inf, -np.inf, np.nan])


def test_below_the_floor_a_difference_is_relative_to_the_floor():
    np.testing.assert_allclose(relative_difference(np.array([0.1]), np.array([0.01]), 0.5), [0.2])
