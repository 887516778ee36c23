# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bound asks of each region, against the formulas of docs/statistics.md, and the best bound against all others."""

import numpy as np
import pytest
from etalon.lib.comparison.attainable import FURTHEST, Attainable, Standing, find_standing, needed_replicates
from etalon.lib.comparison.pace import Pace
from etalon.lib.film.moments import Moments
from etalon.lib.film.regions import image_regions
from etalon.lib.verdict.boundaries import next_look
from etalon.lib.verdict.claims import bound
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.sequential import ONE_AGREES, Look, SequentialTest
from scipy import stats

SIDE, CELL, LEVEL = 64, 16, 1e-3


def judged(bounds, counts, rare=0.0, unsupported=0.0):
    regions = image_regions(SIDE, SIDE, {}, (CELL,))
    test = SequentialTest(len(bounds), 0.01, 0.99, families=regions.families[: len(bounds)])
    test.bounds, test.rare, test.unsupported = (np.broadcast_to(x, len(bounds)) for x in (bounds, rare, unsupported))
    test.looks.append(Look((12, 12), 0.1, LEVEL, 16, max(bounds)))
    return test, Standing(np.array(counts), np.array(counts), test.bounds), Attainable(regions)


@pytest.mark.parametrize(("rare", "unsupported"), [(0.0, 0.0), (0.02, 0.0), (0.01, 0.01)])
@pytest.mark.parametrize("replicates", [8, 40, 1000])
@pytest.mark.parametrize("aim", [0.09, 0.05, 0.02])
def test_the_look_that_is_needed_is_the_first_at_which_the_bound_is_reached(aim, replicates, rare, unsupported):
    present = 0.1
    test, now, _ = judged([present], [replicates], rare, unsupported)
    needed = int(needed_replicates(test, now, aim)[0])

    def bound_at(n):
        later = replicates + np.log(n / replicates) / np.log(1.2)
        quantiles = [stats.t.isf(LEVEL, 2 * (k - 1)) for k in (replicates, later)]
        growth = n / replicates
        noise = present - rare - unsupported
        return noise * quantiles[1] / quantiles[0] / np.sqrt(growth) + rare / growth + unsupported

    assert needed == next_look(needed - 1)
    assert bound_at(needed) <= aim * 1.01
    assert bound_at(needed / 1.3) > aim


def test_what_is_within_the_bound_needs_nothing_and_what_never_will_be_needs_infinitely_much():
    test, now, _ = judged([0.1, 0.1], [13, 13], 0.0, [0.0, 0.06])
    assert needed_replicates(test, now, 0.1).tolist() == [13, 13]
    assert np.isinf(needed_replicates(test, now, 0.05)).tolist() == [False, True]


def test_work_counts_each_pixel_once_for_the_region_that_needs_most():
    *_, cost = judged([0.1] * 17, [12] * 17)
    needs = np.zeros(17)
    needs[3] = 10
    assert cost.work(needs) == pytest.approx(10 / 16)
    needs[0] = 4  # the whole image
    assert cost.work(needs) == pytest.approx((10 + 15 * 4) / 16)


@pytest.mark.parametrize("fixed", [0.0, 0.3])
@pytest.mark.parametrize("seconds", [4.0, 10.0, 100.0])
def test_no_lower_bound_is_in_reach(rng, seconds, fixed):
    bounds = np.append(0.005, 0.02 + 0.3 * rng.random(16) ** 3)
    counts = np.append(12, rng.choice([12, 15, 40], 16))
    test, now, cost = judged(bounds, counts)
    wanted = bounds > 0.01

    pace = Pace(fixed)
    pace.learn(8.0, 1.0, 8, 8)

    def spent(aim):
        needed = np.where(wanted, needed_replicates(test, now, aim), counts)
        return pace.seconds(cost.work(needed - counts), np.log((needed / counts).max()) / np.log(FURTHEST))

    found = cost.bound(test, wanted, now, pace, seconds)
    assert spent(found) <= seconds < spent(found / 1.03)
    assert cost.bound(test, wanted, now, pace, 1e6) == test.tolerance


def moments(mean, spread, n):
    mean = np.repeat(np.array(mean, float)[:, None], 3, axis=1)
    return Moments(n, mean, np.full(mean.shape, spread**2 * (n - 1)))


def test_what_differs_counts_by_its_noise_and_what_has_no_bound_by_an_estimate():
    reference, candidate = moments([1.0, 1.0, 0.01], 0.1, 10), moments([1.2, 1.0, 0.01], 0.1, 10)
    test, _, _ = judged([0.0, 0.0, 0.0], [10] * 3)
    test.floor = np.full(3, 1e-4)
    test.bounds = bound(candidate, reference, test.floor, LEVEL)
    test.outcomes = np.array([Outcome.DIFFERENT, Outcome.UNDECIDED, Outcome.UNDECIDED])
    now = find_standing(test, reference, candidate)
    assert np.isinf(test.bounds[2])
    noise = stats.t.isf(LEVEL, 18) * 0.1 * np.sqrt(2 / 10)
    # Beside what differs, each region agrees on its own: Holm's level of the first of three.
    wider = stats.norm.isf(ONE_AGREES * test.level * 0.1 / 3) / stats.norm.isf(LEVEL)
    assert now.bounds == pytest.approx(wider * np.array([test.bounds[0] - 0.2, test.bounds[1], noise / 0.01]))
    assert (now.replicates == 10).all()
    assert (now.observed == 10).all()
    test.outcomes[0] = Outcome.UNDECIDED
    assert find_standing(test, reference, candidate).bounds[:2] == pytest.approx(test.bounds[:2])
