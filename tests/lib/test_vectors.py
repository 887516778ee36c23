# SPDX-License-Identifier: GPL-3.0-or-later
"""Products and copies of vectors of shape (3, n)."""

import numpy as np
import pytest
from etalon.lib.vectors import gather


@pytest.mark.parametrize("shape", [(40,), (3, 40), (2, 3, 40)])
def test_gathered_elements_are_those_at_the_indices(shape, rng):
    values = rng.random(shape)
    index = rng.integers(0, 40, 90)
    gathered = gather(values, index)
    np.testing.assert_array_equal(gathered, values[..., index])
    assert gathered.flags.c_contiguous
    assert not np.shares_memory(gathered, values)
    assert gather(values, np.empty(0, np.intp)).shape == (*shape[:-1], 0)
