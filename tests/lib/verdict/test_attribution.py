# SPDX-License-Identifier: GPL-3.0-or-later
"""Attribution on simulated regions, where the truth is known.

Tested are how often it claims what is false, and how often it finds what is true.
"""

from dataclasses import replace
from math import comb

import numpy as np
import pytest
from etalon.lib.film.light_passes import LightPass
from etalon.lib.verdict import attribution
from etalon.lib.verdict.attribution import ATTRIBUTION_SHARE, Attribution, set_share
from etalon.lib.verdict.causes import State
from etalon.lib.verdict.explain import explain
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.sequential import SequentialTest
from etalon.tests.lib.verdict.simulated_causes import DEPARTURES, NAMES, NOISE, TOLERANCE, Sums, simulated
from scipy.stats import binom


def test_all_sets_together_spend_no_more_than_the_level():
    for count in range(1, 40):
        spent = sum(comb(count, size) * set_share(size, count) for size in range(1, count + 1))
        assert spent <= 1.0 + 1e-12


@pytest.mark.parametrize("runs", [5, pytest.param(100, marks=pytest.mark.slow)])
@pytest.mark.parametrize("tails", [None, 3])
def test_agreement_on_the_very_edge_is_claimed_no_more_often_than_allowed(rng, tails, runs):
    """Region 0 lies on the edge of the tolerance with every set of departures.

    Region 1 lies far outside, which starts the search.
    """
    confidence = 0.5
    effects = {name: np.zeros(4) for name in NAMES}
    truth = np.array([1.0 + TOLERANCE, 2.0, 1.0, 1.0])
    wrong = 0
    for _ in range(runs):
        search, sides, _ = simulated(rng, effects, truth, confidence, tails)
        sets = [frozenset([name]) for name in NAMES]
        wrong += any(search.explained(names, sides)[0] for names in sets)
    assert wrong <= binom.ppf(0.999, runs, ATTRIBUTION_SHARE * (1 - confidence))


@pytest.mark.slow
def test_the_edge_is_seen_where_nothing_is_paid_for(rng, monkeypatch):
    """The same with the level of one look and one set for everything: the test above can fail."""
    monkeypatch.setattr(attribution, "set_share", lambda size, count: 4.0 / ATTRIBUTION_SHARE)

    class Free(attribution.Spending):
        def take(self, last):
            return 1.0

    monkeypatch.setattr(attribution, "Spending", Free)
    effects = {name: np.zeros(4) for name in NAMES}
    truth = np.array([1.0 + TOLERANCE, 2.0, 1.0, 1.0])
    runs = [simulated(rng, effects, truth, 0.5)[:2] for _ in range(60)]
    wrong = sum(any(s.explained(frozenset([name]), sides)[0] for name in NAMES) for s, sides in runs)
    assert wrong > binom.ppf(0.999, 60, ATTRIBUTION_SHARE * 0.5)


@pytest.mark.parametrize("runs", [5, pytest.param(50, marks=pytest.mark.slow)])
@pytest.mark.parametrize("planted", [("a",), ("c",), ("a", "b"), ("b", "c"), ("a", "b", "c")])
def test_the_smallest_set_is_found(rng, planted, runs):
    steps = {"a": [0.2, 0.1, 0.0, 0.0], "b": [0.0, 0.15, -0.2, 0.0], "c": [0.0, 0.0, 0.1, 0.3]}
    effects = {name: np.array(step) for name, step in steps.items()}
    truth = 1.0 + sum(effects[name] for name in planted)
    found = 0
    for _ in range(runs):
        why = simulated(rng, effects, truth)[2]
        found += why.chosen == planted and why.complete
    assert found >= 0.95 * runs


def test_effects_that_undo_each_other_need_both(rng):
    """Neither alone will do: with one of them on, a region that agrees would not."""
    effects = {"a": np.array([0.2, 0.1, 0.0]), "b": np.array([-0.2, 0.1, 0.0]), "c": np.zeros(3)}
    search, _, why = simulated(rng, effects, np.array([1.0, 1.2, 1.0]))
    assert why.chosen == ("a", "b")
    assert why.causes == ((), ("a", "b"), ())
    assert search.complete


# What a, b and c act on: a on glossy light alone, b on diffuse light alone, c on both.
PARTED = tuple(
    replace(one, passes=frozenset(passes))
    for one, passes in zip(
        DEPARTURES,
        ([LightPass.GLOSSY_DIRECT], [LightPass.DIFFUSE_DIRECT], [LightPass.GLOSSY_DIRECT, LightPass.DIFFUSE_DIRECT]),
        strict=True,
    )
)


def test_what_acts_on_no_pass_that_differs_is_not_tried(rng):
    effects = {"a": np.array([0.2, 0.1]), "b": np.array([0.2, 0.1]), "c": np.array([0.0, 0.1])}
    glossy = frozenset([LightPass.GLOSSY_DIRECT, LightPass.DIFFUSE_INDIRECT])
    search, _, why = simulated(rng, effects, 1.0 + effects["a"], departures=PARTED, differing=glossy)
    assert (why.chosen, why.complete) == (("a",), True)
    assert set(search.pairs) == {frozenset("a"), frozenset("c")}
    assert [role.value for role in why.roles] == ["cause", "acts on no pass that differs", "open"]
    # b would do as well, were it not for the passes.
    assert not why.alternatives
    assert simulated(rng, effects, 1.0 + effects["a"], departures=PARTED)[2].alternatives


@pytest.mark.parametrize("passes", [[LightPass.GLOSSY_DIRECT], [LightPass.ENVIRONMENT]])
def test_what_acts_elsewhere_is_tried_where_the_others_do_not_explain_it(rng, passes):
    """The difference of region 1 comes from b, which acts on no pass that is shown to differ.

    None of all acts on the environment.
    """
    effects = {"a": np.array([0.2, 0.0]), "b": np.array([0.0, 0.2]), "c": np.array([0.1, -0.1])}
    truth = 1.0 + effects["a"] + effects["b"]
    why = simulated(rng, effects, truth, departures=PARTED, differing=frozenset(passes))[2]
    assert (why.chosen, why.complete) == (("a", "b"), True)


def test_cancelled_before_any_effect_is_known(rng):
    test = SequentialTest(2, TOLERANCE, 0.99, ATTRIBUTION_SHARE)
    search = Attribution(DEPARTURES, test, 1e-3)
    sides = [Sums(m + NOISE * rng.standard_normal((8, 2, 3))) for m in (1.0, 2.0)]
    test.look(sides[0].moments, sides[1].moments, True)
    search.look(*sides, lambda names, count: None, True)
    assert (test.outcomes == Outcome.DIFFERENT).all()
    assert not search.complete
    why = explain(search, *sides, samples=1, seconds=0.0)
    assert (why.state, why.named) == (State.NO_TIME, ())
