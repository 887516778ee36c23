# SPDX-License-Identifier: GPL-3.0-or-later
"""The time that the search for causes takes, and how it is shared out.

Renderers move a clock of their own.
"""

from collections import Counter

import pytest
from etalon.lib.comparison import run as module
from etalon.lib.comparison.compare import ASIDE_SHARE, CompareOptions, compare
from etalon.lib.comparison.departures import Alternatives
from etalon.lib.comparison.meter import ASIDE_AT_MOST, Meter
from etalon.lib.comparison.run import Stop
from etalon.lib.departures.catalogue import Departure
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.sampling.streams import DEPARTURES
from etalon.lib.verdict.causes import State
from etalon.tests.lib.renderers import Clock, Painter, blank, grey

NAMES = ("a", "b", "c")
TIME = 40.0


def searched(monkeypatch, cost, sigma=2.0, gap=1.2):
    """A comparison in TIME whose sides differ everywhere.

    Each image with a departure takes `cost` seconds. Returns it with the pairs that each departure was given, as (name,
    replicate).
    """
    clock, pairs = Clock(), []
    monkeypatch.setattr(module, "time", clock)

    def departed(names):
        def note(replicate, image):
            pairs.append((*names, replicate))
            return image

        return Painter("the reference", grey(), sigma, clock=clock, cost=(cost, 0.0), change=note if names else None)

    among = Alternatives(tuple(Departure(name, "", "") for name in NAMES), departed)
    sides = [
        Painter(name, grey(value), sigma, clock=clock, cost=(0.5, 0.0))
        for name, value in (("the reference", 1.0), ("b", gap))
    ]
    options = CompareOptions(time=TIME, samples=4)
    return compare(blank(), *sides, {}, options, among=among), pairs, clock.now - 100.0


def test_effects_take_no_more_than_their_part_and_the_whole_keeps_its_time(monkeypatch):
    found, pairs, spent = searched(monkeypatch, cost=0.6)
    assert found.explanation.seconds > ASIDE_SHARE * TIME
    assert found.explanation.seconds <= ASIDE_AT_MOST * TIME + 2 * 0.6  # a pair that is begun is finished
    assert spent <= TIME + 2 * 0.6
    assert len(pairs) > 6


@pytest.mark.parametrize("cost", [0.3, 0.6, 1.0])
def test_time_is_shared_out_evenly_among_departures(monkeypatch, cost):
    """No departure waits until another has all of its pairs.

    The true one may be the last in the catalogue.
    """
    _, pairs, _ = searched(monkeypatch, cost)
    counts = Counter(name for name, _ in pairs)
    assert set(counts) == set(NAMES)
    assert max(counts.values()) - min(counts.values()) <= 1
    assert all(replicate >= DEPARTURES.first for _, replicate in pairs)


def test_a_look_after_the_time_set_aside_is_overdrawn_is_not_the_last(monkeypatch):
    """When sampling ends depends on what was seen by then.

    So no look may spend what is left of the level.
    """
    found, _, _ = searched(monkeypatch, cost=0.6, sigma=5.0)
    looks = found.verdict.looks
    assert len(looks) > 1
    assert len({look.share for look in looks}) == 1
    assert found.stopped is Stop.TIME
    cheap, _, _ = searched(monkeypatch, cost=1e-3, sigma=20.0, gap=1.0)
    assert sum(look.share for look in cheap.verdict.looks) == pytest.approx(1.0)


def test_causes_of_what_differs_at_the_very_end_have_their_time(monkeypatch):
    clock = Clock()
    monkeypatch.setattr("etalon.lib.comparison.run.time", clock)
    meter = Meter(CompareOptions(time=TIME), NO_PROGRESS, ASIDE_SHARE)
    clock.now += 1.01 * TIME
    assert meter.has_time_aside(last=False)
    meter.spent_aside = ASIDE_SHARE * TIME
    assert not meter.has_time_aside(last=False)


def test_departures_for_which_no_time_is_left_are_said_not_to_be_measured(monkeypatch):
    monkeypatch.setattr("etalon.lib.comparison.meter.ASIDE_AT_MOST", 0.0)
    monkeypatch.setattr("etalon.lib.comparison.compare.ASIDE_SHARE", 0.0)
    found, pairs, _ = searched(monkeypatch, cost=0.6)
    assert pairs == []
    assert found.explanation.state is State.NO_TIME


def test_departures_are_measured_where_the_first_look_is_all_there_is(monkeypatch):
    """Rounds of 6 s in a minute: 8 of them after the timed calls, and no main run."""
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    among = Alternatives(
        tuple(Departure(name, "", "") for name in NAMES),
        lambda names: Painter("the reference", grey(), 0.05, clock=clock, cost=(0.6, 0.0)),
    )
    sides = [
        Painter(name, grey(value), 0.05, clock=clock, cost=(2.8, 0.0))
        for name, value in (("the reference", 1.0), ("b", 1.2))
    ]
    found = compare(blank(), *sides, {}, CompareOptions(time=60.0), among=among)
    assert [bound.first for bound in found.history] == [True]
    assert found.verdict.outcome.value == "DIFFERENT"
    assert found.explanation.pairs > 0
    assert found.explanation.state is not State.NO_TIME
    assert clock.now - 100.0 <= 1.05 * 60.0
