# SPDX-License-Identifier: GPL-3.0-or-later
"""The chi-square tester itself: level, power, charts."""

import numpy as np
import pytest
from etalon.tests.chi2 import Reflections, Sphere, Tangents, chi_square, integrals, sidak
from scipy.stats import kstest


def cosine(directions):
    return np.maximum(directions[2], 0.0) / np.pi


def sample_cosine(u1, u2):
    radius, phi = np.sqrt(u2), 2.0 * np.pi * u1
    return np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1.0 - u2)])


CHARTS = [Sphere(), Tangents(1.0, 1.0), Tangents(2.0, 0.4), Reflections(np.array([0.6, 0.0, 0.8]), Tangents(0.9, 0.5))]
IDS = ["sphere", "tangents", "stretched tangents", "reflections"]


@pytest.mark.parametrize("chart", CHARTS, ids=IDS)
def test_charts_go_there_and_back(chart, rng):
    p, q = rng.uniform(0.01, 0.99, (2, 500))
    directions = chart.directions(p, q)
    np.testing.assert_allclose((directions * directions).sum(axis=0), 1.0, rtol=1e-12)
    back = chart.coordinates(directions)
    np.testing.assert_allclose(back[0], p, atol=1e-9)
    np.testing.assert_allclose(back[1], q, atol=1e-9)


@pytest.mark.parametrize("chart", [CHARTS[0], CHARTS[1], CHARTS[2]], ids=IDS[:3])
def test_charts_measure_solid_angle(chart):
    assert integrals(cosine, chart, (8, 8)).sum() == pytest.approx(1.0, abs=1e-5)


def test_p_values_of_a_right_sampler_are_uniform(rng):
    values = [chi_square(sample_cosine(*rng.random((2, 5000))), cosine, Tangents(1.0, 1.0)).p_value for _ in range(100)]
    assert kstest(values, "uniform").pvalue > 1e-3


def test_a_wrong_sampler_is_refuted(rng):
    u1, u2 = rng.random((2, 100_000))
    assert chi_square(sample_cosine(u1, u2**1.1), cosine, Tangents(1.0, 1.0)).p_value < 1e-6
    assert chi_square(sample_cosine(u1, u2), lambda m: 0.98 * cosine(m), Tangents(1.0, 1.0)).p_value < 1e-6
    assert chi_square(sample_cosine(u1, u2), lambda m: 1.02 * cosine(m), Tangents(1.0, 1.0)).p_value == 0.0


def test_sidak():
    assert 1.0 - (1.0 - sidak(0.01, 7)) ** 7 == pytest.approx(0.01, rel=1e-12)
