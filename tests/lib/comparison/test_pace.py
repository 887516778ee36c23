# SPDX-License-Identifier: GPL-3.0-or-later
"""How long rounds take: what was timed is what is expected, and the latest counts most."""

import math

import pytest
from etalon.lib.comparison.pace import Pace


def test_nothing_is_expected_before_anything_was_timed():
    pace = Pace(0.2)
    pace.learn(5.0, 0.5, 0, 0)
    assert math.isnan(pace.whole)


@pytest.mark.parametrize("fixed", [0.0, 0.3])
def test_the_time_of_a_part_follows_from_that_of_the_whole(fixed):
    pace = Pace(fixed)
    pace.learn(40.0, 1.0, 20, 20)
    assert pace.whole == pytest.approx(2.0)
    assert pace.seconds(3.0, 3) == pytest.approx(2.0 * (3 * fixed + (1 - fixed) * 3))


def test_parts_of_different_size_tell_what_rounds_cost_without_pixels():
    """A round takes 0.5 s, and the pixels of the image 2 s; at first a tenth was thought to be fixed."""
    pace = Pace(0.1)
    for share, replicates, rounds in [(1.0, 8, 8), (0.1, 20, 2), (0.02, 10, 1), (0.5, 6, 3), (0.05, 30, 2)] * 3:
        pace.learn(0.5 * rounds + 2.0 * share * replicates, share, replicates, rounds)
    assert pace.of_round == pytest.approx(0.5, rel=0.3)
    assert pace.of_image == pytest.approx(2.0, rel=0.15)
    assert pace.seconds(1.0, 4) == pytest.approx(4.0, rel=0.1)


def test_the_latest_times_count_most_and_no_part_is_negative():
    pace = Pace()
    pace.learn(40.0, 1.0, 20, 20)
    for _ in range(20):
        pace.learn(8.0, 0.1, 20, 2)
    assert pace.seconds(2.0, 2) == pytest.approx(8.0, rel=0.01)
    pace.learn(1.0, 0.01, 20, 2)
    assert min(pace.of_image, pace.of_round) >= 0.0
