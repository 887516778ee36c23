# SPDX-License-Identifier: GPL-3.0-or-later
"""False claims on light passes, counted over simulated comparisons."""

import numpy as np
import pytest
from etalon.lib.film.light_passes import LightPass
from etalon.lib.film.regions import RegionMoments, image_regions
from etalon.lib.verdict import passes as module
from etalon.lib.verdict import sequential
from etalon.lib.verdict.boundaries import next_look
from etalon.lib.verdict.outcome import Outcome
from etalon.lib.verdict.passes import PassTest
from scipy.stats import binom

NAMES = (LightPass.DIFFUSE_DIRECT, LightPass.GLOSSY_DIRECT, LightPass.GLOSSY_INDIRECT)
TOLERANCE, CONFIDENCE, REPLICATES, RUNS = 0.01, 0.5, 12, 50
LEFT = np.pad(np.ones((2, 1)), ((0, 0), (0, 1)))
REGIONS = image_regions(2, 2, {"material": [("Left", LEFT)]}, (16,)).named


def false_claims(rng, off, wrong):
    """In how many of RUNS comparisons a claim is made that is `wrong` of any pass.

    The truth of each is off by `off` everywhere.
    """
    count = 0
    for _ in range(RUNS):
        test = PassTest(NAMES, REGIONS.families, TOLERANCE, CONFIDENCE, 3)
        sides = [{name: RegionMoments(REGIONS) for name in NAMES} for _ in range(2)]
        claimed = False
        for replicate in range(1, REPLICATES + 1):
            for side, truth in zip(sides, (1.0, 1.0 + off), strict=True):
                for moments in side.values():
                    moments.add(truth * (1.0 + 0.005 * rng.standard_normal((2, 2, 3))))
            if replicate == next_look(replicate - 1):
                test.look(*sides, (10**6, 10**6), np.full(3, 1e-3), replicate == REPLICATES)
                claimed |= bool((test.conclude(*sides).outcomes == wrong).any())
        count += claimed
    return count


@pytest.mark.slow
def test_false_claims_stay_within_the_level_of_passes(rng):
    """At the edge of the tolerance each claim is false.

    Together they may be made in a twentieth of 1 - confidence of the runs.
    """
    most = binom.ppf(0.9999, RUNS, module.PASSES_SHARE * (1.0 - CONFIDENCE))
    assert false_claims(rng, 1.0001 * TOLERANCE, Outcome.EQUIVALENT) <= most
    assert false_claims(rng, 0.9999 * TOLERANCE, Outcome.DIFFERENT) <= most


@pytest.mark.slow
def test_claims_at_fifty_times_the_level_would_be_seen(rng, monkeypatch):
    """The error planted: claims that passes differ spend all of 1 - confidence."""
    most = binom.ppf(0.9999, RUNS, module.PASSES_SHARE * (1.0 - CONFIDENCE))
    monkeypatch.setattr(module, "PASSES_SHARE", 1.0)
    monkeypatch.setattr(sequential, "ONE_DIFFERS", 1.0)
    assert false_claims(rng, 0.9999 * TOLERANCE, Outcome.DIFFERENT) > most


def test_nothing_is_claimed_from_so_few_replicates_that_they_may_be_equal_by_chance():
    """All replicates of the reference met a lamp at an edge, and none of Cycles' did.

    It is noise of 100 % that four replicates do not show.
    """
    test = PassTest(NAMES[:1], REGIONS.families, TOLERANCE, 0.99, 3)
    sides = [{name: RegionMoments(REGIONS) for name in NAMES[:1]} for _ in range(2)]
    claimed = []
    for replicate in range(1, 9):
        for side, light in zip(sides, (1.0, 0.0), strict=True):
            side[NAMES[0]].add(np.full((2, 2, 3), light))
        if replicate > 1:
            test.look(*sides, (10**6, 10**6), np.full(3, 1e-3), replicate == 8)
            claimed.append((test.conclude(*sides).outcomes != Outcome.UNDECIDED).any())
    assert claimed == [False] * 3 + [True] * 4


def test_nothing_is_claimed_of_a_black_pass_from_few_replicates():
    test = PassTest(NAMES[:1], REGIONS.families, TOLERANCE, 0.99, 3)
    sides = [{name: RegionMoments(REGIONS) for name in NAMES[:1]} for _ in range(2)]
    for side in (*sides, *sides):
        side[NAMES[0]].add(np.zeros((2, 2, 3)))
    test.look(*sides, (10**6, 10**6), np.full(3, 1e-3), False)
    assert (test.conclude(*sides).outcomes == Outcome.UNDECIDED).all()


@pytest.mark.slow
def test_a_clear_difference_is_claimed(rng):
    assert false_claims(rng, 5.0 * TOLERANCE, Outcome.DIFFERENT) == RUNS
