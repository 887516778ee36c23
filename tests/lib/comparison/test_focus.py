# SPDX-License-Identifier: GPL-3.0-or-later
"""Rounds in a part of the image: as long as one of the whole, and never past a look.

Where time is short, they are for what keeps the bound of the image up.
"""

import numpy as np
import pytest
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.focus import HOPE, WORTHWHILE, decisive_regions, focus, weigh_round
from etalon.lib.film.regions import image_regions
from etalon.lib.verdict.boundaries import next_look
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.sequential import Look, SequentialTest
from etalon.tests.lib.renderers import Clock, Painter, blank, grey
from scipy import stats

SIDE, CELL, REPLICATES, LEVEL = 64, 16, 12, 1e-3


@pytest.mark.parametrize("share", [0.7, 0.3, 0.04, 1e-4])
@pytest.mark.parametrize("most", [None, 100])
def test_rounds_end_at_every_look_and_cost_no_more_than_the_whole_image(share, most):
    replicates = 8
    while replicates < 100:
        weight = weigh_round(share, replicates, 8, most)
        assert 1 <= weight <= max(1 / share, 1)
        assert replicates + weight <= next_look(replicates)
        replicates += weight
    assert most is None or replicates == most


def test_a_round_has_no_more_samples_than_a_renderer_adds_up():
    assert weigh_round(1e-4, 1000, 4096) == 1
    assert weigh_round(1e-4, 1000, 1024) == 4


def test_small_parts_are_worth_windows_and_large_ones_are_not():
    regions = image_regions(64, 64, {}, (16,), None)
    cells = regions.families == regions.families.max()
    wanted = np.zeros(len(regions), bool)
    assert focus(regions, wanted, 8, 8) is None
    wanted[np.flatnonzero(cells)[:2]] = True
    assert focus(regions, wanted, 8, 8).mask.mean() == 2 / 16
    assert focus(regions, cells, 8, 8) is None


def judged(bounds, rare=0.0):
    """A test of an image and its 16 cells after a look, and its regions: the image is within the tolerance."""
    regions = image_regions(SIDE, SIDE, {}, (CELL,))
    test = SequentialTest(len(regions), 0.01, 0.99, families=regions.families)
    test.bounds, test.rare = np.array([0.005, *bounds]), np.full(len(regions), rare)
    test.looks.append(Look((REPLICATES, REPLICATES), 0.1, LEVEL, 16, max(bounds)))
    return test, regions, ~test.within


def at_the_end(test, kept, wanted, rounds):
    """The bound of the image at the end, by the formulas of docs/statistics.md, if `kept` get all the time and luck."""
    growth = 1.0 + rounds * wanted.sum() / kept.sum() / REPLICATES
    quantiles = [stats.t.isf(LEVEL, 2 * (n - 1)) for n in (REPLICATES, REPLICATES * growth)]
    noise = (test.bounds - test.rare) * quantiles[1] / quantiles[0] / np.sqrt(growth)
    return np.where(kept, HOPE * (noise + test.rare / growth), test.bounds)[wanted].max()


@pytest.mark.parametrize("rare", [0.0, 0.008])
@pytest.mark.parametrize("rounds", [3.0, 10.0, 40.0])
def test_the_time_goes_where_the_bound_of_the_image_falls_most(rng, rounds, rare):
    """No other number of cells with the largest bounds does better."""
    test, regions, wanted = judged(0.06 + 0.06 * rng.random(16) + 0.5 * (np.arange(16) == 5), rare)
    kept = decisive_regions(test, regions, wanted, rounds)
    order = np.argsort(-test.bounds[1:]) + 1
    others = []
    for count in range(1, 17):
        chosen = np.zeros(17, bool)
        chosen[order[:count]] = True
        others.append(at_the_end(test, chosen, wanted, rounds))
    assert at_the_end(test, kept, wanted, rounds) == pytest.approx(min(others))
    assert min(others) <= WORTHWHILE * others[-1]
    assert not kept[0]


def test_what_the_time_decides_is_not_given_up():
    """Four cells need a few more replicates, and one hundreds."""
    test, regions, wanted = judged([0.5] + [0.011] * 4 + [0.03] * 11)
    kept = decisive_regions(test, regions, wanted, 8.0)
    assert kept.tolist() == [False] + [True] * 5 + [False] * 11


def test_all_goes_on_where_time_is_enough_or_nothing_is_gained():
    test, regions, wanted = judged([0.03] * 15 + [0.04])
    assert (decisive_regions(test, regions, wanted, 400.0) == wanted).all()
    assert (decisive_regions(test, regions, wanted, 8.0) == wanted).all()
    test, regions, wanted = judged([0.03] * 15 + [0.4])
    assert decisive_regions(test, regions, wanted, 8.0).sum() == 1
    assert (decisive_regions(test, regions, wanted, np.inf) == wanted).all()
    assert (decisive_regions(test, regions, wanted, -0.5) == wanted).all()
    test.bounds[3] = np.inf
    assert (decisive_regions(test, regions, wanted, 8.0) == wanted).all()


def test_the_whole_image_comes_first():
    test, regions, _ = judged([0.03] * 15 + [0.4])
    test.bounds[0] = 0.02
    assert decisive_regions(test, regions, ~test.within, 8.0).all()


def uneven(monkeypatch, gap, number):
    """A comparison on a clock of a picture one of whose cells is far noisier, and in which Cycles is brighter by `gap`."""
    clock = Clock()
    monkeypatch.setattr("etalon.lib.comparison.run.time", clock)
    truth, sigma = grey(1.0, 96, 96), np.full((96, 96, 1), 0.4)
    sigma[:CELL, :CELL] = 8.0
    brighter = truth.copy()
    brighter[:CELL, :CELL] *= 1.0 + gap
    sides = [
        Painter(f"{name} {number}", image, sigma, clock=clock, cost=(0.01, 0.05))
        for name, image in (("the reference", truth), ("Cycles", brighter))
    ]
    return compare(blank(96, 96), *sides, {}, CompareOptions(time=60.0)), sides


def test_a_noisy_part_is_sampled_more_than_the_rest(monkeypatch):
    found, sides = uneven(monkeypatch, 0.0, 0)
    counts = found.candidate.regions.moments.n
    worst = found.regions.names.index("x 0 to 15, y 0 to 15")
    assert sides[0].windows[-1].mask.mean() < 0.1
    assert counts[worst] == counts.max() > 2 * np.median(counts)
    plain = np.sqrt(counts[worst] / np.median(counts))
    assert found.verdict.bound < 0.75 * found.verdict.bounds[worst] * plain


@pytest.mark.slow
def test_bounds_hold_where_sampling_goes_where_they_are_large(monkeypatch):
    """The noisy cell is off by 5 %: its bound is smaller, or it is EQUIVALENT, in less than the error level of 1 %."""
    runs, gap = 60, 0.05
    found = [uneven(monkeypatch, gap, k)[0] for k in range(runs)]
    assert sum(one.verdict.bound < gap for one in found) <= stats.binom.ppf(0.999, runs, 0.01)
    assert not any(
        (one.verdict.outcomes[one.regions.boxes[:, :2].max(axis=1) == 0] == Outcome.EQUIVALENT)[-1] for one in found
    )
