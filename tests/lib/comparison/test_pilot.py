# SPDX-License-Identifier: GPL-3.0-or-later
"""The layout of a comparison's time.

It is the first look, the main run, and the grids; and the time limit is kept.
"""

import numpy as np
import pytest
from etalon.lib.comparison import run as module
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.pilot import SPARE, balance_samples, choose_grids, coarse_grid, time_calls
from etalon.lib.comparison.run import Stop, TimedRun
from etalon.lib.errors import Cancelled
from etalon.lib.progress import NO_PROGRESS
from etalon.lib.verdict.allocation import Cost, fit_cost
from etalon.tests.lib.renderers import Clock, Painter, blank, grey


class Uneven(Painter):
    """A painter some of whose calls, by their number, take longer than their samples do.

    It looks up while it works.
    """

    def __init__(self, *arguments, late, **more):
        super().__init__(*arguments, **more)
        self.late, self.calls = late, 0

    def render(self, replicate, samples, progress, windows=None):
        for _ in range(20):
            self.clock.now += self.late(self.calls) / 20
            progress.check()
        self.calls += 1
        return super().render(replicate, samples, progress, windows)


def compared(monkeypatch, seconds, late=lambda call: 0.0, cost=(0.1, 0.01), sigma=5.0, size=(32, 32)):
    """A comparison by the clock, whose reference is `late`; and how long it took."""
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    reference = Uneven("the reference", grey(1.0, *size), sigma, clock=clock, cost=cost, late=late)
    candidate = Painter("Cycles", grey(1.0, *size), sigma, clock=clock, cost=cost)
    found = compare(blank(*size), reference, candidate, {}, CompareOptions(time=seconds))
    return found, clock.now - 100.0


@pytest.mark.parametrize("seconds", [5.0, 15.0, 60.0, 600.0])
def test_the_time_is_kept_and_the_first_bound_comes_early(monkeypatch, seconds):
    found, spent = compared(monkeypatch, seconds)
    assert spent <= 1.05 * seconds
    assert found.stopped is Stop.TIME
    assert found.candidate.replicates >= 8
    assert found.history[0].first
    assert found.history[0].seconds <= max(0.3 * seconds, 5.0)
    assert found.history[0].seconds <= 12.0


@pytest.mark.grid(3)
@pytest.mark.parametrize("call", [0, 1, 2, 3, 4, 12, 30])
def test_one_call_on_a_busy_moment_does_not_spoil_the_run(monkeypatch, call):
    """A hiccup of 4 s, at any call: not the pilot's, nor another one's."""
    found, spent = compared(monkeypatch, 60.0, late=lambda now: 4.0 if now == call else 0.0)
    assert spent <= 66.0
    assert found.candidate.replicates >= 12


def test_a_call_that_outruns_the_time_is_cut_short(monkeypatch):
    found, spent = compared(monkeypatch, 60.0, late=lambda call: 500.0 if call == 40 else 0.0)
    assert spent <= 60.0 * 1.05 + 500.0 / 20
    assert found.stopped is Stop.TIME
    assert np.isfinite(found.verdict.bound)


def test_a_second_is_enough_for_an_answer(monkeypatch):
    found, spent = compared(monkeypatch, 1.0)
    assert found.verdict.outcome.value in {"EQUIVALENT", "UNDECIDED"}
    assert found.candidate.replicates >= 2
    assert spent < 3.0


def test_slow_renders_still_give_two_replicates(monkeypatch):
    found, _ = compared(monkeypatch, 5.0, cost=(2.0, 0.01))
    assert found.candidate.replicates == 2
    assert found.stopped is Stop.TIME


def test_the_first_looks_samples_are_not_used_by_the_main_run(monkeypatch):
    """Numbers of replicates go on, so that no image counts twice."""
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    sides = [Painter(name, grey(1.0, 32, 32), 5.0, clock=clock, cost=(0.1, 0.01)) for name in ("a", "b")]
    found = compare(blank(32, 32), *sides, {}, CompareOptions(time=60.0))
    counted = [number for number, _ in sides[0].asked if number < 1 << 18]
    assert counted == list(range(len(counted)))
    assert found.reference.replicates == len(counted) - 8
    assert found.reference.regions.series.shape[0] == found.reference.replicates


@pytest.mark.parametrize(
    ("width", "height", "edge"), [(1920, 1080, 128), (256, 256, 16), (480, 270, 32), (3840, 2160, 256), (5, 3, 16)]
)
def test_the_coarse_grid_has_about_16_by_9_cells(width, height, edge):
    assert coarse_grid(height, width) == edge


def test_grids_are_halved_as_long_as_the_time_decides_their_cells():
    quiet, noisy = np.full(100, 1e-4), np.full(100, 4.0)
    assert choose_grids(128, quiet, 0.003) == (128, 64, 32, 16)
    # A pixel's mean has a deviation of 2; a cell of 64 x 64 pixels one of 2 / 64.
    assert choose_grids(128, noisy, SPARE * 2 / 64 * 1.01) == (128, 64)
    assert choose_grids(128, noisy, 1e-9) == (128,)
    assert choose_grids(64, np.zeros(100), 0.003) == (64, 32, 16)
    assert choose_grids(64, np.full(3, np.nan), 0.003) == (64,)


@pytest.mark.parametrize("rest", [0.0, 1e-14])
def test_a_few_noisy_cells_have_all_the_time_and_no_more(rest):
    """4 of 100 cells get 25 times the samples of a run that renders all of them equally often."""
    few = np.where(np.arange(100) < 4, 1.0, rest)
    alone = SPARE * np.sqrt(1.0 / 25) / np.array([64, 32, 16])
    for count, error in enumerate(alone, 1):
        assert choose_grids(128, few, error * 1.001) == (128, 64, 32, 16)[: count + 1]
        assert choose_grids(128, few, error * 0.999) == (128, 64, 32, 16)[:count]


@pytest.mark.parametrize(
    ("costs", "seconds", "samples"),
    [
        ((1.0, 1.0), 60.0, (1, 1)),
        ((1.0, 0.3), 60.0, (1, 1)),
        ((1.0, 0.06), 60.0, (1, 4)),
        ((0.06, 1.0), 60.0, (4, 1)),
        ((1.0, 0.06), 14.0, (1, 1)),
        ((1.0, 1e-9), 60.0, (1, 64)),
    ],
)
def test_a_slow_side_gets_one_sample_and_the_other_more(costs, seconds, samples):
    assert balance_samples((Cost(0.0, costs[0]), Cost(0.0, costs[1])), seconds) == samples


@pytest.mark.parametrize("fixed", [0.0, 0.2])
@pytest.mark.parametrize("ratio", [1.0, 0.7, 0.25, 0.17, 0.1, 0.01, 0.001])
def test_balanced_samples_have_no_more_variance_in_the_same_time(ratio, fixed):
    """As much noise on both sides: variance times seconds, against one sample on each."""
    costs = Cost(0.0, 1.0), Cost(fixed, ratio)
    found = [
        (1 / a + 1 / b) * (costs[0].seconds(a) + costs[1].seconds(b)) for a, b in (balance_samples(costs, 1e9), (1, 1))
    ]
    assert found[0] <= found[1]


def timed(monkeypatch, cost, seconds=60.0, late=lambda call: 0.0):
    """The samples of the calls that are timed of one side, and the cost that they give."""
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    sides = [Uneven(name, grey(), clock=clock, cost=cost, late=late) for name in ("the reference", "Cycles")]
    timings = time_calls((sides[0], sides[1]), TimedRun(seconds, NO_PROGRESS))
    return [samples for _, samples in sides[0].asked], timings[0].cost


@pytest.mark.parametrize(
    ("cost", "asked"),
    [
        ((0.1, 0.1), [1, 4]),  # 0.5 s are more than twice 0.2 s
        ((0.1, 0.01), [1, 4, 16, 64]),
        ((0.1, 0.015), [1, 4, 16]),
        ((0.1, 0.0), [1, 4, 16, 64]),
        ((0.2, 0.5), [1, 4]),  # 4 x 0.7 s are less than 5 % of a minute
        ((0.2, 0.6), [1, 1]),
    ],
)
def test_calls_are_timed_until_one_takes_twice_as_long_as_the_one_before(monkeypatch, cost, asked):
    found, fitted = timed(monkeypatch, cost)
    assert found == asked
    if asked[-1] > 1 and cost[1] > 0.0:
        assert (fitted.fixed, fitted.per_sample) == pytest.approx(cost)


@pytest.mark.parametrize("call", [0, 1, 2])
def test_a_timed_call_on_a_busy_moment_is_not_taken_for_the_cost_of_samples(monkeypatch, call):
    _, fitted = timed(monkeypatch, (0.1, 0.04), late=lambda now: 1.0 if now == call else 0.0)
    assert fitted.per_sample == pytest.approx(0.04, rel=0.25)


def test_one_spoiled_timing_does_not_make_samples_free():
    assert fit_cost([1, 4, 16], [9.0, 0.2, 0.5]).per_sample >= 0.1 * 0.5 / 16
    cost = fit_cost([1, 4, 16], [0.11, 0.14, 0.26])
    assert cost.per_sample == pytest.approx(0.01)
    assert cost.fixed == pytest.approx(0.1)
    assert fit_cost([4], [2.0]).seconds(8) == pytest.approx(4.0)


def test_a_user_who_cancels_keeps_what_there_is(monkeypatch):
    with pytest.raises(Exception, match="nothing to compare"):
        compared(monkeypatch, 60.0, late=lambda call: (_ for _ in ()).throw(Cancelled("now")))
