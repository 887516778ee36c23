# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences that rounding causes, in simulated regions where the truth is known."""

from collections import Counter

import numpy as np
from etalon.lib.departures.catalogue import Departure
from etalon.lib.verdict.attribution import ATTRIBUTION_SHARE, Attribution
from etalon.lib.verdict.causes import State
from etalon.lib.verdict.sequential import SequentialTest
from etalon.tests.lib.verdict.simulated_causes import NOISE, TOLERANCE, Sums, simulated

# Region 0 is the whole image, the others lie in it.
INSIDE = np.eye(5)
INSIDE[0] = 1.0
KNOWN = (Departure("a", "", "", by_rounding=True), Departure("b", "", "", by_rounding=True), Departure("c", "", ""))
ALL = np.full(5, -0.8)
NOTHING = np.zeros(5)


def found(rng, gap, effects=None, **how):
    """What is said of a candidate that differs by `gap` (5,), where "a" in full takes 0.8 away."""
    effects = {"a": ALL, "b": NOTHING, "c": NOTHING} if effects is None else effects
    return simulated(rng, effects, 1.0 + gap, inside=lambda: INSIDE, departures=KNOWN, **how)[2]


def test_a_part_of_what_rounding_decides_explains_every_region(rng):
    why = found(rng, np.array([-0.3, -0.7, -0.1, -0.4, -0.2]))
    assert why.state is State.ROUNDED
    assert why.rounded.all()
    assert why.causes == (("a",),) * 5


def test_an_effect_of_one_pair_hides_none_that_is_known(rng):
    """Where time is short, one of two departures that rounding decides may have one pair, and no noise that is known."""
    why = found(rng, np.full(5, -0.4), most_pairs={"b": 1})
    assert why.state is State.ROUNDED
    assert why.rounded.all()
    assert why.causes == (("a",),) * 5


def test_one_pair_alone_puts_nothing_down_to_rounding(rng):
    why = found(rng, np.full(5, -0.4), most_pairs={"a": 1, "b": 1})
    assert not why.rounded.any()


def test_more_than_all_of_the_effect_is_not_put_down_to_rounding(rng):
    """Region 4 is brighter, which no part of the effect makes; so the image is not explained either."""
    why = found(rng, np.array([-0.3, -0.7, -0.1, -0.4, 0.2]))
    assert why.rounded.tolist() == [False, True, True, True, False]


def test_what_rounding_decides_is_rendered_first(rng):
    """Time for five pairs of three departures: those that rounding decides have two each, whatever their place."""
    test = SequentialTest(5, TOLERANCE, 0.99, ATTRIBUTION_SHARE)
    search = Attribution(KNOWN[::-1], test, ATTRIBUTION_SHARE * 0.01)
    sides = [Sums(mean + NOISE * rng.standard_normal((8, 5, 3))) for mean in (1.0, 0.6)]
    rendered = Counter()

    def effects(names, wanted):
        if rendered[names] < wanted and rendered.total() < 5:
            rendered[names] += 1
        return np.zeros((rendered[names], 5, 3)) if rendered[names] else None

    test.look(sides[0].moments, sides[1].moments, False)
    search.look(*sides, effects, False)
    assert {name: rendered[frozenset([name])] for name in "abc"} == {"a": 2, "b": 2, "c": 1}


def test_other_departures_act_in_full_beside_what_rounding_decides(rng):
    """Where "a" does nothing "c" takes 0.3 away; the rest is "c" and a part of "a"."""
    effects = {"a": np.array([-0.8, -0.8, -0.8, -0.8, 0.0]), "b": NOTHING, "c": np.full(5, -0.3)}
    why = found(rng, np.array([-0.6, -0.5, -0.9, -0.35, -0.3]), effects)
    assert why.state is State.ROUNDED
    assert why.rounded[:4].all()
    assert why.causes[:4] == (("a", "c"),) * 4
    assert why.causes[4] in {("c",), ("a", "c")}


def test_what_takes_regions_that_agree_out_of_the_tolerance_does_not_act_beside(rng):
    """Region 3 agrees, and "c" would take 0.3 from it; so region 4 stays unexplained, and the image."""
    effects = {"a": np.array([-0.8, -0.8, -0.8, 0.0, 0.0]), "b": NOTHING, "c": np.full(5, -0.3)}
    why = found(rng, np.array([-0.6, -0.5, -0.7, 0.0, -0.3]), effects)
    assert why.rounded.tolist() == [False, True, True, False, False]
    assert why.causes[1] == ("a",)


def test_two_forms_of_one_departure_do_not_add_up(rng):
    """More than either form does is no part of them, and of two departures that add up it is one."""
    effects = {"a": np.full(5, -0.4), "b": np.full(5, -0.3), "c": NOTHING}
    gap = np.full(5, -0.6)
    forms = (KNOWN[0], Departure("b", "", "", by_rounding=True, form_of="a"), KNOWN[2])
    assert found(rng, gap, effects).rounded.all()
    assert not simulated(rng, effects, 1.0 + gap, inside=lambda: INSIDE, departures=forms)[2].rounded.any()


def test_rounding_is_no_reason_where_nothing_that_it_decides_acts(rng):
    """What "c" takes away would explain all; but for noise it takes 0.1 more than what is missing."""
    effects = {"a": NOTHING, "b": NOTHING, "c": np.full(5, -0.3)}
    for gap in (-0.3, -0.3 - 0.9 * TOLERANCE, -0.2):
        why = found(rng, np.full(5, gap), effects)
        assert not why.rounded.any()
        assert why.state is not State.ROUNDED
