# SPDX-License-Identifier: GPL-3.0-or-later
"""Radial profiles: they integrate to 1, and distances follow them."""

import numpy as np
import pytest
from etalon.lib.scattering.profiles import DISK_REACH, burley_density, cubic_profile, sample_burley, sample_cubic
from scipy import integrate, stats


@pytest.mark.parametrize("radius", [0.02, 1.0, 30.0])
def test_the_cubic_profile_integrates_to_one_over_a_plane(radius):
    total, _ = integrate.quad(lambda r: 2.0 * np.pi * r * cubic_profile(radius, r), 0.0, radius, epsabs=0.0)
    assert total == pytest.approx(1.0, rel=1e-12)
    assert cubic_profile(radius, 1.0001 * radius) == 0.0


def test_distances_follow_the_cubic_profile(rng):
    found = sample_cubic(np.full(20000, 0.3), rng.random(20000)) / 0.3
    expected = stats.kstest(found, lambda x: 10.0 * x**2 - 20.0 * x**3 + 15.0 * x**4 - 4.0 * x**5)
    assert expected.pvalue > 1e-4


@pytest.mark.parametrize("spread", [0.003, 1.0])
def test_the_density_of_burleys_profile_integrates_to_one(spread):
    end = DISK_REACH * spread
    total, _ = integrate.quad(lambda r: burley_density(np.float64(spread), r), 0.0, end, epsabs=0.0)
    assert total == pytest.approx(1.0, rel=1e-10)
    assert burley_density(np.float64(spread), end) == 0.0
    assert burley_density(np.float64(0.0), end) == 0.0


def test_distances_follow_burleys_profile(rng):
    found = sample_burley(np.full(20000, 0.3), rng.random(20000)) / 0.3
    whole = 1.0 - 0.25 * np.exp(-16.0) - 0.75 * np.exp(-16.0 / 3.0)
    expected = stats.kstest(found, lambda x: (1.0 - 0.25 * np.exp(-x) - 0.75 * np.exp(-x / 3.0)) / whole)
    assert expected.pvalue > 1e-4
    assert found.max() < DISK_REACH
