# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors, floors and ratios of renderers whose true ones are known.

Their intervals cover at their rate.
"""

import numpy as np
import pytest
from etalon.lib.comparison.run import Stop
from etalon.lib.cost.efficiency import ratio
from etalon.lib.cost.estimates import of_geometric_mean, of_mean, of_positive_mean
from etalon.lib.cost.measure import measure
from etalon.lib.cost.ways import Bias
from etalon.lib.cost.yardstick import Yardstick
from etalon.lib.errors import Cancelled, EtalonError
from etalon.lib.progress import Progress
from etalon.tests.lib.cost.synthetic import HEIGHT, RELATIVE, TRUTH, WIDTH, Synthetic, way
from scipy.stats import binom

RUNS = 100


def fewest(rate, runs=RUNS, level=1e-5):
    """Fewer hits than this refute a coverage of `rate`."""
    return binom.ppf(level, runs, rate)


def run(ways, **options):
    return measure("synthetic", ways, "truth", **{"budget": 30.0, "most_samples": 4, **options})


def truth(seed):
    return way("truth", seed=seed, variance=0.5)


@pytest.mark.parametrize("estimate", [of_mean, of_positive_mean, of_geometric_mean])
def test_intervals_cover(estimate, rng):
    """95 % of intervals from four values hold the true mean.

    Gamma values stand for the mean of many squares.
    """
    values = rng.gamma(200.0, 1.0 / 200.0, (2000, 4))
    centre = np.exp(np.log(rng.gamma(200.0, 1.0 / 200.0, 10**6)).mean()) if estimate is of_geometric_mean else 1.0
    hits = sum(e.low <= centre <= e.high for e in map(estimate, values))
    assert binom.ppf(1e-5, 2000, 0.95) <= hits <= binom.ppf(1.0 - 1e-5, 2000, 0.95)


def test_variance_bias_and_ratio_cover(seed):
    """Of a biased way: its variance, its bias^2, and its efficiency against the unbiased one."""
    hits = dict.fromkeys(("variance", "bias", "ratio"), 0)
    for k in range(RUNS):
        ways = [truth(seed + 2 * k), way("biased", Bias.FLOOR, seed=seed + 2 * k + 1, bias=0.2, seconds=3e-3)]
        found = run(ways)
        point = found["biased"].points[-1]
        assert point.samples == 4
        # 1 / 4 + 0.04 in 12e-3 s, against 0.5 / 4 in 4e-3 s; the ratio of noisy seconds is off by their jitter's square only.
        for name, exact, estimate in (
            ("variance", 0.25 * RELATIVE, of_positive_mean(point.column("variance"))),
            ("bias", 0.04 * RELATIVE, of_mean(point.column("bias"))),
            ("ratio", (0.125 * 4e-3) / (0.29 * 12e-3), ratio(found["biased"], found["truth"])),
        ):
            hits[name] += estimate.low <= exact <= estimate.high
    assert min(hits.values()) >= fewest(0.95), hits


def test_the_truth_s_own_noise_is_no_bias(rng):
    """The truth is as noisy as the images.

    An unbiased way's bias^2 is zero in the mean, where (mean - truth)^2 is not.
    """
    bias, naive = [], []
    for _ in range(200):
        noisy = TRUTH * (1.0 + 0.5 * rng.standard_normal((10, HEIGHT, WIDTH, 3)))
        yardstick = Yardstick(list(noisy[:8]))
        bias.append(yardstick.score(noisy[8], noisy[9], 1).bias)
        naive.append((((noisy[8:].mean(axis=0) - yardstick.mean) / TRUTH) ** 2).mean())
    bias, naive = np.array(bias), np.array(naive)
    assert abs(bias.mean()) < 5.0 * bias.std() / np.sqrt(len(bias))
    assert naive.mean() > 20.0 * abs(bias.mean())


def test_trimmed_and_median(rng):
    """Both are those of a Gaussian's square.

    A single pixel that is off by a factor of thousand moves the mean alone.
    """
    truths = [TRUTH * (1.0 + 1e-3 * rng.standard_normal(TRUTH.shape)) for _ in range(2)]
    yardstick = Yardstick(truths)
    grey = TRUTH * (1.0 + 0.1 * rng.standard_normal((4000, *TRUTH.shape[:2], 1))[:2].reshape(2, HEIGHT, WIDTH, 1))
    plain = yardstick.score(grey[0], grey[1], 0)
    grey[0, 3, 3] *= 1000.0
    struck = yardstick.score(grey[0], grey[1], 0)
    assert struck.variance > 100.0 * plain.variance
    assert struck.median == pytest.approx(plain.median, rel=0.1)
    assert struck.trimmed == pytest.approx(plain.trimmed, rel=0.1)
    # The median of a square of a standard normal is 0.455.
    assert plain.median == pytest.approx(0.455 * 0.01, rel=0.5)


def test_pixels_that_are_not_finite_do_not_count(rng):
    images = [TRUTH * (1.0 + 0.1 * rng.standard_normal(TRUTH.shape)) for _ in range(4)]
    clean = Yardstick(images[:2]).score(images[2], images[3], 0)
    images[2][0, 0] = np.nan
    images[0][1, 1] = np.inf
    yardstick = Yardstick(images[:2])
    assert yardstick.excluded.sum() == 1
    score = yardstick.score(images[2], images[3], 0)
    assert score.variance == pytest.approx(clean.variance, rel=0.1)
    assert np.isfinite([score.bias, score.trimmed, score.median]).all()


def test_levels_grow_until_the_share_is_spent(seed):
    """Ways that are slow end at fewer samples; a way that never began says so."""

    class Slow(Synthetic):
        def render(self, replicate, samples, progress=None, windows=None):
            import time

            begin = time.monotonic()
            while time.monotonic() - begin < 1e-3 * samples:
                pass
            return super().render(replicate, samples)

    slow = way("slow", seed=seed + 1)
    slow = type(slow)("slow", "slow", "sampling", lambda: Slow(seed + 1), Bias.NONE)
    found = run([truth(seed), slow], budget=1.0, most_samples=256)
    assert len(found["slow"].points) < len(found["truth"].points)
    assert found["slow"].points[0].samples == 1
    assert found.seconds < 2.0
    nothing = run([truth(seed), slow], budget=1e-4, most_samples=4)
    assert "no time left" in nothing["slow"].missing
    assert not nothing["slow"].points
    assert [p.samples for p in nothing["truth"].points] == [1]


def test_cancelling_keeps_finished_levels(seed):
    calls = 0

    def after(count):
        def cancelled():
            nonlocal calls
            calls += 1
            return calls > count

        return cancelled

    ways = [truth(seed), way("other", seed=seed + 1)]
    found = run(ways, progress=Progress(is_cancelled=after(40)))
    assert found.stopped is Stop.CANCELLED
    assert [p.samples for p in found["other"].points] == [1]
    calls = 0
    with pytest.raises(Cancelled, match="nothing was written"):
        run(ways, progress=Progress(is_cancelled=after(5)))


def test_one_pair_is_no_interval(seed):
    with pytest.raises(EtalonError, match="at least 2"):
        run([truth(seed)], pairs=1)
