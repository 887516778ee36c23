# SPDX-License-Identifier: GPL-3.0-or-later
"""The sequential decision on simulated regions: how often it is wrong, and what it finds at which cost."""

from itertools import pairwise

import numpy as np
import pytest
from etalon.lib.film.moments import Moments
from etalon.lib.verdict import sequential
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.sequential import SequentialTest, holm, look_share, next_look
from etalon.tests.lib.verdict.simulated import decided, fireflies, gaussian
from scipy import stats

TOLERANCE = 0.01
RUNS = [100, pytest.param(1000, marks=pytest.mark.slow)]


def test_looks_are_at_least_a_factor_apart():
    looks = [next_look(0)]
    while looks[-1] < 100_000:
        looks.append(next_look(looks[-1]))
    assert looks[:6] == [8, 12, 18, 27, 41, 62]
    assert all(b >= 1.5 * a for a, b in pairwise(looks))
    assert next_look(20) == 27


def test_shares_of_all_looks_are_at_most_one():
    for last in range(1, 60):
        assert sum(look_share(k, False) for k in range(1, last)) + look_share(last, True) <= 1 + 1e-12


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
    """In how many runs any claim about regions that are all off by `bias` was false; on the edge of the tolerance every claim is."""
    truth = np.full(10, 1.0 + bias)
    count = 0
    for _ in range(runs):
        found = set(decided(rng, truth, noise, 0.03, TOLERANCE, confidence).outcomes)
        count += bool(found - {Outcome.UNDECIDED} if abs(bias) == TOLERANCE else found & {Outcome.DIFFERENT})
    return count


@pytest.mark.parametrize("runs", RUNS)
@pytest.mark.parametrize("noise", [gaussian, fireflies])
@pytest.mark.parametrize("bias", [0.0, 0.5 * TOLERANCE, TOLERANCE, -TOLERANCE])
def test_false_alarms_are_no_more_than_the_level(rng, runs, noise, bias):
    for confidence in (0.9, 0.99):
        assert wrong(rng, runs, noise, bias, confidence) <= stats.binom.ppf(0.999, runs, 1 - confidence)


@pytest.mark.parametrize("noise", [gaussian, fireflies])
def test_looks_that_are_not_paid_for_raise_false_alarms(rng, monkeypatch, noise):
    """The test above can fail."""
    monkeypatch.setattr(sequential, "look_share", lambda k, last: 1.0)
    monkeypatch.setattr(sequential, "holm", lambda p, level: p <= level)
    assert wrong(rng, 100, noise, TOLERANCE, 0.9) > stats.binom.ppf(0.999, 100, 0.1)


@pytest.mark.parametrize("runs", [25, pytest.param(100, marks=pytest.mark.slow)])
@pytest.mark.parametrize("bias", [0.005, 0.01, 0.02, 0.05])
def test_a_planted_bias_on_one_material_is_found(rng, runs, bias):
    """At half its size as tolerance, in at least 95 of 100 runs, at the cost that the normal distribution foretells.

    A claim must meet level / (2 N regions x 6 ways) and its look's share: about 5 standard errors, and two more for a power of 97.5 %.
    """
    truth = np.ones(20)
    truth[3] += bias
    tolerance, sigma = bias / 2, 2 * bias
    standard_errors = -stats.norm.ppf(0.01 * look_share(9, False) / (6 * 40)) + 2
    cost = int(np.ceil(2 * (standard_errors * sigma / (bias - tolerance)) ** 2))
    found = 0
    for _ in range(runs):
        test = decided(rng, truth, gaussian, sigma, tolerance, last=2 * cost)
        found += test.outcomes[3] == Outcome.DIFFERENT and 0 < test.decided_at[3] <= 1.5 * cost
        assert not (np.delete(test.outcomes, 3) == Outcome.DIFFERENT).any()
    assert found >= 0.95 * runs - 1


def test_once_decided_stays_decided(rng):
    first = Moments(8, np.ones((2, 3)), np.full((2, 3), 1e-9))
    test = SequentialTest(2, TOLERANCE, 0.99)
    test.look(first, first, last=False)
    assert (test.outcomes == Outcome.EQUIVALENT).all()
    other = Moments(12, np.full((2, 3), 2.0), np.full((2, 3), 1e-9))
    test.look(first, other, last=True)
    assert (test.outcomes == Outcome.EQUIVALENT).all()
    assert test.decided_at.tolist() == [8, 8]
    assert [look.undecided for look in test.looks] == [0, 0]


def test_claims_left_are_those_that_can_still_be_made():
    """Each region makes at most one claim; a decided one leaves one behind."""
    test = SequentialTest(2, TOLERANCE, 0.99)
    assert test.claims_left == 4
    mean = np.ones((2, 3))
    noisy = np.array([[1e-9], [1e9]]) * np.ones(3)
    test.look(Moments(8, mean, noisy), Moments(8, mean, noisy), last=False)
    assert test.outcomes.tolist() == [Outcome.EQUIVALENT, Outcome.UNDECIDED]
    assert test.claims_left == 3


def test_what_is_held_back_is_not_spent(rng):
    assert SequentialTest(1, TOLERANCE, 0.99, held_back=0.1).level == pytest.approx(0.009)
