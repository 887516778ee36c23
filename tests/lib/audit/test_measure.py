# SPDX-License-Identifier: GPL-3.0-or-later
"""An audit of renderers whose images, noise and seconds are known.

Tested are what is biased, what is not, and what each costs.
"""

import math

import numpy as np
import pytest
from etalon.lib.audit.document import document, table
from etalon.lib.audit.measure import audit
from etalon.lib.audit.setting import Setting
from etalon.lib.comparison import run as run_module
from etalon.lib.comparison.compare import CompareOptions
from etalon.lib.comparison.run import Stop
from etalon.lib.errors import EtalonError
from etalon.lib.film.rendering import Rendering
from etalon.lib.progress import Progress
from etalon.lib.sampling.streams import FIRST_CALLS
from etalon.lib.verdict.outcome import Outcome

SHAPE = (40, 48)
LEFT = np.arange(SHAPE[1]) < 16


class Clock:
    """Stands in for the module `time`."""

    now = 0.0

    def monotonic(self):
        return self.now


@pytest.fixture
def clock(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(run_module.time, "monotonic", clock.monotonic)
    return clock


class Painter:
    """Paints 1 with noise from the replicate's own random numbers, the same for all painters.

    `change` is what a setting does to it.
    """

    name = "Painter"

    def __init__(self, clock, seed, change=lambda image: image, cost=(0.1, 0.01), sigma=0.3):
        self.settings = {"seed": seed}
        self.clock, self.seed, self.change, self.cost, self.sigma = clock, seed, change, cost, sigma
        self.asked = []

    def render(self, replicate, samples, progress, windows=None):
        self.asked.append((replicate, samples))
        rng = np.random.default_rng([self.seed, replicate])
        image = 1.0 + self.sigma / math.sqrt(samples) * rng.standard_normal((*SHAPE, 3))
        seconds = self.cost[0] + self.cost[1] * samples
        self.clock.now += seconds
        progress.report(1.0)
        image = self.change(image)
        return Rendering(image, (~np.isfinite(image).all(axis=2)).astype(int), seconds)


def setting(key, **facts):
    return Setting(key, key.title(), "on", "off", "Does something.", **facts)


def run(clock, seed, changes, options=None, cancelled=lambda: False, asked=4096, **costs):
    options = options or CompareOptions(time=60.0)
    neutral = Painter(clock, seed)
    candidates = [(setting(key), Painter(clock, seed, c, costs.get(key, (0.1, 0.01)))) for key, c in changes.items()]
    return audit("Test", neutral, candidates, options, asked, progress=Progress(is_cancelled=cancelled))


def left(factor):
    return lambda image: image * np.where(LEFT, factor, 1.0)[:, None]


def test_what_is_biased_is_found_where_it_is(clock, seed):
    found = run(
        clock, seed, {"same": lambda image: image, "little": left(0.995), "much": left(0.95), "more": lambda i: 1.2 * i}
    )
    got = {f.setting.key: f for f in found.findings}
    assert found.rounds >= 8
    assert {key: f.outcome for key, f in got.items()} == {
        "same": Outcome.EQUIVALENT,
        "little": Outcome.EQUIVALENT,
        "much": Outcome.DIFFERENT,
        "more": Outcome.DIFFERENT,
    }
    for key, image, block in (
        ("same", 0.0, 0.0),
        ("little", -0.005 / 3, -0.005),
        ("much", -0.05 / 3, -0.05),
        ("more", 0.2, 0.2),
    ):
        f = got[key]
        place, channel = f.worst
        assert f.low[0].max() - 1e-6 <= image <= f.high[0].min() + 1e-6
        assert f.low[place, channel] - 1e-6 <= block <= f.high[place, channel] + 1e-6
    place, _ = got["much"].worst
    assert found.boxes[place][2] < 16
    assert np.abs(got["much"].map[:, ~LEFT]).max() == 0.0
    assert np.median(got["much"].map[:, LEFT]) == pytest.approx(-0.05, rel=0.05)
    # Of the settings only the one that changes the noise of every pixel shows it.
    assert got["more"].noise.value == pytest.approx(1.44)
    assert got["same"].noise.value == 1.0


def test_independent_noise_is_no_bias(clock, seed):
    """A setting that draws other random numbers.

    Its difference is noise alone, of twice the variance, and no bias is claimed.
    """
    rng = np.random.default_rng(seed)

    def other(image):
        return 1.0 + 2.0 * (image - 1.0).std() * rng.standard_normal(image.shape)

    found = run(clock, seed, {"other": other}, CompareOptions(time=200.0))
    assert found.findings[0].outcome is not Outcome.DIFFERENT
    assert found.findings[0].noise.low < 4.0 < found.findings[0].noise.high
    # Only what is three standard errors from 0 is drawn.
    assert np.mean(found.findings[0].map != 0.0) < 0.03


def test_a_bias_that_no_pixel_is_sure_of_is_drawn_in_squares(clock, seed):
    rng = np.random.default_rng(seed)

    def other(image):
        return left(0.9)(1.0 + 0.3 * rng.standard_normal(image.shape))

    found = run(clock, seed, {"other": other}, CompareOptions(time=60.0, samples=1, replicates=24))
    drawn = found.findings[0].map
    assert np.mean(drawn[:, LEFT] < 0.0) > 0.9
    assert np.median(drawn[:, LEFT]) == pytest.approx(-0.1, abs=0.04)
    assert np.mean(drawn[:, ~LEFT] == 0.0) > 0.95


@pytest.mark.slow
def test_false_alarms_are_no_more_often_than_the_level(clock, seed):
    alarms = 0
    for trial in range(60):
        rng = np.random.default_rng([seed, trial])

        def other(image, rng=rng):
            return 1.0 + 0.1 * rng.standard_normal(image.shape)

        found = run(
            clock, seed + trial, {"a": other, "b": other}, CompareOptions(time=8.0, tolerance=1e-6, confidence=0.5)
        )
        alarms += any(f.outcome is Outcome.DIFFERENT for f in found.findings)
    # At level 0.5 a family-wise rate above it would exceed 46 of 60 with probability 1e-5.
    assert alarms <= 46


def test_seconds_are_what_the_clock_said(clock, seed):
    found = run(clock, seed, {"slow": lambda i: i}, CompareOptions(time=60.0, samples=4), slow=(0.3, 0.01))
    assert found.findings[0].time.value == pytest.approx(0.34 / 0.14)
    assert found.seconds_neutral == pytest.approx(0.14)
    assert found.samples == 4
    assert found.seconds <= 60.0
    assert found.stopped is Stop.TIME


def test_no_side_has_a_place_of_its_own_in_a_round(clock, seed):
    """The first call of every round takes three times as long.

    Nobody is charged for it more than the others.
    """

    seen = set()

    class Uneven(Painter):
        def render(self, replicate, samples, progress, windows=None):
            self.cost = (0.1 if replicate in seen else 0.3, 0.01)
            seen.add(replicate)
            return super().render(replicate, samples, progress)

    candidates = [(setting(key), Uneven(clock, seed)) for key in "abc"]
    found = audit("Test", Uneven(clock, seed), candidates, CompareOptions(time=40.0, samples=1), 64)
    assert all(f.time.low < 1.0 < f.time.high for f in found.findings)


def test_every_round_is_its_own_and_shared(clock, seed):
    neutral, other = Painter(clock, seed), Painter(clock, seed)
    found = audit("Test", neutral, [(setting("other"), other)], CompareOptions(time=30.0), 64)
    rounds = [replicate for replicate, _ in neutral.asked if replicate < FIRST_CALLS.first]
    assert (
        rounds
        == list(range(found.rounds))
        == [replicate for replicate, _ in other.asked if replicate < FIRST_CALLS.first]
    )
    assert found.samples <= 64
    assert found.samples & (found.samples - 1) == 0


def test_what_so_few_samples_cannot_show_is_not_measured(clock, seed):
    candidates = [(setting("late", needs=81), Painter(clock, seed)), (setting("now"), Painter(clock, seed))]
    found = audit("Test", Painter(clock, seed), candidates, CompareOptions(time=30.0, samples=16), 4096)
    assert [f.setting.key for f in found.findings] == ["now"]
    assert found.missing[0].missing.startswith("it takes 81 samples per pixel, and these were 16; give --samples 128")


def test_cancelled_keeps_complete_rounds(clock, seed):
    calls = 0

    def cancelled():
        nonlocal calls
        calls += 1
        return calls > 20

    found = run(clock, seed, {"much": left(0.5)}, cancelled=cancelled)
    assert found.stopped is Stop.CANCELLED
    assert found.rounds >= 2
    with pytest.raises(EtalonError, match="cancelled before the first round"):
        run(clock, seed, {"much": left(0.5)}, cancelled=lambda: True)


def test_two_numbers_of_samples_are_refused(clock, seed):
    with pytest.raises(EtalonError, match="give one number"):
        run(clock, seed, {"much": left(0.5)}, CompareOptions(samples=(8, 16)))


def test_nothing_to_measure_renders_nothing(clock, seed):
    neutral = Painter(clock, seed)
    found = audit("Test", neutral, [], CompareOptions(), 64, (setting("same"),))
    assert neutral.asked == []
    assert found.stopped is Stop.NOTHING
    assert table(document(found, "")) == "as neutral: Same"


def test_pixels_that_are_not_finite_count_on_neither_side(clock, seed):
    def broken(image):
        image = 1.1 * image
        image[3, 5] = np.nan
        return image

    found = run(clock, seed, {"broken": broken})
    f = found.findings[0]
    assert found.nonfinite == 1
    assert np.isnan(f.map).sum() == 1
    assert f.difference[0] == pytest.approx(0.1)
    assert f.outcome is Outcome.DIFFERENT


def test_one_round_decides_nothing(clock, seed):
    found = run(clock, seed, {"much": left(0.5)}, CompareOptions(time=1e-6))
    assert found.rounds == 1
    assert found.findings[0].outcome is Outcome.UNDECIDED
