# SPDX-License-Identifier: GPL-3.0-or-later
"""The whole comparison with renderers whose truth is known.

Tested are verdicts, limits, cancelling, bad pixels, and bad options.
"""

import json

import numpy as np
import pytest
from etalon.lib.comparison import run as module
from etalon.lib.comparison.compare import CompareOptions, compare
from etalon.lib.comparison.run import Stop
from etalon.lib.errors import EtalonError
from etalon.lib.files.plain_data import make_plain
from etalon.lib.progress import Progress
from etalon.lib.sampling.streams import FIRST_CALLS
from etalon.lib.verdict.outcome import Outcome
from etalon.tests.lib.renderers import Clock, Painter, blank, grey

FIXED = CompareOptions(time=None, samples=16, replicates=40)


def run(truth=None, other=None, options=FIXED, sigma=0.05, scene=None, change=None, **more):
    truth = grey() if truth is None else truth
    reference = Painter("the reference", truth, sigma)
    candidate = Painter("Cycles", truth if other is None else other, sigma, change=change)
    return compare(scene or blank(), reference, candidate, more.pop("coverage", {}), options, **more)


def test_the_same_image_is_equivalent_and_sampling_ends_there():
    found = run()
    assert found.verdict.outcome is Outcome.EQUIVALENT
    assert found.stopped is Stop.DECIDED
    assert found.verdict.forecast is None
    assert 8 <= found.reference.film.moments.least < 40
    assert found.verdict.reasons == ()


def test_a_difference_is_found_where_it_is():
    other = grey()
    other[:, :16] *= 1.05
    found = run(other=other)
    assert found.verdict.outcome is Outcome.DIFFERENT
    named = dict(zip(found.regions.names, found.verdict.outcomes, strict=True))
    assert named["x 0 to 15, y 0 to 19"] is Outcome.DIFFERENT
    assert named["x 16 to 23, y 0 to 19"] is Outcome.EQUIVALENT
    block = found.regions.names.index("x 0 to 15, y 0 to 19")
    assert (found.verdict.low[block] <= 0.05).all()
    assert (found.verdict.high[block] >= 0.05).all()


def test_noise_beyond_the_budget_is_undecided_with_a_forecast():
    found = run(sigma=3.0)
    assert found.verdict.outcome is Outcome.UNDECIDED
    assert found.stopped is Stop.REPLICATES
    assert found.reference.film.moments.n == found.candidate.film.moments.n == 40
    assert 1 < found.verdict.forecast.factor < np.inf


def test_replicates_are_numbered_from_nought_and_never_twice():
    reference, candidate = Painter("a", grey(), 3.0), Painter("b", grey(), 3.0)
    compare(blank(), reference, candidate, {}, FIXED)
    assert reference.asked == candidate.asked == [(k, 16) for k in range(40)]


def test_samples_of_both_sides_may_differ():
    found = run(options=CompareOptions(time=None, samples=(4, 32), replicates=9))
    assert (found.reference.film.samples, found.candidate.film.samples) == (4, 32)


def test_coverage_makes_regions_by_the_users_names():
    half = np.zeros((20, 24))
    half[:, :12] = 1.0
    other = grey() * (1 + 0.05 * half[..., None])
    found = run(other=other, coverage={"material": [("Gold", half), ("Silver", 1 - half)]})
    named = dict(zip(found.regions.names, found.verdict.outcomes, strict=True))
    assert named["Gold"] is Outcome.DIFFERENT
    assert named["Silver"] is Outcome.EQUIVALENT


def noisy_corner():
    """What makes the first block of an image far noisier than the rest."""

    def change(replicate, image):
        rng = np.random.default_rng(replicate)
        image[:16, :16] *= 1 + 0.03 * rng.standard_normal((1, 1, 1))
        return image

    return change


def test_sampling_goes_on_where_it_is_undecided():
    scene = blank(96, 80)
    reference = Painter("the reference", grey(1.0, 96, 80), 0.01)
    candidate = Painter("Cycles", grey(1.0, 96, 80), 0.01, change=noisy_corner())
    found = compare(scene, reference, candidate, {}, CompareOptions(time=None, samples=16, replicates=2000))
    assert found.verdict.outcome is Outcome.EQUIVALENT
    corner = found.regions.names.index("x 0 to 15, y 0 to 15")
    assert found.verdict.decided_at[corner] == found.reference.replicates > 30
    assert {n for n in found.verdict.decided_at} <= {look.replicates[1] for look in found.verdict.looks}
    for side in (reference, candidate):
        assert side.windows[0] is None
        assert side.windows[-1].boxes == ((0, 0, 15, 15),)
    # Each interval is of the look at which its region was judged last: no wider than what was claimed then.
    assert max(found.verdict.high.max(), -found.verdict.low.min()) < 0.0115
    n = found.reference.film.moments.n
    assert (n[:16, :16] == found.reference.replicates).all()
    assert (n[16:, 16:] < n[0, 0]).all()


def test_a_difference_in_a_part_is_found_as_in_the_whole():
    scene, other = blank(96, 80), grey(1.0, 96, 80)
    other[:16, :16] *= 1.05
    reference = Painter("the reference", grey(1.0, 96, 80), 0.01)
    candidate = Painter("Cycles", other, 0.01, change=noisy_corner())
    found = compare(scene, reference, candidate, {}, CompareOptions(time=None, samples=16, replicates=2000))
    assert found.verdict.outcome is Outcome.DIFFERENT
    assert candidate.windows[-1] is not None
    corner = found.regions.names.index("x 0 to 15, y 0 to 15")
    assert (found.verdict.low[corner] < 0.05).all()
    assert (found.verdict.high[corner] > 0.05).all()


@pytest.mark.slow
def test_decisions_are_those_of_whole_images(monkeypatch):
    """Parts save time, and change no decision.

    Each region is judged on the same replicates at the same numbers of them.
    """

    def decide():
        reference = Painter("the reference", grey(1.0, 96, 80), 0.1)
        candidate = Painter("Cycles", grey(1.003, 96, 80), 0.1, change=noisy_corner())
        options = CompareOptions(time=None, samples=1, replicates=533)
        return compare(blank(96, 80), reference, candidate, {}, options), candidate.windows

    parts, windows = decide()
    assert windows[-1] is not None
    monkeypatch.setattr("etalon.lib.comparison.focus.LARGEST", 0.0)
    whole, windows = decide()
    assert windows[-1] is None
    assert (parts.verdict.outcomes == whole.verdict.outcomes).all()
    assert (parts.verdict.bounds <= parts.verdict.tolerance).all()
    # What was sampled to the end is judged on the same replicates, to the last bit.
    longest = parts.candidate.regions.moments.n == parts.candidate.replicates
    assert 0 < longest.sum() < longest.size
    assert parts.candidate.replicates == whole.candidate.replicates
    assert (parts.verdict.bounds[longest] == whole.verdict.bounds[longest]).all()


@pytest.mark.parametrize(("limit", "all_left"), [({"time": 30.0}, False), ({"time": None, "replicates": 50}, True)])
def test_of_parts_only_a_number_laid_down_before_makes_a_look_the_last(monkeypatch, limit, all_left):
    """Time comes sooner or later by what was seen elsewhere.

    It may not decide how much of the level a look spends.
    """
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    reference = Painter("the reference", grey(1.0, 96, 80), 0.01, clock=clock, cost=(0.1, 0.001))
    candidate = Painter("Cycles", grey(1.0, 96, 80), 0.01, change=noisy_corner(), clock=clock, cost=(0.1, 0.001))
    found = compare(blank(96, 80), reference, candidate, {}, CompareOptions(samples=16, **limit))
    assert candidate.windows[-1] is not None
    spent = sum(look.share for look in found.verdict.looks)
    assert spent == pytest.approx(1.0) if all_left else spent < 0.99
    assert found.stopped is (Stop.TIME if limit["time"] else Stop.REPLICATES)


def test_a_pixel_that_fails_in_a_part_is_excluded_there():
    def change(replicate, image):
        image = noisy_corner()(replicate, image)
        if replicate == 20:
            image[3, 4] = np.nan
        return image

    scene = blank(96, 80)
    reference = Painter("the reference", grey(1.0, 96, 80), 0.01)
    candidate = Painter("Cycles", grey(1.0, 96, 80), 0.01, change=change)
    found = compare(scene, reference, candidate, {}, CompareOptions(time=None, samples=16, replicates=2000))
    assert found.verdict.outcome is Outcome.UNDECIDED
    assert np.argwhere(found.excluded).tolist() == [[3, 4]]
    assert found.candidate.film.nonfinite.sum() == 1
    corner = found.regions.names.index("x 0 to 15, y 0 to 15")
    assert found.verdict.outcomes[corner] is Outcome.EQUIVALENT
    assert found.verdict.excluded[corner] == 1


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    return clock


@pytest.mark.parametrize("seconds", [2.0, 20.0, 300.0])
def test_the_time_is_kept(clock, seconds):
    sides = [Painter(name, grey(), 20.0, clock=clock) for name in ("a", "b")]
    told = []
    found = compare(blank(), *sides, {}, CompareOptions(time=seconds), Progress(told.append))
    assert found.stopped is Stop.TIME
    assert found.seconds <= seconds
    assert found.seconds >= 0.8 * seconds
    assert told == sorted(told)
    assert 0.5 < told[-1] <= 1.0
    # The pilot's images are not the verdict's.
    assert all(replicate < FIRST_CALLS.first for replicate, _ in sides[0].asked[-10:])
    assert sides[0].asked[0][0] == FIRST_CALLS.first
    assert 0 < found.pilot_seconds < 0.2 * seconds


def test_the_noisier_side_gets_more_samples(clock):
    sides = [Painter(name, grey(), sigma, clock=clock) for name, sigma in (("a", 20.0), ("b", 2.0))]
    found = compare(blank(), *sides, {}, CompareOptions(time=100.0))
    assert found.reference.film.samples > found.candidate.film.samples


class Cancel:
    """Says so from the `calls`-th question on."""

    def __init__(self, painter, after):
        self.painter, self.after = painter, after

    def __call__(self):
        return len(self.painter.asked) >= self.after


def test_cancelling_keeps_what_both_sides_finished():
    reference, candidate = Painter("a", grey(), 3.0), Painter("b", grey(), 3.0)
    found = compare(blank(), reference, candidate, {}, FIXED, Progress(is_cancelled=Cancel(candidate, 5)))
    assert found.stopped is Stop.CANCELLED
    assert found.candidate.film.moments.n == 4
    assert found.reference.film.moments.n in (4, 5)
    assert found.verdict.outcome is Outcome.UNDECIDED


@pytest.mark.parametrize("options", [FIXED, CompareOptions(time=60.0)])
def test_cancelled_at_once_there_is_nothing(options):
    with pytest.raises(EtalonError, match="Test: cancelled before both sides had an image"):
        run(options=options, progress=Progress(is_cancelled=lambda: True))


def test_a_renderers_own_error_comes_through():
    def fail(replicate, image):
        raise EtalonError("Cycles: out of memory; close something")

    with pytest.raises(EtalonError, match="out of memory"):
        run(change=fail)


def test_images_of_different_size_are_refused():
    with pytest.raises(EtalonError, match="23 x 20 pixels, the other 24 x 20; render both at the same size"):
        run(other=grey(width=23))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_pixels_that_are_not_finite_are_excluded_and_said(bad):
    def break_one(replicate, image):
        if replicate == 3:
            image[2, 5] = bad
        return image

    found = run(change=break_one)
    assert found.verdict.outcome is Outcome.UNDECIDED
    assert found.excluded.sum() == 1
    assert found.excluded[2, 5]
    assert found.candidate.film.nonfinite[2, 5] == 1
    assert "non-finite samples in 1 pixel of Cycles" in found.verdict.reasons[0]
    assert found.verdict.excluded[0] == 1
    assert np.isfinite(found.verdict.difference).all()
    # What is left is judged all the same.
    assert found.verdict.count(Outcome.EQUIVALENT) == len(found.regions)


def test_an_image_without_one_finite_pixel():
    found = run(change=lambda replicate, image: image * np.nan)
    assert found.verdict.outcome is Outcome.UNDECIDED
    assert np.isnan(found.verdict.difference).all()
    json.dumps(make_plain(found.verdict.difference), allow_nan=False)


def test_negative_pixels_are_numbers():
    found = run(truth=grey(-0.5))
    assert found.verdict.outcome is Outcome.EQUIVALENT
    assert run(truth=grey(0.5), other=grey(-0.5)).verdict.outcome is Outcome.DIFFERENT


def test_one_replicate_decides_nothing_and_says_why():
    found = run(options=CompareOptions(time=None, samples=16, replicates=1))
    assert found.verdict.outcome is Outcome.UNDECIDED
    assert found.verdict.count(Outcome.UNDECIDED) == len(found.regions)
    assert any("fewer than two replicates" in reason for reason in found.verdict.reasons)
    assert found.verdict.forecast is None
    assert np.isnan(found.verdict.low).all()


def test_a_region_of_one_pixel_is_judged():
    dot = np.zeros((20, 24))
    dot[4, 4] = 1.0
    other = grey()
    other[4, 4] = 2.0
    found = run(other=other, coverage={"object": [("Dot", dot)]})
    dot_outcome = found.verdict.outcomes[found.regions.names.index("Dot")]
    assert dot_outcome is Outcome.DIFFERENT
    one = {"scene": blank(1, 1), "truth": grey(1.0, 1, 1), "sigma": 0.01}
    assert (
        run(**one, options=CompareOptions(time=None, samples=1024, replicates=40)).verdict.outcome is Outcome.EQUIVALENT
    )


def test_a_pixel_of_few_samples_is_not_judged():
    """A difference of 9 % that few samples show may be one of rare light; so may agreement."""
    for other in (1.0, 1.09):
        found = run(scene=blank(1, 1), truth=grey(1.0, 1, 1), other=grey(other, 1, 1), sigma=0.01)
        assert found.verdict.outcome is Outcome.UNDECIDED
        assert any("rare light" in reason for reason in found.verdict.reasons) or other > 1.0


def test_a_lamp_of_1e12_beside_dim_cells_changes_nothing_for_them():
    """The floor is the median's.

    The lamp's cell does not make a difference of 5 % elsewhere a small one.
    """
    truth = grey(1.0, 96, 80)
    truth[:16, :16] = 1e12
    options = CompareOptions(time=None, samples=64, replicates=40)
    assert run(scene=blank(96, 80), truth=truth, options=options).verdict.count(Outcome.DIFFERENT) == 0
    other = truth.copy()
    other[32:48, 32:48] *= 1.05
    found = run(scene=blank(96, 80), truth=truth, other=other, options=options)
    named = dict(zip(found.regions.names, found.verdict.outcomes, strict=True))
    assert named["x 32 to 47, y 32 to 47"] is Outcome.DIFFERENT
    assert not found.verdict.dark.any()


def test_a_region_that_nothing_lights_is_dark_and_agrees():
    truth = grey(1.0, 96, 80)
    truth[:16, :16] = 0.0
    options = CompareOptions(time=None, samples=64, replicates=40)
    found = run(scene=blank(96, 80), truth=truth, options=options)
    assert found.verdict.outcome is Outcome.EQUIVALENT
    assert found.verdict.dark[found.regions.names.index("x 0 to 15, y 0 to 15")]
    assert found.verdict.dark.sum() == 1


def test_black_on_both_sides_is_equivalent():
    assert run(truth=grey(0.0)).verdict.outcome is Outcome.EQUIVALENT


def test_light_where_the_reference_is_black_is_different():
    assert run(truth=grey(0.0), other=grey(1e-6)).verdict.outcome is Outcome.DIFFERENT


def test_equal_without_any_noise_is_equivalent_and_a_hair_beyond_is_not():
    long = {"sigma": 0.0, "options": CompareOptions(time=None, samples=4096, replicates=8)}
    assert run(**long).verdict.outcome is Outcome.EQUIVALENT
    assert run(**long, other=grey(1.0099)).verdict.outcome is Outcome.EQUIVALENT
    assert run(**long, other=grey(1.0101)).verdict.outcome is Outcome.DIFFERENT


def test_equal_without_any_noise_takes_samples_all_the_same():
    """No noise is no proof that nothing was missed."""
    found = run(sigma=0.0, options=CompareOptions(time=None, samples=1, replicates=2))
    assert found.verdict.outcome is Outcome.UNDECIDED
    # 10 ln(1 / a) over the samples of the smaller block, at the level of one look.
    assert found.verdict.bound == pytest.approx(10.0 * np.log(1.0 / 0.00475) / (2 * 8 * 20))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"tolerance": 0.0}, "tolerance: 0.0 is out of range"),
        ({"tolerance": 1.0}, "tolerance: 1.0 is out of range"),
        ({"confidence": 1.0}, "confidence: 1.0 is out of range"),
        ({"confidence": 0.4}, "confidence: 0.4 is out of range"),
        ({"time": 0.0}, "time: 0.0 s is out of range"),
        ({"time": float("nan")}, "time: nan s is out of range"),
        ({"samples": 0}, "samples: 0 is out of range"),
        ({"samples": (4, 0)}, r"samples: \(4, 0\): 0 is out of range"),
        ({"replicates": 0}, "replicates: 0 is out of range"),
        ({"time": None}, "nothing ends the comparison"),
    ],
)
def test_options_out_of_range_are_refused(wrong, said):
    with pytest.raises(EtalonError, match=said):
        CompareOptions(**wrong)
