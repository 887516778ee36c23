# SPDX-License-Identifier: GPL-3.0-or-later
"""The sequential decision on simulated regions.

Tested are how often it is wrong, and what it finds at which cost.
"""

import numpy as np
import pytest
from etalon.lib.film.moments import Moments
from etalon.lib.verdict import sequential
from etalon.lib.verdict.boundaries import Boundary, Spending, next_look
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.sequential import ALL_AGREE, ONE_DIFFERS, PARTS, SequentialTest, find_floor, holm
from etalon.tests.lib.verdict.simulated import decided, fireflies, gaussian
from scipy import stats

TOLERANCE = 0.01
RUNS = [6, pytest.param(60, marks=pytest.mark.slow)]


def test_holms_procedure_step_by_step(rng):
    for _ in range(200):
        p, level = rng.random(7) ** 4, 0.05
        left, rejected = list(range(7)), set()
        while left and min(p[i] for i in left) <= level / len(left):
            best = min(left, key=lambda i: p[i])
            rejected.add(best)
            left.remove(best)
        assert set(np.flatnonzero(holm(p, level))) == rejected
    assert holm(np.array([0.05, 0.05]), 0.05).tolist() == [False, False]
    assert holm(np.zeros(3), 0.05).all()


def wrong(rng, runs, noise, bias, confidence):
    """In how many runs any claim, at any look, was false: on regions all off by `bias`.

    On the edge of the tolerance every claim is.
    """
    truth = np.full(10, 1.0 + bias)
    false = {Outcome.DIFFERENT, Outcome.EQUIVALENT} if abs(bias) == TOLERANCE else {Outcome.DIFFERENT}
    count = 0
    for _ in range(runs):
        found = set()
        decided(
            rng, truth, noise, 0.03, TOLERANCE, confidence, look=lambda test, *_, kept=found: kept.update(test.outcomes)
        )
        count += bool(found & false)
    return count


@pytest.mark.grid(3)
@pytest.mark.parametrize("runs", RUNS)
@pytest.mark.parametrize("noise", [gaussian, fireflies])
@pytest.mark.parametrize("bias", [0.0, 0.5 * TOLERANCE, TOLERANCE, -TOLERANCE])
def test_false_alarms_are_no_more_than_the_level(rng, runs, noise, bias):
    for confidence in (0.9, 0.99):
        assert wrong(rng, runs, noise, bias, confidence) <= stats.binom.ppf(0.999, runs, 1 - confidence)


@pytest.mark.slow
@pytest.mark.parametrize("noise", [gaussian, fireflies])
def test_looks_that_are_not_paid_for_raise_false_alarms(rng, monkeypatch, noise):
    """The test above can fail."""
    monkeypatch.setattr(Spending, "take", lambda self, last: 1.0)
    monkeypatch.setattr(Boundary, "next", lambda self, replicates, share: self.level)
    monkeypatch.setattr(sequential, "holm", lambda p, level: p <= level)
    assert wrong(rng, 100, noise, TOLERANCE, 0.9) > stats.binom.ppf(0.999, 100, 0.1)


@pytest.mark.grid(3)
@pytest.mark.parametrize("runs", [5, pytest.param(50, marks=pytest.mark.slow)])
@pytest.mark.parametrize("bias", [0.005, 0.01, 0.02, 0.05])
def test_a_planted_bias_on_one_material_is_found(rng, runs, bias):
    """A bias is found at half its size as tolerance, in at least 95 of 100 runs.

    It is found at the cost that the normal distribution forecasts. A claim must meet its part of the level / (N
    regions x 6 ways) and its look's share: about 5 standard errors, and two more for a power of 97.5 %.
    """
    truth = np.ones(20)
    truth[3] += bias
    tolerance, sigma = bias / 2, 2 * bias
    standard_errors = -stats.norm.ppf(0.01 * ONE_DIFFERS / 20 / (6 * 20)) + 2
    cost = int(np.ceil(2 * (standard_errors * sigma / (bias - tolerance)) ** 2))
    found = 0
    for _ in range(runs):
        test = decided(rng, truth, gaussian, sigma, tolerance, last=2 * cost)
        found += test.outcomes[3] == Outcome.DIFFERENT and 0 < test.decided_at[3] <= 1.5 * cost
        assert not (np.delete(test.outcomes, 3) == Outcome.DIFFERENT).any()
    assert found >= 0.95 * runs - 1


def rows_of(values):
    mean = values.mean(axis=0)
    return Moments(len(values), mean, ((values - mean) ** 2).sum(axis=0))


def constant(n, means, spread=1e-9):
    """Moments of n replicates of regions with these means (K,), nearly without noise."""
    values = np.repeat(np.asarray(means, float)[:, None], 3, axis=1)
    return Moments(n, values, np.full(values.shape, spread))


def test_a_claim_that_later_data_contradict_is_withdrawn():
    test = SequentialTest(2, TOLERANCE, 0.99)
    test.look(constant(8, [1, 1]), constant(8, [1, 1]), last=False)
    assert (test.outcomes == Outcome.EQUIVALENT).all()
    test.look(constant(10, [1, 1]), constant(10, [1, 2]), last=True)
    assert test.outcomes.tolist() == [Outcome.EQUIVALENT, Outcome.DIFFERENT]
    assert test.decided_at.tolist() == [8, 10]
    (gone,) = test.withdrawn
    assert (gone.region, gone.outcome, gone.claimed_at, gone.withdrawn_at) == (1, Outcome.EQUIVALENT, 8, 10)


def test_a_region_that_is_not_sampled_on_keeps_its_claim():
    test = SequentialTest(2, TOLERANCE, 0.99)
    test.look(constant(8, [1, 1]), constant(8, [1, 1]), last=False)
    n = np.array([8, 10])
    reference, candidate = constant(n, [1, 1]), constant(n, [2, 1])
    test.look(reference, candidate, last=False)
    assert (test.outcomes == Outcome.EQUIVALENT).all()
    assert not test.withdrawn


def test_all_regions_are_tested_together_at_the_level_of_one(rng):
    """The number of regions costs nothing.

    With 1,000 regions the bound is that of the worst one at the plain level.
    """
    sigma, n = 0.008, 64
    noise = 1.0 + sigma * gaussian(rng, n, 1000), 1.0 + sigma * gaussian(rng, n, 1000)
    reference, candidate = (rows_of(values) for values in noise)
    test = SequentialTest(1000, TOLERANCE, 0.99, expected=1)
    test.look(reference, candidate, last=True)
    q = stats.t.isf(0.01 * ALL_AGREE, 2 * n - 2)
    gap = np.abs(candidate.mean - reference.mean).max()
    assert test.looks[0].bound == pytest.approx(gap + q * sigma * np.sqrt(2 / n), rel=0.1)
    assert (test.outcomes == Outcome.EQUIVALENT).all()


def test_families_are_claimed_in_order():
    """Cells of a family that does not pass are claimed one by one.

    Those of families before it are claimed all together.
    """
    families = np.array([0, 1, 1, 2, 2])
    means = [1, 1, 1, 1, 1.2]
    test = SequentialTest(5, TOLERANCE, 0.99, families=families)
    # A noise that lets one region pass at the plain level, not under Holm's procedure.
    spread = 8 * 7 * (0.01 / 5.0) ** 2 / 2
    test.look(constant(8, np.ones(5), spread), constant(8, means, spread), last=False)
    assert test.within.tolist() == [True, True, True, True, False]
    assert [o is Outcome.EQUIVALENT for o in test.outcomes] == [True, True, True, False, False]
    alone = SequentialTest(5, TOLERANCE, 0.99)
    alone.look(constant(8, np.ones(5), spread), constant(8, means, spread), last=False)
    assert not (alone.outcomes == Outcome.EQUIVALENT).any()


def test_room_for_rare_light_is_left_by_every_claim():
    same, off = constant(8, [1, 1]), constant(8, [1.0, 1.05])
    test = SequentialTest(2, TOLERANCE, 0.99)
    test.look(same, off, last=False, rare=np.array([0.02, 0.03]))
    assert test.bounds == pytest.approx([0.02, 0.08], abs=1e-4)
    assert test.outcomes.tolist() == [Outcome.UNDECIDED, Outcome.DIFFERENT]
    test.look(constant(10, [1, 1]), constant(10, [1, 1.05]), last=False, rare=np.array([0.005, 0.045]))
    assert test.outcomes.tolist() == [Outcome.EQUIVALENT, Outcome.UNDECIDED]


@pytest.mark.slow
def test_the_bound_is_wrong_no_more_often_than_its_level(rng):
    """The truth is 2 % off in one region of 20.

    The bound must not fall below that, at any look.
    """
    truth, runs, confidence = np.ones(20), 300, 0.9
    truth[7] = 1.02
    missed = 0
    for _ in range(runs):
        bounds = []
        decided(
            rng,
            truth,
            gaussian,
            0.02,
            0.03,
            confidence,
            look=lambda test, n, a, b, kept=bounds: kept.append(test.looks[-1].bound),
        )
        missed += min(bounds) < 0.02
    assert missed <= stats.binom.ppf(0.999, runs, ALL_AGREE * (1 - confidence))


def bounds_in_turns(rng, truth, sigma, wrong=1.0, steps=30):
    """The bounds of all looks, where the region with the largest bound is always sampled next, up to its next look.

    It is rendered as one replicate with the weight of all that come before that look. `wrong` multiplies standard errors.
    """
    test = SequentialTest(truth.size, 0.001, 0.9, expected=20)
    sides = [Moments.empty((truth.size, 3)) for _ in range(2)]

    def add(of, weight):
        for side, mean in zip(sides, (np.ones(truth.size), truth), strict=True):
            noise = sigma / np.sqrt(weight) * rng.standard_normal(truth.size)
            side.add(np.repeat((mean + noise)[:, None], 3, axis=1), of, weight)

    def look(of):
        judged = [Moments(side.n, side.mean, wrong**2 * side.m2, side.times) for side in sides]
        test.look(*judged, last=False, of=of)

    everywhere = np.ones(truth.size, bool)
    for _ in range(8):
        add(everywhere, 1)
    look(everywhere)
    found = [test.overall_bound()]
    for _ in range(steps):
        of = np.arange(truth.size) == np.argmax(test.bounds)
        n = int(sides[0].n[of][0])
        add(of, next_look(n) - n)
        look(of)
        found.append(test.overall_bound())
    return found


@pytest.mark.parametrize(("wrong", "holds"), [(1.0, True), (0.6, False)])
def test_the_bound_holds_where_sampling_goes_where_it_is_largest(rng, wrong, holds):
    """One region in five is off by 5 %; its noise, and that of others, keeps the bound up in turns.

    With standard errors that are too small by two fifths the bound falls below the truth more often than it may.
    """
    runs = 40
    truth, sigma = np.array([1.0, 1.05, 1.0, 1.0, 1.0]), np.array([0.02, 0.05, 0.05, 0.03, 0.01])
    missed = sum(min(bounds_in_turns(rng, truth, sigma, wrong)) < 0.05 for _ in range(runs))
    assert (missed <= stats.binom.ppf(0.999, runs, 0.1 * ALL_AGREE)) == holds


def test_the_floor_is_that_of_what_does_not_emit():
    """A lamp in a few cells does not lift it, and black cells do not lower it.

    Every channel has its own.
    """
    means = np.ones((100, 3)) * [1.0, 0.5, 1e-4]
    means[:10] = 1e6
    means[90:] = 0.0
    floor = find_floor(np.vstack([means.mean(axis=0), means]), np.append(0, np.full(100, 2)))
    assert floor == pytest.approx([1e-3, 5e-4, 1e-7])
    assert find_floor(np.zeros((4, 3)), np.zeros(4, int)).tolist() == [0.0, 0.0, 0.0]


def test_the_parts_of_the_level_add_up_to_one():
    assert sum(PARTS) == pytest.approx(1.0)


def test_what_is_held_back_is_not_spent(rng):
    assert SequentialTest(1, TOLERANCE, 0.99, held_back=0.1).level == pytest.approx(0.009)


def test_looks_at_parts_spend_by_their_number_of_replicates_whenever_they_come():
    """Regions that come late, or pass over looks, are judged at the level that they would have in their turn."""

    def look(test, counts, of):
        counts = np.array(counts)
        one = Moments(counts, np.ones((2, 3)), np.full((2, 3), 0.01))
        test.look(one, one, last=False, of=np.array(of))

    whole, parts = (SequentialTest(2, 0.01, 0.99) for _ in range(2))
    for n in (8, 10, 12, 15, 18):
        look(whole, [n, n], [True, True])
    for counts, of in ([8, 8], [1, 1]), ([15, 8], [1, 0]), ([15, 10], [0, 1]), ([15, 18], [0, 1]), ([18, 18], [1, 0]):
        look(parts, counts, np.array(of, bool))
    levels = {one.replicates[0]: (one.share, one.level) for one in whole.looks}
    assert [one.replicates[0] for one in parts.looks] == [8, 15, 10, 18, 18]
    assert all((one.share, one.level) == levels[one.replicates[0]] for one in parts.looks)
    assert parts.bounds == pytest.approx(whole.bounds)
    assert parts.share_left == pytest.approx(whole.share_left)
