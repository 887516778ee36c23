# SPDX-License-Identifier: GPL-3.0-or-later
"""Light in rare samples.

Tested are the statements on it, and that verdicts are not wrong because of it.
"""

from dataclasses import replace

import numpy as np
import pytest
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.rare import (
    FEWEST,
    LEAST_WORTH,
    TAIL_FROM,
    blind_spot,
    describe_tails,
    is_steady,
    jump_limit,
    median_of_known,
    pareto_shape,
    room_for_rare_light,
)
from etalon.tests.lib.verdict import simulated
from etalon.tests.lib.verdict.simulated import (
    HEAVY,
    MILD,
    decided_on_heavy_tails,
    decided_on_mild_tails,
    decided_on_samples,
    rows_of,
)
from scipy import stats

RUNS = [3, pytest.param(30, marks=pytest.mark.slow)]
FEW = [1, pytest.param(15, marks=pytest.mark.slow)]


@pytest.mark.parametrize("replicates", [1, 8, 9])
@pytest.mark.parametrize("share", [0.0, 0.3])
def test_the_median_of_what_is_known_is_that_of_numpy(rng, replicates, share):
    values = rng.standard_normal((replicates, 50)).astype(np.float32)
    values[rng.random(values.shape) < share] = np.nan
    values[0, ~np.isfinite(values).any(axis=0)] = 7.0  # NumPy warns of columns without a number
    np.testing.assert_array_equal(median_of_known(values), np.nanmedian(values, axis=0))


def test_what_was_never_sampled_has_no_median():
    np.testing.assert_array_equal(median_of_known(np.array([[np.nan, 1.0], [np.nan, 3.0]])), [np.nan, 2.0])


def test_one_bright_sample_is_a_jump_of_its_worth(rng):
    series = 1.0 + 0.01 * rng.standard_normal((20, 3))
    series[7, 1] += 500.0 / 4096
    tails = describe_tails(series, np.full(3, 4096.0), np.ones(len(series)))
    assert tails.worth[[0, 2]].tolist() == [0.0, 0.0]
    assert tails.worth[1] == pytest.approx(500.0, rel=0.1)
    assert tails.largest_share[1] == pytest.approx(500.0 / 4096 / 20, rel=0.1)


def test_replicates_of_more_samples_are_no_jumps_and_hide_none(rng):
    """Deviations count by the root of the samples behind them.

    What a sample was worth does not depend on how it was gathered.
    """
    weights = np.array([1.0] * 30 + [16.0] * 30)
    series = 1.0 + 0.01 * rng.standard_normal((60, 2000)) / np.sqrt(weights)[:, None]
    assert not describe_tails(series, np.full(2000, 256.0), weights).worth.any()
    series[[5, 45], [0, 1]] += 400.0 / (256.0 * weights[[5, 45]])
    worth = describe_tails(series, np.full(2000, 256.0), weights).worth
    assert worth[:2] == pytest.approx(400.0, rel=0.1)
    assert not worth[2:].any()


@pytest.mark.parametrize("replicates", [5, 8, 12, 20, 50])
def test_normal_noise_is_practically_never_a_jump(rng, replicates):
    series = 1.0 + 0.1 * rng.standard_normal((replicates, 20_000))
    assert np.count_nonzero(describe_tails(series, np.ones(20_000), np.ones(len(series))).worth) <= 5
    assert jump_limit(np.array([100]))[0] == 8.0


def test_few_replicates_rounding_and_black_tell_of_no_jump():
    assert describe_tails(np.array([[1.0], [9.0]]), np.ones(1), np.ones(2)).worth.tolist() == [0.0]
    assert describe_tails(np.zeros((FEWEST, 1)), np.ones(1), np.ones(FEWEST)).worth.tolist() == [0.0]
    rounded = 1.0 + 1e-7 * np.arange(20)[:, None]
    rounded[3] += 3e-6
    assert describe_tails(rounded, np.ones(1), np.ones(len(rounded))).worth.tolist() == [0.0]


def test_steady_replicates_differ_by_rounding_alone():
    series = np.repeat([[0.05, 0.05, 0.0, 0.05, 0.0]], 6, axis=0)
    series[2] += [1e-9, 1e-5, 0.0, 0.0, 1e-12]
    series[4, 3] = np.nan
    assert is_steady(series).tolist() == [True, False, True, True, False]


def test_replicates_that_were_not_sampled_do_not_count(rng):
    series = 1.0 + 0.01 * rng.standard_normal((40, 2))
    series[20:, 0] = np.nan
    weights = np.ones(len(series))
    whole = describe_tails(series, np.ones(2), weights)
    part = describe_tails(series[:20, :1], np.ones(1), weights[:20])
    assert whole.largest_share[0] == pytest.approx(part.largest_share[0])


def test_what_was_not_met_may_be_missing_with_its_probability():
    """A sample of worth v is met with probability p each.

    A region that misses all of N owes v p of its light.
    """
    worth, samples, level = 1e4, 1e6, 0.01
    room = float(room_for_rare_light(worth, np.array([samples]), level)[0])
    missed = (1.0 - room / worth) ** samples
    assert missed == pytest.approx(level, rel=0.01)
    assert room_for_rare_light(0.0, np.array([samples]), level)[0] == pytest.approx(room * LEAST_WORTH / worth)
    assert np.isinf(room_for_rare_light(worth, np.array([0.0]), level)[0])
    v = float(blind_spot(np.array([samples]), 0.01, level)[0])
    assert room_for_rare_light(v, np.array([samples]), level)[0] == pytest.approx(0.01)


@pytest.mark.parametrize("shape", [0.2, 0.5, 1.0])
def test_the_shape_of_a_pareto_tail_is_found(rng, shape):
    values = stats.genpareto.rvs(shape, size=(20, 4000), random_state=rng)
    found = np.array([pareto_shape(one) for one in values])
    assert found.mean() == pytest.approx(shape, abs=0.08)
    assert np.isnan(pareto_shape(values[0, : TAIL_FROM - 1]))
    assert np.isnan(pareto_shape(np.ones(100)))


@pytest.mark.grid(3)
@pytest.mark.parametrize("runs", RUNS)
@pytest.mark.parametrize("worth", [1e2, 1e3, 1e4, 1e5])
def test_light_in_rare_samples_that_a_side_drops_is_not_called_agreement(rng, runs, worth):
    """The candidate lacks 3 % of each region's light, in samples of this worth.

    The tolerance is 1 %.
    """
    wrong = sum((decided_on_samples(rng, 0.03, worth, 0.0).outcomes == Outcome.EQUIVALENT).any() for _ in range(runs))
    assert wrong <= stats.binom.ppf(0.999, runs, 0.01)


@pytest.mark.grid(3)
@pytest.mark.parametrize("runs", RUNS)
@pytest.mark.parametrize("worth", [1e2, 1e3, 1e4, 1e5])
def test_fireflies_on_one_side_alone_are_not_called_a_difference(rng, runs, worth):
    """The means are equal.

    One side has 3 % of the light in samples of this worth, the other in all of its samples.
    """
    wrong = sum((decided_on_samples(rng, 0.03, worth, 0.03).outcomes == Outcome.DIFFERENT).any() for _ in range(runs))
    assert wrong <= stats.binom.ppf(0.999, runs, 0.01)


@pytest.mark.grid(3)
@pytest.mark.parametrize("runs", FEW)
@pytest.mark.parametrize("noisy", [True, False], ids=["both sides", "one side"])
@pytest.mark.parametrize("kind", HEAVY)
def test_heavy_tails_of_samples_make_no_false_claims(rng, runs, kind, noisy):
    """A difference of 15 % is beyond the tolerance of 10 %, one of none is not.

    A hundred regions, some of whose noise has no variance.
    """
    agree = differ = 0
    for _ in range(runs):
        agree += (decided_on_heavy_tails(rng, kind, 0.15, noisy).outcomes == Outcome.EQUIVALENT).any()
        differ += (decided_on_heavy_tails(rng, kind, 0.0, noisy).outcomes == Outcome.DIFFERENT).any()
    assert max(agree, differ) <= stats.binom.ppf(0.999, runs, 0.01)


def claims_at_the_edge(rng, kind, runs):
    """How many of `runs` comparisons falsely claim agreement, and how many a difference, at any look.

    The truth is just outside the tolerance of 1 % in all regions, and just inside.
    """
    found = []
    for gap, false in ((0.0101, Outcome.EQUIVALENT), (0.0099, Outcome.DIFFERENT)):
        tests = [decided_on_mild_tails(rng, kind, gap) for _ in range(runs)]
        found.append(sum(false in {*one.outcomes, *(claim.outcome for claim in one.withdrawn)} for one in tests))
    return found


@pytest.mark.parametrize("runs", [20, pytest.param(200, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", MILD)
def test_false_claims_on_mild_tails_are_no_more_than_the_level(rng, runs, kind):
    """Ten regions at the edge of the tolerance, at a confidence of 90 %: at most 10 % of comparisons make a false claim."""
    assert max(claims_at_the_edge(rng, kind, runs)) <= stats.binom.ppf(0.999, runs, 0.1)


@pytest.mark.parametrize("kind", MILD)
def test_standard_errors_a_third_of_the_right_ones_raise_false_claims(rng, monkeypatch, kind):
    """The test above can fail."""
    monkeypatch.setattr(simulated, "rows_of", lambda values: replace(moments := rows_of(values), m2=moments.m2 / 9.0))
    assert min(claims_at_the_edge(rng, kind, 20)) > stats.binom.ppf(0.999, 20, 0.1)


def test_heavy_tails_that_have_a_variance_are_decided_all_the_same(rng):
    """Half as much again is found in most regions, and agreement in some."""
    assert (decided_on_heavy_tails(rng, "Pareto 2.5", 0.5, False).outcomes == Outcome.DIFFERENT).mean() > 0.8
    found = [decided_on_heavy_tails(rng, "Pareto 2.5", 0.0, False).outcomes for _ in range(5)]
    assert np.mean([one == Outcome.EQUIVALENT for one in found]) > 0.2


@pytest.mark.parametrize(
    ("worth", "smooth", "outcome"), [(1e4, 0.0, Outcome.EQUIVALENT), (1e4, 0.03, Outcome.DIFFERENT)]
)
def test_without_room_for_rare_light_both_mistakes_are_made(rng, worth, smooth, outcome):
    """The tests above can fail."""
    found = [decided_on_samples(rng, 0.03, worth, smooth, room=False).outcomes for _ in range(5)]
    assert all((one == outcome).any() for one in found)


def test_tame_light_is_decided_as_before(rng):
    """Safety does not come from never deciding.

    Without rare samples all regions are found to agree.
    """
    found = decided_on_samples(rng, 0.0, 1.0, 0.0)
    assert (found.outcomes == Outcome.EQUIVALENT).all()
