# SPDX-License-Identifier: GPL-3.0-or-later
"""The observer's table against what the CIE publishes of it.

Also wavelengths against their density.
"""

import numpy as np
import pytest
from etalon.lib.sampling import wavelengths
from etalon.lib.sampling.wavelengths import COLORS, NODES, color_weight, sample_wavelength
from scipy.integrate import trapezoid
from scipy.stats import kstest


def observer():
    return np.array([row.split() for row in wavelengths._OBSERVER], float) * 1e-4


def test_the_observer_sees_equal_energy_as_grey_and_peaks_at_555():
    """CIE 15:2004: the sums over 5 nm are 21.371 each; y is 1 at 555 nm.

    x = y at 555 nm and 1.0622 at most, at 600.
    """
    x, y, z = observer()
    assert observer().sum(axis=1) == pytest.approx([21.371] * 3, abs=2e-3)
    assert NODES[y.argmax()] == 555.0
    assert (x.max(), y.max(), z.max()) == pytest.approx((1.0622, 1.0, 1.7826), rel=1e-12)
    assert (NODES[x.argmax()], NODES[z.argmax()]) == (600.0, 445.0)


def test_the_white_point_is_that_of_d65():
    """x = 0.31272, y = 0.32903 (CIE 15:2004, table T.3), and Y of D65 per 5 nm is 2113.4."""
    d65 = np.interp(NODES, NODES[::2], np.array(wavelengths._D65.split(), float))
    white = (observer() * d65).sum(axis=1)
    assert white[:2] / white.sum() == pytest.approx([0.31272, 0.32903], abs=3e-5)
    assert white[1] == pytest.approx(2113.4, abs=0.3)
    # That white is (1, 1, 1) in linear Rec. 709: the matrix agrees with the illuminant.
    assert wavelengths._REC709 @ (white / white[1]) == pytest.approx(1.0, abs=5e-4)


def test_a_light_without_dispersion_keeps_its_colour():
    u = (np.arange(1 << 20) + 0.5) / (1 << 20)
    assert color_weight(sample_wavelength(u)).mean(axis=1) == pytest.approx(1.0, abs=1e-5)
    assert trapezoid(COLORS, NODES, axis=1) == pytest.approx(1.0, abs=1e-12)


def test_the_mean_over_samples_is_the_integral_over_the_spectrum():
    """Of something that depends on the wavelength: cos(lambda / 40), by a fine trapezoid rule."""
    fine = np.linspace(380.0, 780.0, 400_001)
    density = np.stack([np.interp(fine, NODES, color) for color in COLORS])
    expected = trapezoid(density * np.cos(fine / 40.0), fine, axis=1)
    wavelength = sample_wavelength((np.arange(1 << 20) + 0.5) / (1 << 20))
    assert (color_weight(wavelength) * np.cos(wavelength / 40.0)).mean(axis=1) == pytest.approx(expected, abs=2e-5)


def test_wavelengths_come_where_colour_is(rng):
    """By Kolmogorov and Smirnov, for each interval of the table.

    They follow the mean of the magnitudes of red, green and blue there.
    """
    light = np.abs(COLORS).mean(axis=0)
    steps = np.append(0.0, np.cumsum(light[1:] + light[:-1]))
    drawn = sample_wavelength(rng.random(20_000))
    assert kstest(drawn, lambda x: np.interp(x, NODES, steps / steps[-1])).pvalue > 1e-4
    assert kstest(drawn, lambda x: (x - 380.0) / 400.0).pvalue < 1e-9
    ends = sample_wavelength(np.array([0.0, np.nextafter(1.0, 0.0)]))
    assert np.isfinite(color_weight(ends)).all()
