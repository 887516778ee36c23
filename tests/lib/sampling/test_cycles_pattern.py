# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' sampling pattern is a scrambled Sobol' sequence: nets, uniform, with what neighbours have in common."""

import numpy as np
import pytest
from etalon.lib.sampling.cycles_pattern import cycles_pairs, reverse_bits
from etalon.tests.chi2 import sidak
from etalon.tests.lib.sampling.test_sobol import is_net
from scipy import stats

LEVEL = 1e-4


@pytest.mark.parametrize("count", [1, 2, 4, 16, 256])
@pytest.mark.parametrize("dimension", [21, 37])
def test_blocks_of_powers_of_two_are_nets(count, dimension, rng):
    begin = rng.integers(2**32 // count, size=200).astype(np.uint32) * np.uint32(count)
    u, v = cycles_pairs(begin[:, None] + np.arange(count, dtype=np.uint32), dimension)
    assert is_net(u, v)


@pytest.mark.parametrize("dimension", [21, 37])
def test_points_are_uniform(dimension, rng):
    u, v = cycles_pairs(rng.integers(2**32, size=40000).astype(np.uint32), dimension)
    counts = np.histogram2d(u, v, 16, ((0.0, 1.0), (0.0, 1.0)))[0].ravel()
    assert stats.chisquare(counts).pvalue > sidak(LEVEL, 2)


def test_the_scrambling_is_that_of_one_sequence(rng):
    """Owen's scrambling maps the halves of a half to halves of a half, the same for all points."""
    pair, _ = cycles_pairs(
        rng.integers(2**31, size=(500, 1)).astype(np.uint32) * np.uint32(2) + np.arange(2, dtype=np.uint32), 21
    )
    assert len(np.unique(np.floor(4.0 * pair).sum(axis=1))) == 1  # of ideal scrambling, three values


def test_bits_are_reversed():
    assert reverse_bits(np.array([1, 2, 0x80000001, 6], np.uint32)).tolist() == [
        0x80000000,
        0x40000000,
        0x80000001,
        0x60000000,
    ]
