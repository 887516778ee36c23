# SPDX-License-Identifier: GPL-3.0-or-later
"""The room for rare light that both sides leave together."""

from types import SimpleNamespace

import numpy as np
import pytest
from etalon.lib.comparison.sides import Side, room_left_by
from etalon.lib.film.regions import image_regions
from etalon.lib.film.rendering import Rendering
from etalon.lib.verdict.rare import LEAST_WORTH

LEVEL, REPLICATES, SAMPLES, CELL, WORTH = 0.01, 20, 64, 4, 300.0


def side(rng, flash):
    """Four cells: noise; noise and one bright sample; no noise; no noise, but for one `flash`."""
    regions = image_regions(2 * CELL, 2 * CELL, {}, (CELL,))
    found = Side.empty(SimpleNamespace(name="one", settings={}), regions, SAMPLES)
    for replicate in range(REPLICATES):
        image = np.ones((2 * CELL, 2 * CELL, 3))
        image[:CELL] += 0.01 * rng.standard_normal((CELL, 2 * CELL, 1))
        if replicate == 7:
            image[0, -1] += WORTH / SAMPLES
            image[-1, -1] += flash
        found.add(Rendering(image, np.zeros(image.shape[:2], np.int32), 1.0), None)
    return found


@pytest.mark.parametrize("flash", [0.0, 0.02])
def test_a_bright_sample_is_possible_wherever_a_surface_shows(rng, flash):
    both = side(rng, 0.0), side(rng, flash)
    regions = both[0].regions.regions
    cells = regions.families == 2
    everywhere, samples = room_left_by(both, cells, LEVEL)
    least = LEAST_WORTH * np.log(1.0 / LEVEL) / samples
    np.testing.assert_allclose(everywhere[cells], WORTH / LEAST_WORTH * least[cells], rtol=0.1)
    bare = np.array([False, False, False, True, True])
    found, _ = room_left_by(both, cells, LEVEL, bare)
    assert (found[:3] == everywhere[:3]).all()
    assert found[3] == pytest.approx(least[3])
    assert found[4] == (everywhere[4] if flash else pytest.approx(least[4]))
    # Without noise alone nothing is shown: a surface under a sun may have none.
    found, _ = room_left_by(both, cells, LEVEL, np.zeros(5, bool))
    assert (found == everywhere).all()
