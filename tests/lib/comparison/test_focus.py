# SPDX-License-Identifier: GPL-3.0-or-later
"""Rounds in a part of the image: as long as one of the whole, and never past a look.

Where time is short, they are for what keeps the bound of the image up.
"""

import math

import numpy as np
import pytest
from etalon.lib.comparison.attainable import Attainable, Standing
from etalon.lib.comparison.compare import ASIDE_SHARE, CompareOptions, compare
from etalon.lib.comparison.departures import Alternatives
from etalon.lib.comparison.focus import CHEAP, choose_regions, find_windows, part_of, weigh_round
from etalon.lib.comparison.pace import Pace
from etalon.lib.departures.catalogue import Departure
from etalon.lib.film.regions import image_regions
from etalon.lib.film.windows import CALL, Windows
from etalon.lib.verdict.boundaries import next_look
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.sequential import Look, SequentialTest
from etalon.tests.lib.renderers import Clock, Painter, blank, grey
from scipy import stats

SIDE, CELL, REPLICATES, LEVEL = 64, 16, 12, 1e-3
NONE = np.zeros(17, bool)


def timed(fixed=0.0):
    """A pace of one second for each replicate of the image."""
    pace = Pace(fixed)
    pace.learn(8.0, 1.0, 8, 8)
    return pace


def window(share):
    """One window that fills a `share` of a large image."""
    return Windows((1000, 1000), ((0, 0, 999, max(round(1000 * share), 1) - 1),))


@pytest.mark.parametrize("share", [0.7, 0.3, 0.04, 1e-3])
@pytest.mark.parametrize("most", [None, 100])
def test_rounds_end_at_every_look_and_cost_no_more_than_the_whole_image(share, most):
    replicates = 8
    while replicates < 100:
        weight = weigh_round(window(share), replicates, 1024, next_look(replicates), most)
        assert 1 <= weight <= max(1 / share, 1)
        assert replicates + weight <= next_look(replicates)
        replicates += weight
    assert most is None or replicates == most


def test_rounds_of_many_windows_are_long_enough_to_pay_for_their_calls():
    many = Windows((1000, 1000), tuple((x, 0, x + 9, 649) for x in range(0, 1000, 10)))
    weight = weigh_round(many, 100, 2, 500)
    assert weight * 2 * many.pixels >= CHEAP * CALL * 100
    assert weigh_round(many, 100, 2, 103) == 3


def test_rounds_up_to_a_look_are_about_equal():
    assert weigh_round(window(1 / 7), 48, 8, 56) == 4


def test_a_round_has_no_more_samples_than_a_renderer_adds_up():
    assert weigh_round(window(1e-3), 1000, 4096, 1200) == 1
    assert weigh_round(window(1e-3), 1000, 1024, 1200) == 4


def test_small_parts_are_worth_windows_and_large_ones_are_not():
    regions = image_regions(64, 64, {}, (16,), None)
    cells = regions.families == regions.families.max()
    wanted = np.zeros(len(regions), bool)
    assert find_windows(regions, wanted, 8, 8) is None
    wanted[np.flatnonzero(cells)[:2]] = True
    assert find_windows(regions, wanted, 8, 8).mask.mean() == 2 / 16
    assert find_windows(regions, cells, 8, 8) is None


def test_windows_follow_what_is_seen_of_a_region_not_its_box():
    frame = np.ones((400, 400))
    frame[20:-20, 20:-20] = 0.0
    regions = image_regions(400, 400, {"object": [("frame", frame)]}, (400,))
    found = find_windows(regions, np.array([False, True, False]), 64, 40)
    assert (found.mask >= (frame > 0)).all()
    assert found.mask.mean() < 1.3 * frame.mean()


def test_what_is_rendered_anyway_takes_part_if_it_has_as_many_replicates():
    """The upper row of cells, of which the second has more replicates and the third has lost pixels."""
    regions = image_regions(SIDE, SIDE, {}, (CELL,))
    replicates = np.full(17, 12)
    replicates[2] = 15
    wanted, lost = NONE.copy(), NONE.copy()
    wanted[[1, 4]], lost[3] = True, True
    # Few samples: one window for both is cheaper than two.
    part = part_of(regions, wanted, replicates, lost, 1, timed())
    assert part.windows.boxes == ((0, 0, 63, 15),)
    assert np.flatnonzero(part.of).tolist() == [1, 4]
    replicates[2], lost[3] = 12, False
    assert np.flatnonzero(part_of(regions, wanted, replicates, lost, 1, timed()).of).tolist() == [1, 2, 3, 4]


def test_small_parts_pass_over_looks_while_calls_cost_more_than_pixels():
    regions = image_regions(SIDE, SIDE, {}, (CELL,))
    wanted = NONE.copy()
    wanted[1] = True
    targets = [part_of(regions, wanted, np.full(17, 40), NONE, 1, timed(fixed)).target for fixed in (0.0, 0.3, 0.9)]
    assert targets == [48, 48, 58]


def judged(bounds, rare=0.0, image=0.005):
    """A test of an image and its 16 cells after a look, where they stand, and what they cost."""
    regions = image_regions(SIDE, SIDE, {}, (CELL,))
    test = SequentialTest(len(regions), 0.01, 0.99, families=regions.families)
    test.bounds, test.rare = np.array([image, *bounds]), np.full(len(regions), rare)
    test.looks.append(Look((REPLICATES, REPLICATES), 0.1, LEVEL, 16, max(bounds)))
    counts = np.full(len(regions), REPLICATES)
    return test, Standing(counts, counts, test.bounds), Attainable(regions), ~test.within


def test_the_noisiest_are_sampled_where_time_is_short():
    test, now, cost, wanted = judged([0.5] + [0.03] * 15)
    assert np.flatnonzero(choose_regions(test, cost, now, wanted, timed(), 8.0, False)).tolist() == [1]


def test_time_that_is_too_short_for_all_of_the_worst_is_spent_on_some_of_them():
    test, now, cost, wanted = judged([0.5] + [0.03] * 15)
    assert np.flatnonzero(choose_regions(test, cost, now, wanted, timed(), 1e-3, True)).tolist() == [1]
    # Without a limit, what no samples will lower is left.
    test.unsupported[1] = 0.5
    assert choose_regions(test, cost, now, np.arange(17) == 1, timed(), math.inf, True).sum() == 0


def test_all_goes_on_where_time_is_enough_or_nothing_is_gained():
    test, now, cost, wanted = judged([0.03] * 15 + [0.4])
    assert (choose_regions(test, cost, now, wanted, timed(), 1e4, False) == wanted).all()
    test, now, cost, wanted = judged([0.05] * 16)
    assert (choose_regions(test, cost, now, wanted, timed(), 8.0, False) == wanted).all()


def test_the_whole_image_comes_first_while_half_of_the_time_decides_it():
    test, now, cost, wanted = judged([0.03] * 15 + [0.4], image=0.012)
    assert choose_regions(test, cost, now, wanted, timed(), 30.0, False).all()
    test, now, cost, wanted = judged([0.03] * 15 + [0.4], image=0.03)
    assert np.flatnonzero(choose_regions(test, cost, now, wanted, timed(), 30.0, False)).tolist() == [16]


def test_those_with_as_many_replicates_as_the_worst_are_sampled_together():
    test, now, cost, wanted = judged([0.5, 0.5, 0.4, 0.05] + [0.015] * 12)
    counts = now.replicates.copy()
    counts[2] = 22
    now = Standing(counts, counts, now.bounds)
    assert np.flatnonzero(choose_regions(test, cost, now, wanted, timed(), 20.0, True)).tolist() == [1, 3]


def uneven(monkeypatch, gap, number, change=None, noise=(0.4, 8.0), among=None):
    """A comparison on a clock of a picture one of whose cells is noisier, and in which Cycles is brighter by `gap`."""
    clock = Clock()
    monkeypatch.setattr("etalon.lib.comparison.run.time", clock)
    truth, sigma = grey(1.0, 96, 96), np.full((96, 96, 1), noise[0])
    sigma[:CELL, :CELL] = noise[1]
    brighter = truth.copy()
    brighter[:CELL, :CELL] *= 1.0 + gap
    sides = [
        Painter(f"{name} {number}", image, sigma, clock=clock, cost=(0.01, 0.05), change=change)
        for name, image in (("the reference", truth), ("Cycles", brighter))
    ]
    return compare(blank(96, 96), *sides, {}, CompareOptions(time=60.0), among=among), sides


def test_a_noisy_part_is_sampled_more_than_the_rest(monkeypatch):
    found, sides = uneven(monkeypatch, 0.0, 0)
    counts = found.candidate.regions.moments.n
    worst = found.regions.names.index("x 0 to 15, y 0 to 15")
    windows = [window for window in sides[0].windows if window is not None]
    assert windows[0].mask.mean() < 0.1
    assert counts[worst] == counts.max() > 2 * np.median(counts)
    plain = np.sqrt(counts[worst] / np.median(counts))
    assert found.verdict.bound < 0.75 * found.verdict.bounds[worst] * plain


def test_time_kept_for_causes_is_sampled_in_parts_where_nothing_differs(monkeypatch):
    among = Alternatives((Departure("one", "", ""),), lambda names: Painter("the reference", grey(1.0, 96, 96), 0.1))
    found, _ = uneven(monkeypatch, 0.0, 0, among=among)
    assert found.explanation is None
    assert 60.0 - 0.2 * ASIDE_SHARE * 60.0 < found.seconds <= 60.0


def test_no_replicate_is_rendered_twice_and_regions_that_were_left_come_again(monkeypatch):
    """The noise of all other cells, once the worst has come near to them, is what is left to lower."""
    found, sides = uneven(monkeypatch, 0.0, 0, noise=(1.5, 5.0))
    numbers = [number for number, _ in sides[0].asked]
    assert len(set(numbers)) == len(numbers)
    rendered = np.array([np.ones((96, 96), bool) if one is None else one.mask for one in sides[1].windows])
    left = np.cumsum(~rendered, axis=0) > 0
    assert (left & rendered).any()
    bounds = found.verdict.bounds[found.verdict.families == found.verdict.families.max()]
    assert bounds.max() < 1.3 * np.median(bounds)


def test_a_region_that_loses_a_pixel_is_sampled_no_more_where_its_pixels_are_unequal(monkeypatch):
    """The whole image was left behind, so what the pixel has added to its mean is not known."""

    def change(replicate, image):
        if replicate >= 150:
            image[3, 4] = np.nan
        return image

    found, _ = uneven(monkeypatch, 0.0, 1, change)
    assert np.argwhere(found.excluded).tolist() == [[3, 4]]
    regions, sizes = found.regions, found.candidate.regions.sizes
    assert sizes[regions.names.index("whole image")] == 96 * 96
    assert sizes[regions.names.index("x 0 to 15, y 0 to 15")] == CELL * CELL - 1
    assert np.isfinite(found.verdict.bounds).all()


@pytest.mark.slow
def test_bounds_hold_where_sampling_goes_where_they_are_large(monkeypatch):
    """The noisy cell is off by 5 %: its bound is smaller, or it is EQUIVALENT, in less than the error level of 1 %."""
    runs, gap = 60, 0.05
    found = [uneven(monkeypatch, gap, k)[0] for k in range(runs)]
    assert sum(one.verdict.bound < gap for one in found) <= stats.binom.ppf(0.999, runs, 0.01)
    assert not any(
        (one.verdict.outcomes[one.regions.boxes[:, :2].max(axis=1) == 0] == Outcome.EQUIVALENT)[-1] for one in found
    )
