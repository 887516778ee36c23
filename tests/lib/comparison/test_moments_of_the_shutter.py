# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion blur: samples that share a moment of the shutter are one sample for what is rare."""

from types import SimpleNamespace

import numpy as np
import pytest
from etalon.lib.comparison.sides import Side, room_left_by
from etalon.lib.film.regions import image_regions
from etalon.lib.film.rendering import Rendering
from etalon.lib.verdict.rare import LEAST_WORTH

LEVEL, REPLICATES, SAMPLES = 0.01, 20, 64


def side(moments, weight=1):
    regions = image_regions(8, 8, {}, (4,))
    found = Side.empty(SimpleNamespace(name="one", settings={}), regions, SAMPLES)
    for replicate in range(REPLICATES):
        image = np.full((8, 8, 3), 1.0 + 0.01 * replicate)
        found.add(Rendering(image, np.zeros((8, 8), np.int32), 1.0, moments=moments), None, weight)
    return found


@pytest.mark.parametrize(("moments", "weight", "drawn"), [(1, 1, 1), (16, 1, 16), (16, 4, 4)])
def test_a_region_has_no_more_samples_than_moments(moments, weight, drawn):
    """A thing may be there for a hundredth of the shutter's time.

    It is then missed as often as that many moments miss it.
    """
    both = side(moments, weight), side(None, weight)
    cells = np.ones(len(both[0].regions.regions), bool)
    room, least = room_left_by(both, cells, LEVEL)
    assert least.tolist() == [drawn * weight * REPLICATES] * cells.size
    np.testing.assert_allclose(room, LEAST_WORTH * np.log(1.0 / LEVEL) / (drawn * weight * REPLICATES))


def test_samples_with_times_of_their_own_count_each():
    both = side(None), side(None)
    cells = np.ones(len(both[0].regions.regions), bool)
    _, least = room_left_by(both, cells, LEVEL)
    assert least.min() == 16 * SAMPLES * REPLICATES
