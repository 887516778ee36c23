# SPDX-License-Identifier: GPL-3.0-or-later
"""Region means and effects of departures drawn from known distributions.

The whole search for causes runs on them.
"""

import numpy as np
from etalon.lib.departures.catalogue import Departure
from etalon.lib.film.moments import Moments
from etalon.lib.verdict.attribution import ATTRIBUTION_SHARE, Attribution
from etalon.lib.verdict.boundaries import next_look
from etalon.lib.verdict.explain import explain
from etalon.lib.verdict.sequential import SequentialTest

TOLERANCE, NOISE, LAST = 0.05, 0.0075, 27
NAMES = ("a", "b", "c")
DEPARTURES = tuple(Departure(name, "", "") for name in NAMES)


class Sums:
    """What attribution asks of a side's regions."""

    def __init__(self, rows):
        mean = rows.mean(axis=0)
        self.moments = Moments(len(rows), mean, ((rows - mean) ** 2).sum(axis=0))


def simulated(
    rng,
    true_effects,
    candidate,
    confidence=0.99,
    tails=None,
    noise_of_one=NOISE,
    noise_of_effects=0.1,
    inside=None,
    departures=DEPARTURES,
    differing=frozenset(),
    most_pairs=None,
):
    """The search at its end, its sides, and what it says, on regions of mean 1.

    `true_effects` (name -> (N,)) add up, `candidate` (N,) is the truth of that side. `noise_of_effects` is that of a pair,
    relative to a replicate's. The light passes that are `differing` differ at every look. `most_pairs` (name -> number) of a departure alone
    are rendered, as where time is short.
    """
    count, most = candidate.size, {frozenset([name]): pairs for name, pairs in (most_pairs or {}).items()}
    test = SequentialTest(count, TOLERANCE, confidence, ATTRIBUTION_SHARE)
    search = Attribution(departures, test, ATTRIBUTION_SHARE * (1 - confidence), inside)

    def noise(rows):
        z = rng.standard_normal((rows, count, 1)) if tails is None else rng.standard_t(tails, (rows, count, 1))
        return noise_of_one * np.repeat(z, 3, axis=2)

    reference, measured = 1.0 + noise(LAST), candidate[:, None] + noise(LAST)
    pairs = {}

    def effects(names, pairs_wanted):
        if names not in pairs:
            mean = sum(true_effects[name] for name in names)
            pairs[names] = mean[:, None] + noise_of_effects * noise(LAST)
        return pairs[names][: min(pairs_wanted, most.get(names, LAST))]

    n = next_look(0)
    while True:
        last = n >= LAST
        sides = Sums(reference[:n]), Sums(measured[:n])
        test.look(sides[0].moments, sides[1].moments, last)
        search.look(*sides, effects, last, differing)
        if last or search.complete:
            return search, search.sides(*sides), explain(search, *sides, samples=1, seconds=0.0)
        n = min(next_look(n), LAST)
