# SPDX-License-Identifier: GPL-3.0-or-later
"""Smooth interfaces: Snell and Fresnel from their own formulas."""

import numpy as np
import pytest
from etalon.lib.bsdfs.specular import Mirror, SmoothDielectric
from scipy import stats

LEVEL = 1e-4


def view(degrees, count):
    theta = np.radians(degrees)
    return np.repeat(
        np.array([[np.sin(theta) * np.cos(1.1)], [np.sin(theta) * np.sin(1.1)], [np.cos(theta)]]), count, axis=1
    )


def reflectance(degrees, eta):
    """Fresnel's formulas by angles: sin^2 and tan^2 of difference over sum."""
    i = np.radians(degrees)
    if np.sin(i) >= eta:
        return 1.0
    t = np.arcsin(np.sin(i) / eta)
    if i == 0.0:
        return ((eta - 1.0) / (eta + 1.0)) ** 2
    return 0.5 * ((np.sin(i - t) / np.sin(i + t)) ** 2 + (np.tan(i - t) / np.tan(i + t)) ** 2)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 60.0, 80.0])
@pytest.mark.parametrize("eta", [1.5, 1.0 / 1.5, 2.4])
def test_glass_splits_as_fresnel_says(degrees, eta, rng):
    """The share reflected is binomial with Fresnel's reflectance.

    Every weight is 1, so that nothing is lost or won.
    """
    count = 100_000
    lobe = SmoothDielectric(view(degrees, count), np.full(count, eta), True)
    wi, weight, pdf = lobe.sample(*rng.random((2, count)))
    assert np.all(weight == 1.0)
    assert np.isinf(pdf).all()
    reflected = int((wi[2] > 0.0).sum())
    exact = reflectance(degrees, eta)
    if exact in (0.0, 1.0):
        assert reflected == exact * count
    else:
        assert stats.binomtest(reflected, count, exact).pvalue > LEVEL


@pytest.mark.parametrize("degrees", [0.0, 30.0, 60.0, 80.0])
@pytest.mark.parametrize("eta", [1.5, 1.0 / 1.5, 1.0, 2.4])
def test_snell(degrees, eta, rng):
    """sin i = eta sin t, in one plane with the normal, on the other side.

    None under total internal reflection.
    """
    wo = view(degrees, 4)
    wi, weight, _ = SmoothDielectric(wo, np.full(4, eta), False).sample(*rng.random((2, 4)))
    sine = np.sin(np.radians(degrees)) / eta
    if sine >= 1.0:
        assert np.all(weight == 0.0)
        return
    assert np.all(weight == 1.0)
    np.testing.assert_allclose(wi[2], -np.sqrt(1.0 - sine**2), rtol=1e-12)
    np.testing.assert_allclose(wi[:2], -wo[:2] / eta, atol=1e-15)
    # And the same way back, in the frame whose z is turned over.
    over = np.array([[1.0], [1.0], [-1.0]])
    back, _, _ = SmoothDielectric(wi * over, np.full(4, 1.0 / eta), False).sample(*rng.random((2, 4)))
    np.testing.assert_allclose(back * over, wo, rtol=1e-12, atol=1e-14)


def test_mirror():
    wo = view(35.0, 3)
    wi, weight, pdf = Mirror(wo).sample(np.zeros(3), np.zeros(3))
    np.testing.assert_allclose(wi, wo * [[-1.0], [-1.0], [1.0]], rtol=1e-15)
    assert np.all(weight == 1.0)
    assert np.isinf(pdf).all()


@pytest.mark.parametrize("make", [Mirror, lambda wo: SmoothDielectric(wo, np.full(wo.shape[1], 1.5), True)])
def test_deltas_evaluate_to_nothing(make, rng):
    wi = view(20.0, 5)
    value, pdf = make(view(20.0, 5)).evaluate(wi)
    assert not np.any(value)
    assert not np.any(pdf)
    assert make(wi).delta
    assert not make(view(100.0, 5)).sample(*rng.random((2, 5)))[1].any(), "a viewer behind the normal sees nothing"
