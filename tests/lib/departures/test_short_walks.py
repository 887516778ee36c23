# SPDX-License-Identifier: GPL-3.0-or-later
"""Proof that walks of any length belong to the model, by Chandrasekhar.

It gives what leaves a half space after each number of scatterings. R(w) = 1 - sqrt(1 - w) H(w) is the generating
function of the chances to leave after n scatterings, p_n: R = sum p_n w^n. Its values on a circle give each of them,
without any walk.
"""

import numpy as np
import pytest
from etalon.lib.departures.catalogue import SWITCHES
from etalon.lib.scattering.subsurface import albedo_van_de_hulst
from etalon.lib.scattering.walk import walk
from etalon.lib.wavefront.subsurface import MOST_PATHS, SHORT_WALKS
from etalon.tests.lib.scattering.test_walk import keys, leaving, medium, nowhere, slab, walks
from numpy.polynomial.legendre import leggauss

POINTS = 2048
NODE, WEIGHT = leggauss(32)
MU, WEIGHT = 0.5 * (NODE + 1.0), 0.5 * WEIGHT


def left_after(albedo, cosine=1.0):
    """albedo^n p_n for n = 0 to POINTS - 1.

    It is what leaves after n scatterings of light that enters with a cosine.
    """
    turn = albedo * np.exp(2j * np.pi * np.arange(POINTS // 2 + 1) / POINTS)
    root, h = np.sqrt(1.0 - turn), np.ones((turn.size, MU.size), complex)
    kernel = WEIGHT * MU / (MU[:, None] + MU)
    for _ in range(400):
        new = 1.0 / (root[:, None] + 0.5 * turn[:, None] * (h @ kernel.T))
        h = 0.5 * (h + new)
    assert np.abs(new - h).max() < 1e-8
    at_cosine = 1.0 / (root + 0.5 * turn * (h * WEIGHT * MU / (cosine + MU)).sum(axis=1))
    return np.fft.irfft(np.conj(1.0 - root * at_cosine), POINTS)


@pytest.mark.parametrize(("color", "least"), [(0.8, 0.0015), (0.95, 0.045)])
def test_light_that_scatters_often_is_a_part_of_the_colour(color, least):
    """What the mapping makes of a colour reflects it only with all numbers of scatterings."""
    series = left_after(float(albedo_van_de_hulst(np.float64(color), np.float64(0.0))))
    assert series[MOST_PATHS:].sum() > least * series.sum()


@pytest.mark.slow
def test_short_walks_are_the_first_terms_of_the_series(rng):
    """256 free paths are up to 255 scatterings; walks without a bound are the whole series."""
    assert SHORT_WALKS in SWITCHES
    albedo, count = 0.995, 5_000
    series = left_after(albedo)
    assert series[1] == pytest.approx(0.5 * albedo * (1.0 - np.log(2.0)), rel=1e-3)
    for most, expected in ((MOST_PATHS, series[:MOST_PATHS].sum()), (None, series.sum())):
        exits, _ = walk(slab(np.inf), nowhere, walks(1.0, medium((albedo,) * 3, count), count), keys(rng, count), most)
        mean, error = leaving(exits, 0, count)
        assert mean[0] == pytest.approx(expected, abs=4.5 * error[0])
