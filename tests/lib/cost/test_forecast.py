# SPDX-License-Identifier: GPL-3.0-or-later
"""Forecasts hold at their rate, and know floors."""

import numpy as np
import pytest
from etalon.lib.cost.forecast import COVERAGE, Range, forecast
from etalon.lib.cost.measure import measure
from etalon.lib.cost.ways import Bias
from etalon.tests.lib.cost.synthetic import RELATIVE, Synthetic, way
from scipy.stats import binom

RUNS = 80
FEWEST = binom.ppf(1e-5, RUNS, COVERAGE)


def run(*ways, **options):
    return measure("synthetic", list(ways), ways[0].key, **{"budget": 30.0, "most_samples": 16, **options})


@pytest.mark.parametrize(
    ("rate", "known"),
    [pytest.param(1.0, 1.0, marks=pytest.mark.slow), (1.0, None), pytest.param(1.3, None, marks=pytest.mark.slow)],
)
def test_coverage(rate, known, seed):
    """Seconds of a run to come lie in the interval in 90 of 100 cases.

    The run goes sixteen times as far as the pilots.
    """
    hits = 0
    for k in range(RUNS):
        renderer = {"seed": seed + k, "rate": rate, "fixed": 5e-3, "jitter": 0.05}
        found = run(way("plain", known=known, **renderer))
        # 270 samples are needed, and the next number with few binary digits is taken.
        target = np.sqrt(RELATIVE / 270.0**rate)
        told = forecast(found["plain"], target, seed=k)
        taken = Synthetic(**{**renderer, "seed": seed + k + 10**6}).render(0, 288).seconds
        hits += told.seconds.low <= taken <= told.seconds.high
    assert hits >= FEWEST, hits


def test_an_interval_says_something(seed):
    """For independent samples it is narrow, and the median is near the truth."""
    found = run(way("plain", known=1.0, seed=seed))
    told = forecast(found["plain"], np.sqrt(RELATIVE / 270.0))
    assert told.seconds.median == pytest.approx(0.288, rel=0.1)
    assert told.seconds.high < 1.5 * told.seconds.low
    assert told.whole.median >= told.seconds.median


def test_floor(seed):
    """A bias of 5 % cannot be rendered away.

    10 % takes more samples than without it, 4 % is never reached.
    """
    found = run(way("truth", seed=seed), way("biased", Bias.FLOOR, 1.0, seed=seed + 1, bias=0.05), most_samples=256)
    told = forecast(found["biased"], 0.1 * np.sqrt(RELATIVE))
    # 1 / N + 0.05^2 = 0.1^2
    assert told.samples.median == pytest.approx(1.0 / (0.01 - 0.0025), rel=0.2)
    assert forecast(found["truth"], 0.1 * np.sqrt(RELATIVE)).samples.median == pytest.approx(100.0, rel=0.2)
    never = forecast(found["biased"], 0.04 * np.sqrt(RELATIVE))
    assert not never.reached
    assert np.isinf(never.seconds.high)
    assert np.isinf(never.whole.median)
    assert forecast(found["truth"], 0.04 * np.sqrt(RELATIVE)).reached


def test_unknown_bias_is_not_extrapolated(seed):
    """A way whose bias only measuring tells.

    Inside the measured range the error is read off, outside it is not reached.
    """
    found = run(way("truth", seed=seed), way("denoised", Bias.UNKNOWN, seed=seed + 1))
    assert forecast(found["denoised"], 0.5).samples.median == pytest.approx(4.0, abs=1.0)
    assert not forecast(found["denoised"], 0.1).reached


def test_low_targets_take_one_sample(seed):
    found = run(way("plain", seed=seed, variance=1e-4))
    told = forecast(found["plain"], 0.1)
    assert (told.samples.low, told.samples.high) == (1.0, 1.0)


def test_noiseless_way(seed):
    """No variance at all, as in a furnace that closes: one sample for any error."""
    found = run(way("plain", seed=seed, variance=0.0))
    assert forecast(found["plain"], 1e-6).samples.median == 1.0


def test_range_keeps_infinities():
    draws = np.append(np.arange(90.0), np.full(10, np.inf))
    assert Range.of(draws).median == pytest.approx(50.0, abs=1.0)
    assert np.isinf(Range.of(draws).high)
