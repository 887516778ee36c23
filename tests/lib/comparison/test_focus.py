# SPDX-License-Identifier: GPL-3.0-or-later
"""Rounds in a part of the image: as long as one of the whole, and never past a look."""

import numpy as np
import pytest
from etalon.lib.comparison.focus import focus, weigh_round
from etalon.lib.film.regions import image_regions
from etalon.lib.verdict.boundaries import next_look


@pytest.mark.parametrize("share", [0.7, 0.3, 0.04, 1e-4])
@pytest.mark.parametrize("most", [None, 100])
def test_rounds_end_at_every_look_and_cost_no_more_than_the_whole_image(share, most):
    replicates = 8
    while replicates < 100:
        weight = weigh_round(share, replicates, 8, most)
        assert 1 <= weight <= max(1 / share, 1)
        assert replicates + weight <= next_look(replicates)
        replicates += weight
    assert most is None or replicates == most


def test_a_round_has_no_more_samples_than_a_renderer_adds_up():
    assert weigh_round(1e-4, 1000, 4096) == 1
    assert weigh_round(1e-4, 1000, 1024) == 4


def test_small_parts_are_worth_windows_and_large_ones_are_not():
    regions = image_regions(64, 64, {}, (16,), None)
    cells = regions.families == regions.families.max()
    wanted = np.zeros(len(regions), bool)
    assert focus(regions, wanted, 8, 8) is None
    wanted[np.flatnonzero(cells)[:2]] = True
    assert focus(regions, wanted, 8, 8).mask.mean() == 2 / 16
    assert focus(regions, cells, 8, 8) is None
