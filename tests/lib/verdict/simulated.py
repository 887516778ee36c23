# SPDX-License-Identifier: GPL-3.0-or-later
"""Region means drawn from known distributions, and the whole sequential decision on them."""

import numpy as np
from etalon.lib.film.moments import Moments, merge
from etalon.lib.verdict.boundaries import count_looks, next_look
from etalon.lib.verdict.rare import describe_tails, room_for_rare_light
from etalon.lib.verdict.sequential import ALL_AGREE, SequentialTest


def gaussian(rng, rows, count):
    """Noise of unit variance, one draw for all channels, as light has."""
    return np.repeat(rng.standard_normal((rows, count, 1)), 3, axis=2)


def fireflies(rng, rows, count):
    """Mean zero: a normal body, with a flash in one replicate out of ten.

    The flash has a Pareto tail of index 2.2, which barely has a variance.
    """
    flash = (rng.random((rows, count, 1)) < 0.1) * (1 + rng.pareto(2.2, (rows, count, 1)))
    flash -= 0.1 * (1 + 1 / (2.2 - 1))
    return np.repeat(0.5 * rng.standard_normal((rows, count, 1)) + flash, 3, axis=2)


def rows_of(values):
    """Moments of all rows together."""
    mean = values.mean(axis=0)
    return Moments(len(values), mean, ((values - mean) ** 2).sum(axis=0))


def decided(rng, candidate, noise, sigma=0.02, tolerance=0.01, confidence=0.99, last=139, look=None):
    """The test at its end, on normal noise.

    References have mean 1, candidates means `candidate` (K,), and a replicate the noise `sigma`. `look(test, n,
    reference, candidate)` is called after each look.
    """
    count = candidate.size
    test = SequentialTest(count, tolerance, confidence, expected=count_looks(last))
    sides = [Moments.empty((count, 3)), Moments.empty((count, 3))]
    n = 0
    while n < last and test.undecided.any():
        more = min(next_look(n), last) - n
        n += more
        for k, mean in enumerate((np.ones(count), candidate)):
            sides[k] = merge(sides[k], rows_of(mean[:, None] * (1.0 + sigma * noise(rng, more, count))))
        test.look(*sides, last=n == last)
        if look is not None:
            look(test, n, *sides)
    return test


def decided_on_series(draw, count, samples, tolerance, last, confidence=0.99, room=True):
    """The test at its end on what `draw(rows)` gives.

    That is two arrays (rows, K) of replicate means, each over `samples` samples. With `room`, the claims leave it for
    rare light.
    """
    test = SequentialTest(count, tolerance, confidence, expected=count_looks(last))
    series = [np.empty((0, count)), np.empty((0, count))]
    n = 0
    while n < last and test.undecided.any():
        more = min(next_look(n), last) - n
        n += more
        series = [np.vstack([before, new]) for before, new in zip(series, draw(more), strict=True)]
        left = 0.0
        if room:
            most = max(describe_tails(one, np.full(count, samples), np.ones(len(one))).worth.max() for one in series)
            left = room_for_rare_light(most, np.full(count, n * samples), ALL_AGREE * test.level)
        test.look(*(rows_of(np.repeat(one[..., None], 3, axis=2)) for one in series), last=n == last, rare=left)
    return test


def decided_on_samples(rng, share, worth, smooth, room=True, count=280, samples=8192, sigma=0.5):
    """The test at its end at a tolerance of 1 %, on samples.

    Regions have mean 1, and replicates `samples` samples of noise `sigma` each. The reference has a `share` of its
    light in samples of `worth` times the mean; the candidate has `smooth` instead, in all samples.
    """

    def draw(rows):
        body = 1.0 - share + sigma / np.sqrt(samples) * rng.standard_normal((2, rows, count))
        rare = rng.poisson(samples * share / worth, (rows, count)) * worth / samples if share else 0.0
        return body[0] + rare, body[1] + smooth

    return decided_on_series(draw, count, samples, 0.01, 58, room=room)


# Samples of mean 1 with heavy tails; the variance of the first is 54, the last two have none. The exponential of an exponential variable
# is Pareto's. In single precision a sample takes a fifth of the time.
HEAVY = {
    "lognormal, sigma 2": lambda rng, shape: np.exp(2.0 * rng.standard_normal(shape, np.float32) - 2.0),
    "Pareto 2.5": lambda rng, shape: 0.6 * np.exp(rng.standard_exponential(shape, np.float32) / 2.5),
    "Pareto 2": lambda rng, shape: 0.5 * np.exp(rng.standard_exponential(shape, np.float32) / 2.0),
    "Pareto 1.5": lambda rng, shape: np.exp(rng.standard_exponential(shape, np.float32) / 1.5) / 3.0,
}


# Tails so much lighter that the means of 2,048 samples are nearly normal, as the verdict assumes. The first has no fourth moment.
MILD = {
    "Pareto 3": lambda rng, shape: np.exp(rng.standard_exponential(shape, np.float32) / 3.0) / 1.5,
    "lognormal, sigma 1": lambda rng, shape: np.exp(rng.standard_normal(shape, np.float32) - 0.5),
}


def decided_on_heavy_tails(rng, kind, gap, noisy, count=100, samples=256):
    """The test at its end at a tolerance of 10 %, on heavy tails.

    Samples are of a HEAVY `kind`, and the candidate's means are greater by the part `gap`. Unless both sides are
    `noisy`, the candidate has hardly any noise.
    """

    def draw(rows):
        shape = rows, count, samples
        reference = HEAVY[kind](rng, shape).mean(axis=2, dtype=float)
        smooth = 1.0 + 0.01 * rng.standard_normal((rows, count))
        return reference, (1.0 + gap) * (HEAVY[kind](rng, shape).mean(axis=2, dtype=float) if noisy else smooth)

    return decided_on_series(draw, count, samples, 0.1, 58)


def decided_on_mild_tails(rng, kind, gap, count=10, samples=2048):
    """The test at its end at a tolerance of 1 % and a confidence of 90 %, on samples of a MILD `kind`.

    The candidate's means are greater by the part `gap`. The room for rare light is a tenth of the noise, so that it prevents
    no false claim that wrong standard errors would make.
    """

    def draw(rows):
        reference, candidate = (MILD[kind](rng, (rows, count, samples)).mean(axis=2, dtype=float) for _ in range(2))
        return reference, (1.0 + gap) * candidate

    return decided_on_series(draw, count, samples, 0.01, 58, confidence=0.9)
