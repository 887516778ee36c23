# SPDX-License-Identifier: GPL-3.0-or-later
"""Region means drawn from known distributions, and the whole sequential decision on them."""

import numpy as np
from etalon.lib.film.moments import Moments, merge
from etalon.lib.verdict.sequential import SequentialTest, next_look


def gaussian(rng, rows, count):
    """Noise of unit variance, one draw for all channels, as light has."""
    return np.repeat(rng.standard_normal((rows, count, 1)), 3, axis=2)


def fireflies(rng, rows, count):
    """Mean zero: a normal body, and in one replicate out of ten a flash from a Pareto tail of index 2.2, which barely has a variance."""
    flash = (rng.random((rows, count, 1)) < 0.1) * (1 + rng.pareto(2.2, (rows, count, 1)))
    flash -= 0.1 * (1 + 1 / (2.2 - 1))
    return np.repeat(0.5 * rng.standard_normal((rows, count, 1)) + flash, 3, axis=2)


def rows_of(values):
    """Moments of all rows together."""
    mean = values.mean(axis=0)
    return Moments(len(values), mean, ((values - mean) ** 2).sum(axis=0))


def decided(rng, candidate, noise, sigma=0.02, tolerance=0.01, confidence=0.99, last=139, look=None):
    """The test at its end: references of mean 1, candidates of means `candidate` (K,), noise `sigma` of a replicate.

    `look(test, n, reference, candidate)` is called after each look.
    """
    count = candidate.size
    test = SequentialTest(count, tolerance, confidence)
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
