# SPDX-License-Identifier: GPL-3.0-or-later
"""What rays meet, as values."""

import numpy as np
from etalon.lib.wavefront.raycaster import Hits


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
