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
    assert pace.seconds(0.1, 30, 3) == pytest.approx(2.0 * (3 * fixed + (1 - fixed) * 3))


def test_a_part_that_is_slower_than_expected_makes_all_slower():
    pace = Pace()
    pace.learn(40.0, 1.0, 20, 20)
    for _ in range(20):
        pace.learn(8.0, 0.1, 20, 2)
    assert pace.whole == pytest.approx(4.0, rel=1e-3)
